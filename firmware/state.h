/* What the parts of the firmware share: the block in hand, its time law, and what is wanted.
 *
 *   main loop                               timer interrupt
 *   ring -> reader -> struct block [2]  ->  the block in hand, beat after beat
 *                  -> struct piece [4]  ->  its intervals from the second piece on
 *   urgents -> WANT ------------------->    looked at when an interval is chosen
 *
 * Rule 1: the interrupt owns the block in hand and the pieces taken; the main loop owns the slots
 *         that are free. A slot changes hands by one byte that is written last.
 * Rule 2: wishes are bits of a register that `sbi` and `cbi` change in one instruction, so neither
 *         side needs to lock. While it is zero, ticks are played by the plan alone.
 * Rule 3: interrupts are off in the main loop for at most CRITICAL_CYCLES.
 */
#ifndef STATE_H
#define STATE_H

#include <avr/io.h>
#include <stdbool.h>
#include <stdint.h>

#include "layout.h"
#include "protocol.h"

typedef __uint24 ticks_t; /* also eighths of ticks: 2^21 - 1 ticks in a block at most */
typedef __uint24 energy_t; /* of a tick with light: its share of full power times its cycles / 256 */

#define RATE_CYCLES 4096000000UL /* rate_q8 times interval in cycles */
#define SLICE_CYCLES 16000
#define LATENCY_CYCLES 4096
#define CRITICAL_CYCLES 26

/* Wishes and conditions because of which an interval is not simply the plan's. */
#define WANT GPIOR0
#define WANT_BRAKE 0
#define WANT_STOP 1
#define WANT_OPEN 2
#define WANT_OUTPUTS 3
#define IS_THROTTLED 4
#define IS_LIMITED 5
#define MAY_RUN_DRY 6
#define IS_LATE 7 /* a write came late: player.late */

/* What is seldom done, or with time to spare, is kept small. */
#define SELDOM __attribute__((noinline, optimize("Os")))

#define wish(bit) (WANT |= _BV(bit))
#define unwish(bit) (WANT &= (uint8_t)~_BV(bit))
#define wished(bit) (WANT & _BV(bit))

/* A place in the path: block, whole ticks of it, motors moved in the tick after them. */
struct place {
    uint16_t serial;
    ticks_t done;
    uint8_t moved;
};

/* Who moves. Phase card: low byte of the address of its struct motor, and +1 or -1. Clock lines: its
 * bit of the data byte, and its motor bit. */
struct mover {
    uint8_t at;
    int8_t delta;
};

/* A motor that does not lead. `sum` runs from -limit up to 0; a carry out of it is a step. */
struct minor {
    ticks_t sum;
    ticks_t add; /* eighths of steps a beat */
    struct mover mover;
};

/* A block, and where its time law stands: the interrupt goes over to the next one by a pointer.
 * The first part is read by beats.S: see layout.h. */
struct block {
    struct minor minor[MOTORS_MAX - 1];
    struct mover leader;
    ticks_t limit;  /* eighths of ticks */
    uint8_t narrow; /* how many minors, if their sums take 16 bits; else 0 */
    uint8_t wide;   /* how many, if they take 24 */
    uint8_t ramps;
    ticks_t piece_end; /* ticks of the block that are done after the piece in hand */
    uint32_t interval_q8;
    int32_t add_q8;
    bool piece_is_last;
    uint8_t beats; /* of the tick in hand: 1, 2, 4 or 8; 0: not known */
    uint16_t beat_cycles; /* of each, if the interval is not a far one */
    uint8_t lag_cycles;   /* by which the last beat is longer */
    uint16_t shortest;    /* interval from which on a tick is divided; 0xFFFF: never */
    uint16_t serial;
    uint8_t outputs_due; /* DUE_...: still to be made with the first beat */
    uint32_t entry_cycles; /* first interval of the plan; 0: no piece */
    bool is_ramp; /* the piece in hand, as the drives are told */
    uint8_t moving; /* motors, a bit each; 0: a dwell */
    ticks_t steps[MOTORS_MAX - 1]; /* of the minors */
    uint8_t leading; /* the leader's bit */
    uint8_t minor_bits[MOTORS_MAX - 1];
    uint8_t forward; /* motors, a bit each */
    uint8_t flags;
    uint8_t data; /* clock and direction: data byte with clocks at rest */
    uint8_t outputs;  /* mask << 4 | value */
    uint8_t watch_pins, watch_value, watch_action; /* pins 0: none */
    uint16_t override_q8;
    bool is_plain; /* nothing but motion, from motion: taken without much ado */
    ticks_t ticks;
    uint32_t accel_q;
    uint32_t jump_q8;
    uint32_t jump_cycles;
    uint32_t jump_before;  /* of the block before */
    uint32_t exit_cycles;  /* last interval of the plan of the block before; 0: from rest */
    uint32_t top_cycles;   /* shortest interval of the plan */
    uint32_t slower_q16, faster_q16; /* entry / exit, exit / entry */
    uint32_t ceiling_q8;
    uint8_t share;   /* of a lamp's power; with an energy, that of the first interval */
    energy_t energy; /* 0: the share is constant */
};

/* struct block: outputs_due */
#define DUE_OUTPUTS RARE_OUTPUTS
#define DUE_POWER 0x80

/* struct block: flags */
#define BLOCK_RATIOS 0x01  /* slower_q16 and faster_q16 are ready */
#define BLOCK_CEILING 0x02 /* ceiling_q8 is ready */
#define BLOCK_SLOWER 0x04  /* slower_q16 is, at least */

/* A piece of a time law that is not the first one: that one stands in the block. */
struct piece {
    ticks_t end; /* ticks of the block that are done after it */
    uint32_t interval_q8;
    int32_t add_q8;
    bool last;
    uint8_t ramps; /* RAMP_SLOW: taken by C */
    bool is_ramp;
};

static inline uint8_t minors_of(const struct block *block)
{
    return block->narrow + block->wide;
}

#endif
