/* The player: the timer interrupt that plays the block in hand, beat after beat.
 *
 *      previous beat's interrupt                 this beat's interrupt
 *   ---| writes | readings | next bytes |~~~~~~~~~~| wait out | writes | ...
 *                made out, compare set  |          |          |
 *                                    main loop   EARLY       due
 *
 * Rule 1: the compare match comes EARLY_CYCLES before a write is due; the rest is waited out to the
 *         cycle, so neither the instruction that was interrupted nor a locked stretch of the main
 *         loop is seen on the pins. At the deadline only the writes remain.
 * Rule 2: a beat without a step has no interrupt of its own.
 * Rule 3: an interval is chosen when its predecessor's last beat was written (with clock lines: when
 *         they have fallen). From then on the tick is in hand and will be finished.
 * Rule 4: a wait of more than FAR_CYCLES goes in hops. A brake or stop is seen at a hop, and if no
 *         beat of the tick was played, its interval is chosen anew.
 * Rule 5: a write that comes late by more than a quarter of its interval (a minor axis alone: half)
 *         is counted, and moves all that follows: no more is ever caught up by a shorter interval.
 *         With clock lines, where a pulse could be cut short, whatever comes late does.
 * Rule 6: a block that is plain, after motion and with nothing on anybody's mind, is gone over to in
 *         beats.S (player.next); any other is taken in hand by begin_block, in the time of a beat or
 *         two of a fast one.
 * Rule 7: what the main loop owes (a piece, a block) and has not ready is waited for with the timer
 *         stopped: `starved`.
 */
#ifndef PLAYER_H
#define PLAYER_H

#include "state.h"

/* Why the player has stopped its timer. */
enum halt { PLAYING, AT_END, AT_STOP, AT_HOLD, STARVED };

/* What the next interrupt is: MODE_... of layout.h. */
#define MODE GPIOR2

/* Clock lines: why the next edge is not simply a pause after the last fall. */
struct rest {
    bool stands;    /* a run begins */
    uint32_t stood; /* after so long; */
    uint32_t ready; /* directions have stood for their time so long after the last deadline */
};

/* The first part is read by beats.S: see layout.h. */
struct player {
    struct block *block; /* in hand, or 0 */
    struct block *next;  /* may be gone over to in beats.S, or 0: see player_offer */
    uint8_t taken;       /* blocks that were taken in hand, modulo 256 */
    bool is_minded;      /* no block may be gone over to there: inputs want to know of it */
    bool limits_owed;    /* the throttle has not seen the limits of the block in hand */
    uint16_t serial;     /* block in hand, or the last one */
    uint16_t due;        /* low half of the time of the next write */
    ticks_t done;        /* ticks of the block that are played */
    ticks_t chosen_at;   /* `done` at the last choice in C */
    uint32_t cycles;      /* interval of the tick in hand, as it is played; 0: from rest */
    uint32_t last_cycles; /* of the tick before, as of the last choice in C */
    uint8_t beats_left;
    uint8_t moved;        /* motors moved in the tick in hand */
    uint16_t late;        /* with IS_LATE: by how much */
    uint8_t patience;     /* beats until the main loop gets a turn in any case */
    uint16_t late_ticks;
    uint8_t early;        /* by which the compare match comes before the deadline */

    uint32_t fall_cycles; /* clock lines: from the edge to the fall */
    bool is_made_out;     /* motors of the next edge are known already */
    uint16_t wait_cycles; /* from the fall to the next edge, if it is steady */
    struct rest rest;

    uint8_t after_hops;   /* mode of the interrupt that is waited for */
    bool from_rest;       /* the next block is the first of a run */
    volatile uint8_t halt;
};

extern struct player player;

/* Time begins now, after so many cycles of standing; plays what is prepared. The timer was stopped. */
void player_start(uint32_t stood);
/* No further beat, not even of the tick in hand. Main loop. */
void player_cut(void);
/* What was owed is there: go on after STARVED. */
void player_continue(void);
/* The motors stand: nothing is known of the last interval any more. */
void player_rest(void);
/* What the tick played last took; 0 at rest. */
uint32_t player_last(void);
/* The block in hand is given up. */
void player_drop(void);

/* A block was decoded, or what the throttle minds has changed: whether the next block may be gone
 * over to in beats.S. Main loop, or interrupt. */
void player_offer(void);

/* Slots between reader and player: the n-th block is in slot n modulo 2. */
extern struct block blocks[2];
extern uint8_t blocks_read; /* decoded so far, modulo 256 */
extern struct piece pieces[PIECES];
extern volatile uint8_t piece_head, piece_tail;
/* Whole records in the ring, not decoded yet. */
extern volatile uint16_t records_waiting;

/* A block is decoded and not taken. */
static inline bool player_has_block(void)
{
    return *(volatile uint8_t *)&blocks_read != *(volatile uint8_t *)&player.taken;
}

#endif
