/* Rules: throttle.h. */
#include "throttle.h"

#include <avr/interrupt.h>

#include "arith.h"
#include "player.h"
#include "run.h"

struct throttle throttle;

static void begin(uint8_t state)
{
    throttle.is_steady = false;
    throttle.state = state;
    throttle.elapsed = throttle.mark = 0;
    throttle.turn++;
}

/* rate_q8 will be that of an interval; 0: rate 0. */
static void owe_rate_of(uint32_t cycles)
{
    throttle.rate_owed = cycles != 0;
    throttle.rate_of = cycles;
    throttle.rate_q8 = 0;
    throttle.turn++;
}

/* Take the rate that was owed, if it is worked out. */
static void collect_rate(void)
{
    if (throttle.rate_owed && throttle.ready == throttle.turn) {
        throttle.rate_q8 = throttle.next_rate_q8;
        throttle.rate_owed = false;
        throttle.turn++;
    }
}

static void settle_rate(void)
{
    collect_rate();
    if (!throttle.rate_owed)
        return;
    throttle.late_throttle++;
    throttle.rate_q8 = rate_over(throttle.rate_of);
    throttle.rate_owed = false;
    throttle.turn++;
}

static void close(uint32_t last)
{
    if (throttle_is_closed())
        return;
    begin(CLOSING);
    owe_rate_of(last);
    throttle.cycles = last;
}

SELDOM void throttle_open(void)
{
    if (throttle.state == OPEN || throttle.state == OPENING)
        return;
    throttle.dry = false;
    if (throttle.state == HELD) {
        throttle.rate_q8 = throttle.cycles = 0;
        throttle.rate_owed = false;
    }
    begin(OPENING);
    wish(IS_THROTTLED);
}

void throttle_hold(void)
{
    throttle.state = HELD;
    throttle.turn++;
    wish(IS_THROTTLED);
}

void throttle_reset(void)
{
    throttle.state = OPEN;
    throttle.rate_owed = false;
    throttle.turn++;
    unwish(IS_THROTTLED);
}

/* One move, from a state that is copied before: the main loop may be interrupted by a newer one. */
struct move {
    uint8_t state;
    uint32_t rate_q8, cycles;
};

static uint32_t approached(uint32_t rate, uint32_t change)
{
    uint32_t ceiling = throttle.ceiling_q8, jump = throttle.jump_q8;
    if (rate > ceiling) {
        uint32_t lower = rate > change ? rate - change : 0;
        if (lower < ceiling)
            lower = ceiling;
        return lower <= jump ? ceiling : lower;
    }
    rate = sum_or_most(rate, change);
    if (rate < jump)
        rate = jump;
    return rate < ceiling ? rate : ceiling;
}

SELDOM static void work_out(struct move *move, uint32_t mark)
{
    uint32_t change = product_q16(throttle.accel_q, mark);
    uint32_t ceiling = throttle.ceiling_q8, jump = throttle.jump_q8;
    if (move->state == OPENING && ceiling && sum_or_most(move->rate_q8, change) >= ceiling)
        move->state = LIMITED;
    if (move->state == CLOSING) {
        move->rate_q8 = move->rate_q8 > change ? move->rate_q8 - change : 0;
        if (move->rate_q8 <= jump) {
            move->cycles = throttle.jump_cycles;
            return;
        }
    } else if (move->state == LIMITED) {
        move->rate_q8 = approached(move->rate_q8, change);
    } else {
        move->rate_q8 = sum_or_most(move->rate_q8, change);
    }
    if (!move->rate_q8)
        move->rate_q8 = 1;
    move->cycles = rate_over(move->rate_q8);
}

static void make_move(void)
{
    settle_rate();
    if (throttle.ready != throttle.turn) {
        struct move move = {throttle.state, throttle.rate_q8, throttle.cycles};
        throttle.late_throttle++;
        work_out(&move, throttle.mark);
        throttle.next_state = move.state;
        throttle.next_rate_q8 = move.rate_q8;
        throttle.next_cycles = move.cycles;
    }
    throttle.state = throttle.next_state;
    throttle.rate_q8 = throttle.next_rate_q8;
    throttle.cycles = throttle.next_cycles;
    throttle.elapsed -= throttle.mark;
    throttle.mark = 0;
    throttle.turn++;
}

