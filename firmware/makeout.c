/* Rules: makeout.h. */
#include "makeout.h"

#include "beat.h"
#include "line.h"
#include "player.h"
#include "power.h"

#define MOST_BEATS 8

void share_out(struct block *block, uint8_t beats)
{
    for (uint8_t i = 0; i < minors_of(block); i++) {
        ticks_t add = block->steps[i];
        for (uint8_t n = beats; n < MOST_BEATS; n <<= 1)
            add <<= 1;
        block->minor[i].add = add;
    }
}

uint8_t ramps_of(int32_t add_q8)
{
    const uint32_t most = (uint32_t)FAR_CYCLES << 7;
    if ((uint32_t)add_q8 + most > 2 * most)
        return RAMP_SLOW;
    return add_q8 ? RAMP_FAST : RAMP_NONE;
}

SELDOM void divide_far(struct block *block, uint32_t cycles)
{
    uint8_t beats = 1;
    uint32_t part = cycles >> 1;
    if (minors_of(block) && card.facts.beat_cycles)
        for (; beats < MOST_BEATS && part >= card.facts.beat_cycles; part >>= 1)
            beats <<= 1;
    if (beats != block->beats)
        share_out(block, beats);
    block->beats = beats;
    block->ramps = RAMP_SLOW;
}

/* All in 16 bits. */
void divide(struct block *block, uint16_t cycles)
{
    uint16_t part = cycles;
    uint8_t beats = 1;
    while (part >= block->shortest && beats < MOST_BEATS) {
        part >>= 1;
        beats <<= 1;
    }
    block->beat_cycles = part;
    if (beats != block->beats)
        share_out(block, beats);
    block->beats = beats;
    block->lag_cycles = (uint8_t)cycles & (beats - 1);
    block->ramps = block->moving ? ramps_of(block->add_q8) : RAMP_SLOW;
}

void make_out_outputs(struct block *block)
{
    uint8_t mask = block->outputs >> 4, value = block->outputs & 0x0F;
    power_enter(block);
    block->outputs_due = 0;
    card.outputs = (uint8_t)((card.outputs & ~mask) | (value & mask));
    uint8_t control = card_control_with(mask, value);
    if (control == card.control)
        return;
    card_shadow_control(control);
    beat.control_high = card.control_high;
    beat.control_extra = (uint8_t)(CONTROL_EXTRA(control) | EXTRA_REST);
    beat.control_due = true;
}

/* A minor axis in one beat: true when it steps. */
static bool minor_steps(struct minor *minor, ticks_t limit)
{
    ticks_t add = minor->add, sum = minor->sum + add;
    bool steps = sum < add;
    minor->sum = steps ? sum - limit : sum;
    return steps;
}

static void add_movement(struct entry *entry, struct mover mover)
{
    struct motor *motor = &tracks.motor[(mover.at & 0x0F) >> 2];
    uint8_t at = (uint8_t)(motor->phase + mover.delta);
    if (at >= card.facts.table_length)
        at = mover.delta > 0 ? 0 : card.facts.table_length - 1;
    motor->phase = at;
    entry->low = tracks.table[at] | motor->low;
    entry->high = motor->high;
    beat.mask |= motor->bit;
}

uint32_t make_out_phases(void)
{
    line_poll();
    struct block *block = player.block;
    struct entry *entry = beat.entry;
    uint32_t wait = 0, beat_cycles = player.cycles;
    uint8_t left = player.beats_left, minors = minors_of(block);
    ticks_t limit = block->limit;
    for (uint8_t n = block->beats; n > 1; n >>= 1)
        beat_cycles >>= 1;
    beat.mask = 0;
    do {
        wait += beat_cycles;
        if (--left == 0) {
            wait += block->lag_cycles;
            if (block->moving)
                add_movement(entry++, block->leader);
        }
        struct minor *minor = block->minor;
        for (uint8_t i = minors; i; i--, minor++)
            if (minor_steps(minor, limit))
                add_movement(entry++, minor->mover);
    } while (left && entry == beat.entry);
    beat.end = (uint8_t)(uintptr_t)entry;
    player.beats_left = left;
    return wait;
}

void make_out_clocks(void)
{
    struct block *block = player.block;
    uint8_t edges = block->moving ? block->leader.at : 0;
    struct minor *minor = block->minor;
    for (uint8_t i = minors_of(block); i; i--, minor++)
        if (minor_steps(minor, block->limit))
            edges |= minor->mover.at;
    uint8_t data = card.data ^ edges;
    beat.mask = edges;
    beat.entry[0].low = DATA_LOW(data);
    beat.entry[0].high = (uint8_t)(DATA_HIGH(data) | card.control_high);
    beat.end = (uint8_t)(uintptr_t)&beat.entry[edges ? 1 : 0];
    beat.rest.low = DATA_LOW(card.data);
    beat.rest.high = (uint8_t)(DATA_HIGH(card.data) | card.control_high);
}

void make_out_piece_ahead(const struct block *block, struct piece *piece)
{
    bool is_plain = block->moving && piece->interval_q8 < (uint32_t)FAR_CYCLES << 8;
    is_plain &= is_phase_card() || is_half_duty();
    piece->ramps = is_plain ? ramps_of(piece->add_q8) : RAMP_SLOW;
}

void make_out_ahead(struct block *block)
{
    if (minors_of(block) && card.facts.beat_cycles && card.facts.beat_cycles < 0x8000)
        block->shortest = (uint16_t)(2 * card.facts.beat_cycles);
    if (!block->moving || block->entry_cycles >= FAR_CYCLES) {
        block->is_plain = false;
        return;
    }
    divide(block, (uint16_t)block->entry_cycles);
    block->is_plain &= !block->watch_pins && block->exit_cycles
        && (is_phase_card() || (is_half_duty() && !block->outputs_due));
}
