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
 * Rule 6: what the main loop owes (a piece, a block) and has not ready is waited for with the timer
 *         stopped: `starved`.
 */
#ifndef PLAYER_H
#define PLAYER_H

#include "state.h"

/* Why the player has stopped its timer. */
enum halt { PLAYING, AT_END, AT_STOP, AT_HOLD, STARVED };

/* The first part is read by beats.S: see layout.h. */
struct player {
    uint8_t mode;        /* what the next interrupt is */
    struct block *block; /* in hand, or 0 */
    uint16_t due;        /* low half of the time of the next write */
    ticks_t done;        /* ticks of the block that are played */
    ticks_t piece_end;
    uint8_t ramps;
    uint32_t interval_q8;
    int32_t add_q8;
    uint32_t cycles;      /* interval of the tick in hand, as it is played; 0: from rest */
    uint32_t last_cycles; /* of the tick before, as of the last choice in C or of a ramp */
    uint8_t beats;        /* of the tick in hand: 1, 2, 4 or 8 */
    uint8_t beats_left;
    uint16_t beat_cycles; /* of each, if the interval is not a far one */
    uint8_t lag_cycles;   /* by which the last beat is longer */
    uint8_t moved;        /* motors moved in the tick in hand */
    uint16_t late;        /* with IS_LATE: by how much */
    uint16_t shortest;    /* interval from which on it is divided; 0xFFFF: never */
    uint8_t patience;     /* beats until the main loop gets a turn in any case */
    uint16_t late_ticks;
    uint8_t early;        /* by which the compare match comes before the deadline */

    uint32_t plan_cycles; /* clock lines: the interval as chosen */
    uint32_t fall_cycles; /* from the edge to the fall */
    uint32_t not_before;  /* shortest time from edge to edge */
    bool is_made_out;     /* clock lines: motors of the next edge are known already */
    uint16_t wait_cycles; /* clock lines: from the fall to the next edge, if it is steady */

    uint8_t after_hops;   /* mode of the interrupt that is waited for */
    bool piece_is_last;
    bool from_rest;       /* the next block is the first of a run */
    ticks_t chosen_at;    /* `done` at the last choice in C */
    volatile uint8_t halt;
    uint16_t serial;      /* block in hand, or the last one */
};

extern struct player player;

/* Time begins now; plays what is prepared. The timer was stopped. */
void player_start(void);
/* No further beat, not even of the tick in hand. Main loop. */
void player_cut(void);
/* What was owed is there: go on after STARVED. */
void player_continue(void);
/* The motors stand: nothing is known of the last interval any more. */
void player_rest(void);
/* First piece known: what can be worked out ahead of the block's first tick. Main loop. */
void player_prepare(struct block *block);
/* What the tick played last took; 0 at rest. */
uint32_t player_last(void);
/* The block in hand is given up. */
void player_drop(void);

/* Slots between reader and player. */
extern struct block blocks[2];
extern volatile uint8_t block_ready; /* a bit per slot: decoded, not yet taken */
extern uint8_t block_next;           /* slot that is taken next */
extern struct piece pieces[PIECES];
extern volatile uint8_t piece_head, piece_tail;
/* Whole records in the ring, not decoded yet. */
extern volatile uint16_t records_waiting;

#endif
