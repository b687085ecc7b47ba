/* Rules: player.h. */
#include "player.h"

#include <avr/interrupt.h>

#include "beat.h"
#include "inputs.h"
#include "line.h"
#include "run.h"
#include "throttle.h"

/* From the compare match to the deadline: entry, saving registers, the longest lock, the wait. */
#define EARLY_CYCLES 110
/* No compare match is set closer than this: it might pass while it is being set. */
#define NEAR_CYCLES 6
#define FAR_CYCLES 0xC000U
#define HOP_CYCLES 0x8000U
#define SOON_CYCLES 600

struct player player;
struct beat beat;
struct block blocks[2];
volatile uint8_t block_ready;
uint8_t block_next;
struct piece pieces[PIECES];
volatile uint8_t piece_head, piece_tail;
volatile uint16_t records_waiting;

/* Hops that are still to be waited, what comes after them, and how long has been waited. */
static struct {
    bool on;
    bool may_choose; /* no beat of the tick was played yet */
    uint32_t left;
    uint16_t rest;
    uint32_t gone_cycles;
    uint32_t sums[MOTORS_MAX - 1];
    uint8_t phases[MOTORS_MAX];
} hop;

static void set_compare(void)
{
    OCR1A = player.due - EARLY_CYCLES;
}

static __attribute__((noinline)) void schedule_far(uint32_t wait)
{
    hop.on = true;
    hop.left = (wait - HOP_CYCLES / 2) >> 15;
    hop.rest = (uint16_t)(wait - (hop.left << 15));
    hop.gone_cycles = 0;
    player.due += HOP_CYCLES;
}

HERE void schedule(uint32_t wait)
{
    if (wait >= FAR_CYCLES)
        schedule_far(wait);
    else
        player.due += (uint16_t)wait;
    set_compare();
}

static void keep_state(void)
{
    for (uint8_t i = 0; i < MOTORS_MAX - 1; i++)
        hop.sums[i] = player.block->minor[i].sum;
    for (uint8_t i = 0; i < MOTORS_MAX; i++)
        hop.phases[i] = card.phase[i];
}

static void restore_state(void)
{
    for (uint8_t i = 0; i < MOTORS_MAX - 1; i++)
        player.block->minor[i].sum = hop.sums[i];
    for (uint8_t i = 0; i < MOTORS_MAX; i++)
        card.phase[i] = hop.phases[i];
}

/* A write came late: all that follows moves, and a bad one is counted. */
static __attribute__((noinline)) void note_late(uint16_t late, uint32_t interval)
{
    if ((uint32_t)late << 4 <= interval)
        return;
    player.due += late;
    if ((uint32_t)late << 2 > interval)
        player.late_ticks++;
}

/* Divide the tick in hand into beats, and the minors' shares with it. */
static void set_beats(uint32_t cycles)
{
    struct block *block = player.block;
    uint16_t shortest = card.facts.beat_cycles;
    uint8_t shift = 0;
    if (shortest && block->minors) {
        uint32_t part = cycles >> 1;
        while (shift < 3 && part >= shortest) {
            shift++;
            part >>= 1;
        }
    }
    player.beat_cycles = cycles >> shift;
    player.lag_cycles = cycles & (uint8_t)((1 << shift) - 1);
    player.beat_shift = shift;
    for (uint8_t i = 0; i < block->minors; i++)
        block->minor[i].add = block->minor[i].steps << (3 - shift);
}

/* Interval chosen: the tick is in hand. */
HERE void take_tick(uint32_t cycles)
{
    if (cycles != player.cycles || !player.beat_cycles) {
        player.cycles = cycles;
        set_beats(cycles);
    }
    player.beats_left = (uint8_t)(1 << player.beat_shift);
}

static void make_outputs_of(struct block *block)
{
    uint8_t mask = block->outputs >> 4, value = block->outputs & 0x0F;
    block->outputs_due = false;
    card.outputs = (uint8_t)((card.outputs & ~mask) | (value & mask));
    uint8_t control = card_control_with(mask, value);
    if (control == card.control)
        return;
    card.control = control;
    card.control_high = CONTROL_HIGH(control);
    beat.control_high = card.control_high;
    beat.control_extra = (uint8_t)(CONTROL_EXTRA(control) | EXTRA_REST);
    beat.control_due = true;
}

