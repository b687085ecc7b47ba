/* Rules: run.h. */
#include "run.h"

#include <avr/interrupt.h>

#include "card.h"
#include "inputs.h"
#include "link.h"
#include "player.h"
#include "power.h"
#include "reader.h"
#include "throttle.h"

#define CYCLES_PER_MS 16000UL
#define MARK_CYCLES (4 * CYCLES_PER_MS)

struct run run;
static uint32_t settled_at;
static uint32_t rested_at = 0x80000000; /* long ago */
static uint32_t marked_at;
static uint16_t timer_seen;
static uint32_t silence_cycles;
static uint8_t wanted_mask, wanted_value;

/* ---- in the interrupt */

void run_make_outputs(void)
{
    unwish(WANT_OUTPUTS);
    card_want_outputs(wanted_mask, wanted_value, false);
}

void run_make_block_outputs(struct block *block)
{
    power_enter(block);
    block->outputs_due = 0;
    card_want_outputs(block->outputs >> 4, block->outputs & 0x0F, false);
}

void run_set_up(const struct block *block)
{
    if (card.facts.type != CARD_CLOCKS || block->data == card.data)
        return;
    card.data = block->data;
    if (!card.facts.setup_cycles)
        return; /* they change with the edge */
    card_write_data(card.data);
    uint16_t since_fall = TCNT1 - player.due;
    uint32_t ready = (uint32_t)since_fall + card.facts.setup_cycles;
    if (player.rest.ready < ready)
        player.rest.ready = ready;
}

void run_show_ramp(void)
{
    throttle.owes_signals = false;
    if (card.facts.type == CARD_CLOCKS)
        card_signals(true, throttle.state != OPEN || player.block->is_ramp);
}

/* ---- in the main loop */

void run_time(void)
{
    cli();
    uint16_t timer = TCNT1;
    sei();
    run.now += (uint16_t)(timer - timer_seen);
    timer_seen = timer;
    if (run.now - marked_at >= MARK_CYCLES) {
        marked_at += MARK_CYCLES;
        inputs_mark_time();
    }
}

static void rest(void)
{
    card_rest();
    player_rest();
    throttle.owes_signals = true;
    if (run.state == MOVING)
        rested_at = run.now;
    run.state = STANDING;
    run.version++;
}

static bool has_work(void)
{
    return player.block || player_has_block() || records_waiting;
}

/* Motors that stop above their start/stop rate may have turned on. */
static void note_torn(void)
{
    throttle_settle_limits();
    bool before = player.block && !player.done;
    uint32_t jump = before ? player.block->jump_before : throttle.jump_cycles;
    uint32_t last = player_last();
    if (!last || last >= jump - (jump >> 4))
        return;
    run.torn = true;
    run.torn_serial = (uint8_t)(player.serial - before);
}

static void finish(uint8_t ended)
{
    bool kept = ended == ENDED_TARGET;
    bool braked = throttle_is_closed() && !throttle.dry;
    note_torn();
    if (!kept) {
        /* Where nothing is dropped, limits go on from block to block: more may be on its way. */
        if (has_work() || reader_has_bytes() || run_is_moving()) {
            run.epoch++;
            player_drop();
            reader_drop();
        }
        card_forget_safe_outputs();
        unwish(WANT_BRAKE);
    }
    rest();
    if (kept && braked)
        throttle_hold();
    else
        throttle_reset();
    throttle.dry = false;
    unwish(WANT_STOP);
    unwish(WANT_OPEN);
    inputs.drop_when_still = false;
    inputs.stop_reason = ENDED_STOP;
    run.silenced = false;
    run.ended = ended;
}

static void begin(void)
{
    for (uint8_t i = 0; i < card.facts.readings; i++)
        inputs_sample();
    card_run();
    run.torn = false;
    run.ended = ENDED_NOT;
    run.state = MOVING;
    run.version++;
    player_start(run.now - rested_at);
}

/* A brake at standstill holds what comes next. */
static void hold(void)
{
    unwish(WANT_BRAKE);
    throttle.dry = false;
    throttle_hold();
}

