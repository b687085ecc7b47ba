/* The card: what the pins mean. Everything here came from the host; nothing needs a new flash.
 *
 * Rule 1: the card owns the shadow of the control register; nobody else writes control pins.
 * Rule 2: a movement of a phase card is data, strobe low, strobe high (the pin; the register bit is
 *         its inverse), a reading:
 *
 *             data    ==X========================X====
 *             strobe  ~~~~~~\________/~~~~~~~~~~~~~~~~
 *             status                  r
 *                         |<- 0.5 us ->|
 *
 * Rule 3: what is written here is written while the motors stand, or by the timer interrupt.
 */
#ifndef CARD_H
#define CARD_H

#include "board.h"
#include "state.h"

struct output {
    uint8_t mask, on; /* bits of the control register */
};

/* As the host uploads it, byte for byte. */
struct card_facts {
    uint8_t type;
    uint8_t motors;
    uint8_t table_length;
    uint8_t control_rest;
    uint8_t strobe;
    uint8_t clock_rest;
    uint8_t forward_high;
    struct output active, boost;
    uint8_t outputs;
    struct output output[4];
    uint8_t safe;
    uint8_t enable;
    uint8_t motor_bits[MOTORS_MAX]; /* clock and direction: the motor's two data bits */
    uint8_t off;
    uint8_t holds;
    uint16_t pulse_cycles;
    uint16_t setup_cycles;
    uint16_t beat_cycles;
    uint32_t settle_cycles;
    uint8_t switch_mask, switch_value;
    uint8_t readings;
    uint16_t silence_ms;
    uint16_t duty_q16; /* of a clock line: share of its interval away from rest */
};

struct card {
    struct card_facts facts;
    bool loaded;
    bool energised;
    uint8_t control;     /* shadow of the control register */
    uint8_t control_high; /* its part of PORT_HIGH */
    uint8_t outputs;     /* as wanted, also those that are off at standstill */
    uint8_t data;        /* clock and direction: data byte with clocks at rest, as read ahead */
    uint8_t boost_mask, boost_high; /* BOOST in `control`, and in PORT_HIGH */
    uint8_t hold[TABLE_MAX]; /* hold table, as PORT_LOW bytes */
};

/* Where a motor stands in the drive table, and what its bytes carry besides. */
struct motor {
    uint8_t phase;
    uint8_t high; /* motor bits and control bits of PORT_HIGH */
    uint8_t bit;  /* 1 << motor */
    uint8_t low;  /* motor bits of PORT_LOW */
};

/* Its addresses share their high byte: beats.S places it. */
struct tracks {
    uint8_t table[TABLE_MAX]; /* drive table, as PORT_LOW bytes */
    struct motor motor[MOTORS_MAX];
};

extern struct tracks tracks;

extern struct card card;

/* Levels that are harmless on every card; no current on a phase card. */
void card_after_reset(void);

/* Take a card and write its idle bytes; false: a value is out of range, nothing was taken. */
bool card_load(const uint8_t *facts);
bool card_take_table(uint8_t which, const uint8_t *entries, uint8_t length);

void card_energise(void);
void card_idle(bool hold);
void card_set_outputs(uint8_t mask, uint8_t value);
/* Change outputs as the host or a block wants it; those that are safe at standstill, later. */
void card_want_outputs(uint8_t mask, uint8_t value, bool standing);
void card_signals(bool active, bool boost);
/* A run begins and ends: ACTIVE, BOOST, and outputs that must be safe at standstill. */
void card_run(void);
void card_rest(void);
void card_forget_safe_outputs(void);

/* The data byte of clock and direction on the pins. */
void card_write_data(uint8_t data);
/* The control shadow on the pins. */
void card_write_control(void);
/* The control shadow changes; the pins follow later. */
void card_shadow_control(uint8_t control);
/* The control value with these outputs; does not write. */
uint8_t card_control_with(uint8_t mask, uint8_t value);

#endif