/* Make out the next beat in which something is to be done; how long until then. */
HERE uint32_t prepare_phases(void)
{
    struct block *block = player.block;
    uint32_t wait = 0, limit = block->limit;
    uint8_t count = 0, left = player.beats_left, forward = block->forward;
    uint8_t high = card.control_high;
    do {
        wait += player.beat_cycles;
        if (--left == 0) {
            wait += player.lag_cycles;
            if (block->moving)
                add_movement(block->leader, forward, &count, high);
        }
        struct minor *minor = block->minor;
        for (uint8_t n = block->minors; n; n--, minor++)
            if (minor_steps(minor, limit))
                add_movement(minor->motor, forward, &count, high);
    } while (left && !count);
    player.beats_left = left;
    beat.count = count;
    return wait;
}

/* The same with outputs that change first, and for waits so long that they may be taken back. */
static __attribute__((noinline)) uint32_t prepare_phases_slowly(void)
{
    keep_state();
    uint32_t wait = prepare_phases();
    if (player.block->outputs_due) {
        make_outputs_of(player.block);
        for (uint8_t n = 0; n < beat.count; n++)
            beat.high[n] = (uint8_t)((beat.high[n] & DATA_HIGH_MASK) | card.control_high);
    }
    return wait;
}

static uint8_t clock_bits(uint8_t motors)
{
    uint8_t bits = 0;
    for (uint8_t bit = 0x02; motors; bit <<= 2, motors >>= 1)
        if (motors & 1)
            bits |= bit;
    return bits;
}

HERE void prepare_clocks(void)
{
    struct block *block = player.block;
    uint8_t motors = 0;
    if (block->moving) {
        motors = (uint8_t)_BV(block->leader);
        struct minor *minor = block->minor;
        for (uint8_t n = block->minors; n; n--, minor++)
            if (minor_steps(minor, block->limit))
                motors |= (uint8_t)_BV(minor->motor);
    }
    if (block->outputs_due)
        make_outputs_of(block);
    beat.count = 0;
    if (motors) {
        uint8_t data = card.data ^ clock_bits(motors);
        beat.low[0] = DATA_LOW(data);
        beat.high[0] = (uint8_t)(DATA_HIGH(data) | card.control_high);
        beat.motor[0] = motors;
        beat.count = 1;
    }
    player.beats_left = 0;
}

/* The block in hand is at its end, or given up. */
static void end_block(void)
{
    struct block *block = player.block;
    if (block->outputs_due && player.done == block->ticks)
        run_make_block_outputs(block);
    inputs_end_block();
    player.block = 0;
}

/* Take the next block in hand; false: there is none, see player.halt. */
static bool begin_block(void)
{
    uint8_t slot = block_next;
    if (!(block_ready & _BV(slot))) {
        player.halt = records_waiting ? STARVED : AT_END;
        return false;
    }
    struct block *block = &blocks[slot];
    block_ready &= (uint8_t)~_BV(slot);
    block_next = slot ^ 1;
    player.block = block;
    player.serial = block->serial;
    player.done = player.piece_end = 0;
    player.piece_is_last = !block->ticks;
    player.beat_cycles = 0;
    uint32_t exit = player.from_rest ? 0 : block->exit_cycles;
    player.from_rest = false;
    throttle_enter(block, exit);
    inputs_begin_block(block);
    return true;
}

static bool next_piece(void)
{
    uint8_t tail = piece_tail;
    if (tail == piece_head) {
        player.halt = STARVED;
        return false;
    }
    struct piece *piece = &pieces[tail];
    player.piece_end = piece->end;
    player.interval_q8 = piece->interval_q8;
    player.add_q8 = piece->add_q8;
    player.piece_is_last = piece->last;
    piece_tail = (uint8_t)(tail + 1) & (PIECES - 1);
    if (!player.done)
        run_set_up(player.block);
    run_show_ramp();
    return true;
}