/* left * (cycles >> 8) >= LATENCY >> 8, without a long product. */
static bool is_far_from_junction(ticks_t left)
{
    const uint8_t enough = LATENCY_CYCLES >> 8;
    if (throttle.cycles >= (uint32_t)enough << 8)
        return left != 0;
    uint8_t units = (uint8_t)(throttle.cycles >> 8);
    if (left >= enough)
        return units != 0;
    return (uint8_t)((uint8_t)left * units) >= enough;
}

static void advance(uint32_t last, ticks_t left)
{
    collect_rate();
    throttle.elapsed = sum_or_most(throttle.elapsed, last);
    if (throttle.mark && throttle.elapsed - throttle.mark >= LATENCY_CYCLES
        && is_far_from_junction(left))
        make_move();
    if (!throttle.mark && throttle.elapsed >= SLICE_CYCLES) {
        throttle.mark = throttle.elapsed;
        throttle.turn++;
    }
}

static bool is_dry(void)
{
    if (!throttle.dry_point)
        return false;
    int16_t beyond = (int16_t)(player.serial - throttle.dry_serial);
    return beyond > 0 || (beyond == 0 && player.done >= throttle.dry_tick);
}

static bool may_run_dry(void)
{
    return throttle.dry_point && (int16_t)(player.serial - throttle.dry_serial) >= 0;
}

static uint32_t ceiling_of(struct block *block)
{
    if (block->override_q8 <= throttle.override_q8)
        return 0;
    if (!(block->flags & BLOCK_CEILING)) {
        throttle.late_throttle++;
        throttle_prepare(block);
    }
    return block->ceiling_q8;
}

static void mind_ceiling(uint32_t ceiling, uint32_t last)
{
    if (throttle.ceiling_q8 != ceiling)
        throttle.turn++;
    throttle.ceiling_q8 = ceiling;
    if (!ceiling) {
        if (throttle.state == LIMITED)
            begin(OPENING);
    } else if (throttle.state == OPEN) {
        begin(LIMITED);
        throttle.cycles = last;
        owe_rate_of(last);
        if (!last) {
            uint32_t slowest = rate_over(ceiling);
            throttle.rate_q8 = throttle.jump_q8 < ceiling ? throttle.jump_q8 : ceiling;
            throttle.cycles = slowest > throttle.jump_cycles ? slowest : throttle.jump_cycles;
        }
    }
}

/* The longer of plan and throttle; false: held. */
static bool limit_interval(uint32_t *cycles, uint32_t last)
{
    if (throttle.state == OPENING) {
        settle_rate();
        if (throttle.rate_q8 < throttle.jump_q8) {
            throttle.rate_q8 = throttle.jump_q8;
            throttle.cycles = throttle.jump_cycles;
            throttle.turn++;
        }
    } else if (throttle.state == CLOSING) {
        uint32_t slowest = last > throttle.cycles ? last : throttle.cycles;
        if (!last || slowest >= throttle.jump_cycles)
            throttle_hold();
    }
    if (throttle.state == HELD)
        return false;
    if (throttle.cycles > *cycles)
        *cycles = throttle.cycles;
    else if (throttle.state == OPENING)
        throttle_reset();
    return true;
}

bool throttle_choose(uint32_t *cycles, bool again)
{
    uint32_t last = player.last_cycles;
    throttle_settle_limits();
    if (wished(WANT_STOP)) {
        player.halt = AT_STOP;
        return false;
    }
    if (wished(WANT_OUTPUTS))
        run_make_outputs();
    if (wished(WANT_OPEN)) {
        unwish(WANT_OPEN);
        throttle_open();
    }
    uint8_t state = throttle.state;
    if (state != OPEN && state != HELD && last && !again)
        advance(last, player.block->ticks - player.done);
    if (wished(WANT_BRAKE)) {
        unwish(WANT_BRAKE);
        throttle.dry = false;
        close(last);
    } else if (!again && is_dry() && last && !throttle_is_closed()) {
        throttle.dry = true;
        throttle.dry_queues++;
        close(last);
    }
    if (throttle.ceiling_q8 || player.block->override_q8 > throttle.override_q8)
        mind_ceiling(ceiling_of(player.block), last);
    if (throttle.state != OPEN && !limit_interval(cycles, last)) {
        player.halt = AT_HOLD;
        return false;
    }
    if (throttle.state != state || throttle.owes_signals)
        run_show_ramp();
    unwish(IS_LIMITED);
    throttle.steady_until = throttle.mark ? throttle.mark + LATENCY_CYCLES : SLICE_CYCLES;
    throttle.is_steady = throttle.state != OPEN && *cycles == throttle.cycles
        && !((throttle.elapsed | throttle.steady_until) >> 16); /* beats.S has 16 bits for them */
    if (throttle.state == OPEN)
        unwish(IS_THROTTLED);
    else
        wish(IS_THROTTLED);
    if (!may_run_dry())
        unwish(MAY_RUN_DRY);
    return true;
}

