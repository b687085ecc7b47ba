/* The throttle: brake, hold, resume, dry queue and lowered override, as in the polled core.
 *
 *   rate ^   plan  ________________________
 *        |        /   \                 __/
 *        |       /     \   closing     /    opening: rises until it meets the plan
 *        |      /       \             /
 *        |  ...............\_______../.....  start/stop rate: below it the motors may stand
 *        +------------------- held ---------> time
 *
 *   elapsed 0 ------------- slice ---- latency ------------- slice ---- latency --->
 *                           | decided   | counts
 *                           '-> worked out by the main loop meanwhile
 *
 * Rule 1: every integer is the core's (fraese/motor/throttle.py): same state, same cycles.
 * Rule 2: all of this runs where an interval is chosen, in the interrupt. What takes a division is
 *         worked out ahead by the main loop (throttle_work_ahead). What is not ready when it is needed
 *         is worked out on the spot, and counted: late_throttle.
 *         Clock lines: then the pulse becomes as long as its pause (player.c: note_late_rise), and
 *         between two moves beats.S takes the same interval again and decides the next move by itself
 *         (fall_throttled). Such a move counts after THROTTLE_AHEAD: a tick or more later than the
 *         core's where intervals are shorter than that.
 * Rule 3: while it is open and nothing is wished, blocks are taken in hand without it; their limits
 *         are owed, and settled before anything is decided.
 * Rule 4: `turn` changes with every change that makes work done ahead worthless; a result counts
 *         only for the turn that it was made for.
 */
#ifndef THROTTLE_H
#define THROTTLE_H

#include "state.h"

enum throttle_state { OPEN, CLOSING, HELD, OPENING, LIMITED };

/* The first part is read by beats.S: see layout.h. */
struct throttle {
    volatile bool dry_point; /* there is one: */
    uint16_t dry_serial;
    ticks_t dry_tick;
    volatile uint8_t state;
    uint8_t turn;
    bool is_steady;     /* nothing changes before `elapsed` reaches `steady_until`; both fit 16 bits */
    uint32_t steady_until;
    uint32_t elapsed;
    uint32_t mark;      /* elapsed when the move was decided; 0: none waits */
    bool rate_owed;     /* rate_q8 is RATE / rate_of, not worked out yet */
    uint32_t rate_of;
    uint32_t rate_q8;
    uint32_t cycles;    /* the interval it allows */
    uint32_t accel_q, jump_q8, jump_cycles;
    uint32_t ceiling_q8; /* 0: none */
    uint8_t ready;      /* turn that `next_*` was worked out for */
    uint8_t next_state;
    uint32_t next_rate_q8, next_cycles;
    uint16_t override_q8; /* as wanted */
    bool dry;             /* closed for want of blocks */
    uint8_t dry_queues;
    uint8_t late_throttle;
    bool owes_signals; /* the drives are told with the next interval that is chosen */
};

extern struct throttle throttle;

/* Between two moves: the tick that was played took what the throttle allows, the plan is no slower,
 * and nothing else is wished. Then the next one takes the same. */
static inline bool throttle_goes_on(uint32_t plan, uint32_t played)
{
    if (!throttle.is_steady || played != throttle.cycles || plan >= played)
        return false;
    uint32_t elapsed = throttle.elapsed + played;
    if (elapsed >= throttle.steady_until)
        return false;
    throttle.elapsed = elapsed;
    return true;
}

/* The interval to the next tick; false: none, see player.halt. `again`: chosen anew. */
bool throttle_choose(uint32_t *cycles, bool again);
/* The block in hand begins. */
void throttle_enter(const struct block *block, uint32_t exit_cycles);
/* With the timer stopped, or from the interrupt. */
void throttle_open(void);
void throttle_hold(void);
void throttle_reset(void);
/* Work ahead, in the main loop, while it has something to say. */
void throttle_work_ahead(void);
void throttle_set_override(uint16_t override_q8);
/* Ceiling of a block under the override that is wanted now, if there is one. */
void throttle_prepare(struct block *block);

/* See the limits of blocks that beats.S took in hand. */
void throttle_settle_limits(void);

static inline void throttle_service(void)
{
    if (throttle.state != OPEN && throttle.state != HELD)
        throttle_work_ahead();
}

static inline bool throttle_is_closed(void)
{
    return throttle.state == CLOSING || throttle.state == HELD;
}

static inline bool is_above_jump(uint32_t cycles)
{
    return cycles < throttle.jump_cycles - (throttle.jump_cycles >> 4);
}

/* The throttle has something to say in this block. */
static inline bool throttle_minds(const struct block *block)
{
    return block->override_q8 > throttle.override_q8
        || (throttle.dry_point && (int16_t)(block->serial - throttle.dry_serial) >= 0);
}


#endif