void run_start(void)
{
    if (run.state != STANDING || !has_work())
        return;
    if (wished(WANT_BRAKE))
        hold();
    if (throttle.state == HELD)
        return;
    settled_at = run.now;
    if (!card.energised) {
        card_energise();
        settled_at += card.facts.settle_cycles;
    }
    run.state = SETTLING;
}

static void open_and_start(void)
{
    bool was_held = throttle.state == HELD;
    throttle_open();
    if (was_held)
        run_start();
}

void run_resume(void)
{
    if (inputs.drop_when_still)
        return;
    unwish(WANT_BRAKE);
    if (run.state == MOVING) {
        wish(WANT_OPEN);
        return;
    }
    open_and_start();
}

void run_brake(void)
{
    run.brakes++;
    wish(WANT_BRAKE);
}

void run_stop(void)
{
    run.stops++;
    wish(WANT_STOP);
}

void run_refuse_block(void)
{
    link.refused_seq = (uint8_t)(link.next_seq - 1);
    link.refused_code = REFUSED_BLOCK;
    wish(WANT_STOP);
}

bool run_flush(void)
{
    if (run_is_moving())
        return false;
    finish(ENDED_FLUSH);
    return true;
}

void run_set_outputs(uint8_t mask, uint8_t value)
{
    if (run.state != MOVING) {
        card_want_outputs(mask, value, true);
        return;
    }
    cli();
    if (!wished(WANT_OUTPUTS))
        wanted_mask = 0;
    wanted_mask |= mask;
    wanted_value = (uint8_t)((wanted_value & ~mask) | (value & mask));
    sei();
    wish(WANT_OUTPUTS);
}

void run_refilled(void)
{
    if (!throttle.dry)
        return;
    if (run.state == MOVING)
        wish(WANT_OPEN);
    else
        open_and_start();
}

void run_take_card(void)
{
    silence_cycles = card.facts.silence_ms * CYCLES_PER_MS;
}

void run_forget(void)
{
    finish(ENDED_NOT);
    run.epoch = run.brakes = run.stops = 0;
    player.serial = 0;
    inputs.latched = false;
    card.loaded = false;
}

void run_close(void)
{
    player_cut();
    finish(ENDED_STOP);
    card_set_outputs(0x0F, 0);
    card_idle(false);
}

static bool is_silent(void)
{
    return silence_cycles && run.now - run.life >= silence_cycles;
}

static void end_in_silence(void)
{
    finish(ENDED_SILENCE);
    card_set_outputs(0x0F, 0);
    card_idle(false);
    run.life = run.now;
}

/* At standstill: wishes are granted, inputs watched, the current not left on for nobody. */
static void stand(void)
{
    if (wished(WANT_STOP))
        finish(inputs.stop_reason);
    if (wished(WANT_BRAKE)) {
        unwish(WANT_OPEN);
        hold();
        run.version++;
    } else if (wished(WANT_OPEN)) {
        /* It came just after the motors were held. */
        unwish(WANT_OPEN);
        open_and_start();
    }
    inputs_sample();
    if (is_silent() && (card.energised || has_work()))
        end_in_silence();
}

/* The interrupt has stopped its timer. */
static void follow_halt(uint8_t halt)
{
    if (halt == STARVED && !wished(WANT_STOP)) {
        if (reader_has_ready())
            player_continue();
    } else if (halt == AT_STOP || halt == STARVED) {
        finish(inputs.stop_reason);
    } else if (run.silenced) {
        end_in_silence();
    } else if (halt == AT_END) {
        finish(inputs.drop_when_still ? ENDED_WATCH : ENDED_TARGET);
    } else if (inputs.drop_when_still) {
        finish(ENDED_WATCH);
    } else {
        rest();
    }
}

void run_service(void)
{
    if (run.state == STANDING) {
        stand();
    } else if (run.state == SETTLING) {
        if (wished(WANT_STOP))
            finish(inputs.stop_reason);
        else if ((int32_t)(run.now - settled_at) >= 0)
            begin();
    } else if (player.halt != PLAYING) {
        follow_halt(player.halt);
    } else if (is_silent() && !run.silenced) {
        run.silenced = true;
        wish(WANT_BRAKE);
    }
}