/* Up to the next tick, over the ends of pieces and blocks; false: none, see player.halt. */
static __attribute__((noinline)) bool find_tick(uint32_t *cycles)
{
    while (!player.block || player.done == player.piece_end) {
        if (player.block && player.piece_is_last)
            end_block();
        else if (!(player.block ? next_piece() : begin_block()))
            return false;
    }
    *cycles = player.interval_q8 >> 8;
    return !WANT || throttle_choose(cycles, false);
}

HERE bool next_tick(uint32_t *cycles)
{
    if (player.done == player.piece_end || WANT)
        return find_tick(cycles);
    *cycles = player.interval_q8 >> 8;
    return true;
}

/* A tick of a phase card is chosen and its first beat made out, or the timer is stopped. */
HERE bool go_on_phases(uint32_t *wait)
{
    uint32_t cycles;
    if (!next_tick(&cycles))
        return false;
    take_tick(cycles);
    if (player.block->outputs_due || cycles >= FAR_CYCLES) {
        hop.may_choose = !player.block->outputs_due;
        *wait = prepare_phases_slowly();
    } else {
        hop.may_choose = false;
        *wait = prepare_phases();
    }
    return true;
}

HERE bool go_on_clocks(uint32_t *wait)
{
    uint32_t cycles;
    if (!next_tick(&cycles))
        return false;
    player.cycles = cycles;
    hop.may_choose = cycles >= FAR_CYCLES && !player.block->outputs_due;
    if (hop.may_choose)
        keep_state();
    prepare_clocks();
    player.tick_cycles = cycles > player.not_before ? cycles : player.not_before;
    *wait = player.tick_cycles - player.fall_cycles;
    return true;
}

static void tick_done(void)
{
    player.done++;
    player.version++;
    player.moved = 0;
    if (player.add_q8)
        player.interval_q8 += player.add_q8;
}

HERE void write_control(void)
{
    if (!beat.control_due)
        return;
    PORT_HIGH = (uint8_t)((PORT_HIGH & DATA_HIGH_MASK) | beat.control_high);
    PORT_EXTRA = beat.control_extra;
    beat.control_due = false;
}

/* Deadline of a beat on a phase card: write, read, then make out the next one. */
HERE bool play_phases(void)
{
    uint8_t count = beat.count, low = beat.low[0], high = beat.high[0], quiet = beat.quiet;
    uint8_t differ = beat.restless, n = 0;
    uint16_t late = wait_for(player.due);
    write_control();
    if (!count) {
        uint8_t pins = PIN_STATUS;
        beat.pins[0] = pins;
        differ |= pins ^ quiet;
    }
    while (n != count) {
        PORT_LOW = low;
        PORT_HIGH = high;
        PORT_HIGH = (uint8_t)(high & ~_BV(STROBE_BIT));
        uint8_t idle = high;
        player.moved |= beat.motor[n];
        n++;
        low = beat.low[n & (MOTORS_MAX - 1)];
        high = beat.high[n & (MOTORS_MAX - 1)];
        PORT_HIGH = idle;
        uint8_t pins = PIN_STATUS;
        beat.pins[n - 1] = pins;
        differ |= pins ^ quiet;
    }
    if (differ & beat.mind)
        inputs_examine_beat(count);
    uint32_t wait;
    if (player.beats_left) {
        if (late)
            note_late(late, player.beat_cycles);
        hop.may_choose = false;
        wait = prepare_phases();
    } else {
        if (late)
            note_late(late, player.cycles);
        player.last_cycles = player.cycles;
        tick_done();
        if (!go_on_phases(&wait))
            return false;
    }
    schedule(wait);
    return true;
}