static void scale(const struct block *block, uint32_t exit)
{
    uint32_t slower = block->slower_q16, faster = block->faster_q16;
    if (!(block->flags & BLOCK_RATIOS) || exit != block->exit_cycles) {
        throttle.late_throttle++;
        slower = ratio_q16(block->entry_cycles, exit);
        faster = ratio_q16(exit, block->entry_cycles);
    }
    settle_rate();
    throttle.cycles = product_q16(throttle.cycles, slower);
    throttle.rate_q8 = product_q16(throttle.rate_q8, faster);
    throttle.mark = 0;
}

static void take_limits(const struct block *block)
{
    throttle.accel_q = block->accel_q;
    throttle.jump_q8 = block->jump_q8;
    throttle.jump_cycles = block->jump_cycles;
}

void throttle_settle_limits(void)
{
    if (!player.limits_owed)
        return;
    player.limits_owed = false;
    throttle.turn++;
    throttle.is_steady = false;
    take_limits(player.block);
}

void throttle_enter(const struct block *block, uint32_t exit)
{
    if (may_run_dry())
        wish(MAY_RUN_DRY);
    if (block->override_q8 > throttle.override_q8)
        wish(IS_LIMITED);
    throttle.is_steady = false;
    throttle.turn++;
    if (!block->moving) {
        throttle.jump_cycles = 0;
        if (throttle.state == OPENING || throttle.state == LIMITED)
            throttle_reset();
        return;
    }
    if (exit && block->entry_cycles && throttle.state != OPEN && throttle.state != HELD)
        scale(block, exit);
    take_limits(block);
    if (throttle.state == OPEN && !exit && is_above_jump(block->entry_cycles)) {
        /* The plan begins at speed, but what came before it was late or dropped. */
        throttle_hold();
        throttle_open();
    }
}

SELDOM void throttle_work_ahead(void)
{
    uint8_t turn = *(volatile uint8_t *)&throttle.turn;
    if (throttle.ready == turn)
        return;
    struct move move = {throttle.state, throttle.rate_q8, throttle.cycles};
    uint32_t mark = throttle.mark;
    if (throttle.rate_owed)
        move.rate_q8 = rate_over(throttle.rate_of ? throttle.rate_of : 1);
    else if (mark)
        work_out(&move, mark);
    else
        return;
    if (*(volatile uint8_t *)&throttle.turn != turn)
        return;
    throttle.next_state = move.state;
    throttle.next_rate_q8 = move.rate_q8;
    throttle.next_cycles = move.cycles;
    __asm__ __volatile__("" ::: "memory");
    throttle.ready = turn;
}

SELDOM void throttle_prepare(struct block *block)
{
    uint32_t top = rate_over(block->top_cycles ? block->top_cycles : 1);
    block->ceiling_q8 = scaled_rate(top, throttle.override_q8, block->override_q8);
    __asm__ __volatile__("" ::: "memory");
    block->flags |= BLOCK_CEILING;
}

SELDOM void throttle_set_override(uint16_t override_q8)
{
    /* The interrupt must not see a new override with an old ceiling. */
    uint8_t sreg = SREG;
    cli();
    blocks[0].flags &= (uint8_t)~BLOCK_CEILING;
    blocks[1].flags &= (uint8_t)~BLOCK_CEILING;
    throttle.override_q8 = override_q8;
    SREG = sreg;
    for (uint8_t slot = 0; slot < 2; slot++)
        if (blocks[slot].override_q8 > override_q8 && blocks[slot].top_cycles)
            throttle_prepare(&blocks[slot]);
    player_offer();
    wish(IS_LIMITED);
}
