/* What the next beat is made of: ticks into beats, beats into port bytes.
 *
 * Rule 1: beats.S does the same for ticks that are usual; both end with the same bytes, sums, phases.
 * Rule 2: what can be worked out before a block or piece is taken in hand, the main loop does here.
 */
#ifndef MAKEOUT_H
#define MAKEOUT_H

#include "card.h"
#include "state.h"

/* Intervals from here on go in hops, and take C. */
#define FAR_CYCLES 0x7000U
_Static_assert(FAR_CYCLES >> 8 == FAR_HIGH, "one limit for C and assembler");

static inline bool is_phase_card(void)
{
    return card.facts.type == CARD_PHASES;
}

/* Pulse and pause are equally long. */
static inline bool is_half_duty(void)
{
    return card.facts.duty_q16 == 0x8000;
}

/* First piece known: what can be worked out ahead of the block's first tick. Main loop. */
void make_out_ahead(struct block *block);
/* The same for a later piece of it. */
void make_out_piece_ahead(const struct block *block, struct piece *piece);

/* How the intervals of a block that moves go on; beats.S adds three bytes. */
uint8_t ramps_of(int32_t add_q8);
/* Shares of the minors for so many beats. */
void share_out(struct block *block, uint8_t beats);
/* A tick of a block into beats; a far one, or any other. */
void divide_far(struct block *block, uint32_t cycles);
void divide(struct block *block, uint16_t cycles);

/* The outputs of a block change with its first beat. */
void make_out_outputs(struct block *block);
/* The next beat of a phase card in which something is to be done; how long until then. */
uint32_t make_out_phases(void);
/* The next edge of clock lines. */
void make_out_clocks(void);

#endif
