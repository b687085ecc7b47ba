/* What the status lines say: end switch, watch, and what that leads to.
 *
 * Rule 1: the lines are read after every motor movement, and at standstill by the main loop.
 * Rule 2: K equal readings make or end a condition; the place of the first of them is kept. A
 *         reading that can change nothing costs one comparison (`beat.quiet`, `beat.mind`).
 * Rule 3: a reading asks for a stop or a brake; the tick in hand is finished first.
 * Rule 4: a watch that ends the run brakes above the start/stop rate and stops dead below it. While
 *         the motors brake for it, the end switches do not act.
 * Rule 5: end switches may have several inputs. What is counted is that all of them are open; contact
 *         is that they are not.
 * Rule 6: which end a contact may be is worked out by the host, from the blocks named here.
 */
#ifndef INPUTS_H
#define INPUTS_H

#include "state.h"

struct condition {
    uint8_t pins, value; /* true while (pins read & pins) == value */
    uint8_t run;         /* readings in a row that differ from what is known */
    bool is_true;
    struct place first;
};

struct inputs {
    struct condition open, watch; /* open: no end switch shows contact */
    bool watching;
    bool watch_hides_switch;
    bool watch_reacts;
    uint8_t watch_action;
    bool ignores_switch; /* mode, as the host wants it */
    volatile bool drop_when_still;
    uint8_t stop_reason;
    bool latched;
    struct place latched_at;
    uint16_t contact_serial, contact_oldest;
    uint8_t pins;  /* as last read */
    uint8_t version; /* changes with all that a report should tell at once */
};

extern struct inputs inputs;

/* Some end switch shows contact. */
static inline bool is_contact(void)
{
    return !inputs.open.is_true;
}

/* Pins that belong to bits of the status register, and their levels for a register value. */
uint8_t pins_of(uint8_t status_mask);
uint8_t levels_of(uint8_t status);
uint8_t status_of(uint8_t pins);

/* A card was loaded. */
void inputs_begin(void);
void inputs_begin_block(const struct block *block);
void inputs_end_block(void);
/* The readings of the beat just played: one for each movement, or a single one. */
void inputs_examine_beat(void);
/* One reading at standstill. */
void inputs_sample(void);
/* Every 4 ms: remember which block was in hand. */
void inputs_mark_time(void);

#endif