/* Deadline of an edge or a fall of clock lines. */
HERE bool play_clocks(void)
{
    uint8_t low = beat.low[0], high = beat.high[0];
    bool writes = beat.count;
    uint16_t late = wait_for(player.due);
    if (player.fall_next) {
        PORT_LOW = low;
        PORT_HIGH = high;
        if (late)
            note_late(late, player.last_cycles >> 1);
        player.fall_next = false;
        uint32_t wait;
        if (!go_on_clocks(&wait))
            return false;
        schedule(wait);
        return true;
    }
    write_control();
    if (writes) {
        PORT_LOW = low;
        PORT_HIGH = high;
    }
    uint8_t pins = PIN_STATUS;
    if (writes)
        player.moved = beat.motor[0];
    beat.pins[0] = pins;
    if (((pins ^ beat.quiet) | beat.restless) & beat.mind)
        inputs_examine_beat(writes);
    player.last_cycles = player.tick_cycles;
    if (late)
        note_late(late, player.last_cycles);
    uint32_t half = player.cycles >> 1;
    player.fall_cycles = half > card.facts.pulse_cycles ? half : card.facts.pulse_cycles;
    player.not_before = player.fall_cycles + card.facts.pulse_cycles;
    beat.low[0] = DATA_LOW(card.data);
    beat.high[0] = (uint8_t)(DATA_HIGH(card.data) | card.control_high);
    player.fall_next = true;
    hop.may_choose = false;
    tick_done();
    schedule(player.fall_cycles);
    return true;
}

/* An interval that runs, chosen anew for a brake or a stop; false: no tick follows. */
static bool choose_again(void)
{
    uint32_t cycles = player.interval_q8 >> 8, wait;
    restore_state();
    if (!throttle_choose(&cycles, true))
        return false;
    take_tick(cycles);
    if (card.facts.type == CARD_PHASES) {
        wait = prepare_phases();
    } else {
        prepare_clocks();
        player.tick_cycles = cycles > player.not_before ? cycles : player.not_before;
        wait = player.tick_cycles - player.fall_cycles;
    }
    uint32_t passed = hop.gone_cycles + SOON_CYCLES;
    schedule(wait > passed ? wait - hop.gone_cycles : SOON_CYCLES);
    return true;
}

/* A hop of a long wait is over; false: no tick follows. */
static __attribute__((noinline)) bool play_hop(void)
{
    hop.gone_cycles += HOP_CYCLES;
    if (--hop.left == 0)
        hop.on = false;
    if (hop.may_choose && (WANT & (_BV(WANT_BRAKE) | _BV(WANT_STOP)))) {
        hop.on = false;
        return choose_again();
    }
    player.due += hop.on ? HOP_CYCLES : hop.rest;
    set_compare();
    return true;
}

HERE bool play(void)
{
    if (hop.on)
        return play_hop();
    return card.facts.type == CARD_PHASES ? play_phases() : play_clocks();
}

ISR(TIMER1_COMPA_vect)
{
    for (;;) {
        if (!play()) {
            TIMSK1 = 0;
            return;
        }
        line_take();
        if ((int16_t)(OCR1A - TCNT1) >= NEAR_CYCLES)
            return;
        TIFR1 = _BV(OCF1A);
    }
}

static bool go_on(uint32_t *wait)
{
    return card.facts.type == CARD_PHASES ? go_on_phases(wait) : go_on_clocks(wait);
}

static void set_timer(void)
{
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
}

void player_start(void)
{
    uint32_t wait;
    player.halt = PLAYING;
    player.fall_cycles = player.not_before = 0;
    player.last_cycles = player.cycles = player.beat_cycles = 0;
    player.fall_next = hop.on = false;
    if (!player.block)
        player.from_rest = true;
    if (!go_on(&wait))
        return;
    cli();
    player.due = TCNT1 + SOON_CYCLES;
    schedule(wait);
    set_timer();
    sei();
}

void player_continue(void)
{
    uint32_t wait;
    player.halt = PLAYING;
    if (!go_on(&wait))
        return;
    cli();
    uint16_t gone = TCNT1 - player.due + SOON_CYCLES;
    if (wait < gone) {
        note_late((uint16_t)(gone - wait), player.cycles);
        wait = gone;
    }
    schedule(wait);
    set_timer();
    sei();
}

void player_rest(void)
{
    player.last_cycles = 0;
    player.from_rest = true;
    player.moved = 0;
}

void player_drop(void)
{
    if (player.block)
        inputs_end_block();
    player.block = 0;
    player.from_rest = true;
    block_ready = 0;
    piece_tail = piece_head;
}
