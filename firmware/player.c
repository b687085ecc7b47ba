/* Rules: player.h. */
#include "player.h"

#include <avr/interrupt.h>

#include "arith.h"
#include "beat.h"
#include "inputs.h"
#include "line.h"
#include "makeout.h"
#include "run.h"
#include "throttle.h"

#define HOP_CYCLES 0x4000U
#define HOP_SHIFT 14
/* From one reading of the inputs to the next in a long wait. */
#define READING_CYCLES 0x20000UL
/* What must be chosen and made out outside the interrupt is at least so far ahead. */
#define SOON_CYCLES 800
/* Pulses below this end in the interrupt in which they began, where C makes them. */
#define BRIEF_CYCLES 700
/* The exact wait is no longer than this. */
#define EXACT_CYCLES 200
/* Time begins so long after it is asked to: the first tick is chosen and made out until then. */
#define START_CYCLES 2400
/* From rest, clock lines do not rise before that is done. */
#define PREPARED_CYCLES 1600

/* From the look at the counter until a compare match that was found to be due later is set. */
#define SET_CYCLES 100

struct player player;
struct block blocks[2];
uint8_t blocks_read;
struct piece pieces[PIECES];
volatile uint8_t piece_head, piece_tail;
volatile uint16_t records_waiting;

/* A long wait, and what is needed to take back the beat that was made out for its end. */
static struct {
    uint32_t left;
    uint16_t last;
    uint32_t gone_cycles;
    bool may_choose; /* no beat of the tick was played yet */
    ticks_t sums[MOTORS_MAX - 1];
    uint8_t phases[MOTORS_MAX];
    struct rest rest; /* as it was before the tick */
} hop;

/* ---- when */

static void set_mode(uint8_t mode)
{
    MODE = mode;
    player.early = mode == MODE_PHASES ? EARLY_CYCLES
        : mode >= MODE_FAST_FALL       ? EARLY_CLOCKS_CYCLES
                                       : EARLY_SLOW_CYCLES;
}

static void set_compare(void)
{
    OCR1A = player.due - player.early;
}

/* The next interrupt, so long after the last deadline. */
static void arm(uint8_t mode, uint32_t wait)
{
    if (wait < FAR_CYCLES) {
        player.due += (uint16_t)wait;
    } else {
        hop.left = (wait - HOP_CYCLES / 2) >> HOP_SHIFT;
        hop.last = (uint16_t)(wait - (hop.left << HOP_SHIFT));
        hop.gone_cycles = 0;
        player.after_hops = mode;
        player.due += HOP_CYCLES;
        mode = MODE_HOP;
    }
    set_mode(mode);
    set_compare();
}

/* That much of its interval is too late. */
static bool is_much(uint16_t late, uint32_t interval)
{
    return (uint32_t)late << 2 > interval;
}

/* A write came late: if it was much, it is counted, and all that follows moves; with clock lines,
 * where a pulse could be cut short, in any case. */
SELDOM static void note_late(uint16_t late, uint32_t interval)
{
    bool much = is_much(late, interval);
    if (much || (!is_phase_card() && player.fall_cycles < (uint32_t)late + card.facts.pulse_cycles))
        player.due += late;
    player.late_ticks += much;
}

/* Clock lines: where the throttle chose too late, the pulse becomes as long as the pause was. The tick
 * is slower by both, which in a brake nobody minds. */
SELDOM static void note_late_rise(uint16_t late)
{
    uint16_t due = player.due;
    note_late(late, player.cycles);
    if (!is_half_duty() || !wished(IS_THROTTLED))
        return;
    player.due = due + late;
    player.fall_cycles += late;
    if (player.block->ramps == RAMP_STEADY)
        player.block->ramps = RAMP_NONE; /* the next pulse is the plan's again */
}

SELDOM uint32_t player_last(void)
{
    if (!player.cycles || (player.beats_left && player.done == player.chosen_at))
        return player.last_cycles;
    const struct block *block = player.block;
    if (player.beats_left && block && block->ramps == RAMP_FAST)
        return (block->interval_q8 - (uint32_t)block->add_q8) >> 8;
    return player.cycles;
}

/* ---- a tick that is taken, and taken back */

static void keep_state(void)
{
    for (uint8_t i = 0; i < MOTORS_MAX - 1; i++)
        hop.sums[i] = player.block->minor[i].sum;
    for (uint8_t i = 0; i < MOTORS_MAX; i++)
        hop.phases[i] = tracks.motor[i].phase;
}

static void restore_state(void)
{
    for (uint8_t i = 0; i < MOTORS_MAX - 1; i++)
        player.block->minor[i].sum = hop.sums[i];
    for (uint8_t i = 0; i < MOTORS_MAX; i++)
        tracks.motor[i].phase = hop.phases[i];
}

/* The tick in hand has this interval. */
static void take_tick(uint32_t cycles)
{
    struct block *block = player.block;
    if (cycles == player.cycles && block->beats && block->ramps == RAMP_NONE && !block->add_q8)
        ; /* as the one before */
    else if (cycles >= FAR_CYCLES)
        divide_far(block, cycles);
    else
        divide(block, (uint16_t)cycles);
    block->lag_cycles = (uint8_t)cycles & (block->beats - 1);
    player.beats_left = block->beats;
    player.cycles = cycles;
    player.chosen_at = player.done;
}

/* The same for the first beat of a tick, or for one in between; and set the timer to it. */
static void go_to_beat(bool first)
{
    struct block *block = player.block;
    hop.may_choose = first && player.cycles >= FAR_CYCLES && !block->outputs_due;
    if (hop.may_choose)
        keep_state();
    if (block->outputs_due)
        make_out_outputs(block);
    uint32_t wait = make_out_phases();
    bool usual = block->moving && player.cycles < FAR_CYCLES;
    arm(!usual ? MODE_SLOW : beat.control_due ? MODE_CONTROL : MODE_PHASES, wait);
}

/* How long a clock is away from rest in such a tick. */
SELDOM static uint32_t share_of(uint32_t cycles)
{
    uint16_t shortest = card.facts.pulse_cycles;
    uint32_t pulse = product_q16(cycles, card.facts.duty_q16);
    if (pulse > cycles - shortest)
        pulse = cycles - shortest;
    return pulse < shortest ? shortest : pulse;
}

static bool is_brief(void)
{
    return player.fall_cycles < BRIEF_CYCLES;
}

/* From the last deadline to an edge that has a pause of its own, or from rest none. */
SELDOM static uint32_t special_wait(uint32_t pause)
{
    uint32_t wait = pause;
    if (player.rest.stands && player.block->moving) {
        uint16_t setup = card.facts.setup_cycles;
        wait = pause > player.rest.stood ? pause - player.rest.stood : 0;
        if (wait < card.facts.pulse_cycles)
            wait = card.facts.pulse_cycles;
        if (wait < setup)
            wait = setup;
    }
    return wait < player.rest.ready ? player.rest.ready : wait;
}

/* An edge of clock lines, from the fall before it. */
static void go_to_edge(uint32_t cycles)
{
    struct block *block = player.block;
    hop.may_choose = cycles >= FAR_CYCLES && !block->outputs_due;
    if (block->outputs_due)
        make_out_outputs(block);
    if (!player.is_made_out)
        make_out_clocks();
    player.is_made_out = false;
    beat.entry[0].high = (uint8_t)((beat.entry[0].high & DATA_HIGH_MASK) | card.control_high);
    beat.rest.high = (uint8_t)((beat.rest.high & DATA_HIGH_MASK) | card.control_high);
    bool is_plan = cycles == block->interval_q8 >> 8;
    bool is_special = player.rest.stands || player.rest.ready;
    if (cycles < 2UL * card.facts.pulse_cycles)
        cycles = 2UL * card.facts.pulse_cycles;
    player.fall_cycles = is_half_duty() ? cycles >> 1 : share_of(cycles);
    uint32_t pause = cycles - player.fall_cycles;
    uint32_t wait = is_special ? special_wait(pause) : pause;
    player.cycles = cycles; /* a pause of its own makes no other rate */
    player.chosen_at = player.done;
    block->ramps = ramps_of(block->add_q8);
    bool is_asked = !is_half_duty() && (block->ramps == RAMP_FAST || is_brief());
    if (!block->moving || beat.control_due || cycles >= FAR_CYCLES || is_asked)
        block->ramps = RAMP_SLOW;
    arm(block->ramps != RAMP_SLOW ? MODE_FAST_RISE : MODE_RISE, wait);
    if (block->ramps == RAMP_NONE && is_plan) {
        player.wait_cycles = (uint16_t)pause;
        block->ramps = RAMP_STEADY;
    } else if (block->ramps == RAMP_NONE && !is_half_duty()) {
        block->ramps = RAMP_SLOW; /* chosen here once more */
    }
    hop.rest = player.rest;
    player.rest.stands = false;
    player.rest.ready = 0;
}

/* ---- which tick */

/* The block in hand is at its end, or given up. */
static void end_block(void)
{
    struct block *block = player.block;
    if (block->outputs_due && player.done == block->ticks)
        run_make_block_outputs(block);
    inputs_end_block();
    throttle_settle_limits();
    player.block = 0;
}

void player_offer(void)
{
    uint8_t taken, now;
    do {
        taken = player.taken;
        struct block *next = &blocks[taken & 1];
        if (!player_has_block() || !next->is_plain || throttle_minds(next))
            next = 0;
        uint8_t sreg = SREG;
        cli();
        now = *(volatile uint8_t *)&player.taken;
        if (now == taken)
            player.next = next;
        SREG = sreg;
    } while (now != taken);
}

/* Take the next block in hand; false: there is none, see player.halt. */
static bool begin_block(void)
{
    if (!player_has_block()) {
        player.halt = records_waiting ? STARVED : AT_END;
        return false;
    }
    struct block *block = &blocks[player.taken & 1];
    player.taken++;
    player.block = block;
    player.serial = block->serial;
    player.done = 0;
    player.is_made_out = false;
    block->ramps = RAMP_SLOW; /* the first interval is perhaps not the plan's */
    if (block->ticks)
        run_set_up(block);
    uint32_t exit = player.from_rest ? 0 : block->exit_cycles;
    player.from_rest = false;
    throttle_enter(block, exit);
    line_poll();
    inputs_begin_block(block);
    throttle.owes_signals |= block->piece_end != 0;
    player_offer();
    return true;
}

static bool next_piece(void)
{
    uint8_t tail = piece_tail;
    if (tail == piece_head) {
        player.halt = STARVED;
        return false;
    }
    struct block *block = player.block;
    const struct piece *piece = &pieces[tail];
    block->piece_end = piece->end;
    block->interval_q8 = piece->interval_q8;
    block->add_q8 = piece->add_q8;
    block->piece_is_last = piece->last;
    block->is_ramp = piece->is_ramp;
    piece_tail = (uint8_t)(tail + 1) & (PIECES - 1);
    throttle.owes_signals = true;
    return true;
}

/* Up to the next tick, over the ends of pieces and blocks; false: none, see player.halt. */
static bool find_tick(uint32_t *cycles)
{
    while (!player.block || player.done == player.block->piece_end) {
        if (player.block && player.block->piece_is_last)
            end_block();
        else if (!(player.block ? next_piece() : begin_block()))
            return false;
    }
    *cycles = player.block->interval_q8 >> 8;
    if (WANT)
        return throttle_choose(cycles, false);
    if (throttle.owes_signals)
        run_show_ramp();
    return true;
}

/* Choose the next tick and make out its first writes; false: there is none. */
static bool go_on(void)
{
    uint32_t cycles;
    player.last_cycles = player.cycles;
    if (!find_tick(&cycles))
        return false;
    line_poll();
    if (is_phase_card()) {
        take_tick(cycles);
        go_to_beat(true);
    } else {
        if (!player.block->beats)
            share_out(player.block, 1);
        player.block->beats = 1;
        go_to_edge(cycles);
    }
    return true;
}

static void tick_done(void)
{
    player.done++;
    player.moved = 0;
    player.block->interval_q8 += (uint32_t)player.block->add_q8;
}

/* ---- called by beats.S, which is given: 0, the timer is stopped; TIMER_SET; or the beats of a tick
 *      for which beats.S makes out the next one */

#define TIMER_SET 0xFF

void player_cut(void)
{
    TIMSK1 = 0;
}

static uint8_t or_stop(bool goes_on)
{
    if (goes_on)
        return TIMER_SET;
    TIMSK1 = 0;
    if (player.halt != STARVED)
        card_rest(); /* with the last fall, whatever the main loop is doing */
    return 0;
}

/* The tick is taken: its beats for beats.S to go on, or TIMER_SET. */
uint8_t player_hand_over(void)
{
    struct block *block = player.block;
    if (block->ramps == RAMP_SLOW) {
        go_to_beat(true);
        return TIMER_SET;
    }
    if (block->outputs_due)
        make_out_outputs(block);
    set_mode(beat.control_due ? MODE_CONTROL : MODE_PHASES);
    return block->beats;
}

static uint8_t take_next(void)
{
    uint32_t cycles;
    line_poll();
    player.last_cycles = player.cycles;
    if (!find_tick(&cycles))
        return or_stop(false);
    line_poll();
    take_tick(cycles);
    return player_hand_over();
}

/* A tick of a phase card was played and counted, and the next is no usual one. */
uint8_t player_tick(void)
{
    struct block *block = player.block;
    if (block->ramps != RAMP_NONE)
        block->interval_q8 += (uint32_t)block->add_q8;
    if (WANT == _BV(IS_THROTTLED) && player.done != block->piece_end
        && throttle_goes_on(block->interval_q8 >> 8, player.cycles)) {
        player.last_cycles = player.cycles;
        player.chosen_at = player.done;
        return block->beats;
    }
    return take_next();
}

/* The same, but the next interval is chosen: one of a ramp. */
uint8_t player_tick_chosen(void)
{
    player.last_cycles = player.cycles;
    take_tick(player.block->interval_q8 >> 8);
    return player_hand_over();
}

/* Outputs change, at the cycle. */
static uint16_t write_control(void)
{
    uint8_t high = (uint8_t)((PORT_HIGH & DATA_HIGH_MASK) | beat.control_high);
    beat.control_due = false;
    return write_control_at(player.due, high, beat.control_extra);
}

static void strobe_and_read(uint8_t n)
{
    PORT_HIGH &= (uint8_t)~_BV(STROBE_BIT);
    __builtin_avr_delay_cycles(5);
    PORT_HIGH |= _BV(STROBE_BIT);
    beat.pins[n] = PIN_STATUS;
}

/* The movements of a beat that beats.S leaves alone; how late the first write was. */
static uint16_t write_movements(void)
{
    const struct entry *entry = beat.entry;
    uint8_t count = beat_count(), n = 0;
    uint16_t late;
    if (beat.control_due) {
        late = write_control();
    } else if (count) {
        late = write_data_at(player.due, entry->low, entry->high);
        strobe_and_read(0);
        n = 1;
    } else {
        late = wait_for(player.due);
    }
    for (; n < count; n++) {
        write_pair(&PORT_LOW, entry[n].low, &PORT_HIGH, entry[n].high);
        strobe_and_read(n);
    }
    if (!count)
        beat.pins[0] = PIN_STATUS;
    return late;
}

/* A beat that beats.S leaves alone: of a dwell, with outputs, of a long interval. */
static uint8_t play_slowly(void)
{
    uint16_t late = write_movements();
    inputs_examine_beat();
    note_late(late, player.beats_left ? player.cycles << 1 : player.cycles);
    if (player.beats_left) {
        player.moved |= beat.mask;
        if (player.cycles >= FAR_CYCLES) {
            go_to_beat(false);
            return TIMER_SET;
        }
        set_mode(MODE_PHASES);
        return player.beats_left;
    }
    tick_done();
    return take_next();
}

/* The clock lines leave their rest; a brief pulse ends here too. */
static uint8_t play_rise(void)
{
    const struct entry *entry = beat.entry;
    uint16_t late;
    if (beat.control_due) {
        late = write_control();
        if (beat.mask)
            write_pair(&PORT_LOW, entry->low, &PORT_HIGH, entry->high);
    } else if (beat.mask) {
        late = write_data_at(player.due, entry->low, entry->high);
    } else {
        late = wait_for(player.due);
    }
    beat.pins[0] = PIN_STATUS;
    if (late)
        note_late_rise(late);
    bool has_fallen = is_brief();
    if (has_fallen) {
        player.due += (uint16_t)player.fall_cycles;
        while ((int16_t)(player.due - TCNT1) > EXACT_CYCLES)
            ;
        late = write_data_at(player.due, beat.rest.low, beat.rest.high);
        note_late(late, player.cycles >> 1);
    }
    inputs_examine_beat();
    hop.may_choose = false;
    tick_done();
    if (has_fallen)
        return or_stop(go_on());
    arm(MODE_FALL, player.fall_cycles);
    return TIMER_SET;
}

/* They go back to it; then directions may change, and the next interval is chosen. */
static bool play_fall(void)
{
    uint16_t late = write_data_at(player.due, beat.rest.low, beat.rest.high);
    note_late(late, player.cycles >> 1);
    return go_on();
}

/* Clock lines have fallen, and the next tick is no usual one. */
uint8_t player_fell(void)
{
    return or_stop(go_on());
}

/* A write of clock lines came late: rise or fall. */
void player_clocks_late(void)
{
    if (MODE & _BV(MODE_FALLS))
        note_late(player.late, player.cycles >> 1);
    else
        note_late_rise(player.late);
}

/* An interval that runs, chosen anew for a brake or a stop; false: no tick follows. */
SELDOM static bool choose_again(void)
{
    uint32_t cycles = player.block->interval_q8 >> 8, gone = hop.gone_cycles;
    player.cycles = player.last_cycles;
    /* Also if none follows: then it is made out once more after a hold, or never. */
    if (is_phase_card()) {
        restore_state();
    } else {
        player.is_made_out = true;
        player.rest = hop.rest;
    }
    if (!throttle_choose(&cycles, true))
        return false;
    uint16_t due = player.due;
    if (is_phase_card()) {
        take_tick(cycles);
        go_to_beat(true);
    } else {
        go_to_edge(cycles);
    }
    /* The wait counted from here; what has gone of it is taken off again. */
    uint32_t wait = MODE == MODE_HOP
        ? (hop.left << HOP_SHIFT) + hop.last
        : (uint16_t)(player.due - due);
    uint8_t mode = MODE == MODE_HOP ? player.after_hops : MODE;
    player.due = due;
    arm(mode, wait > gone + SOON_CYCLES ? wait - gone : SOON_CYCLES);
    hop.gone_cycles = gone;
    return true;
}

/* A hop of a long wait is over; false: no tick follows. */
SELDOM static bool play_hop(void)
{
    hop.gone_cycles += HOP_CYCLES;
    if (!(hop.gone_cycles & (READING_CYCLES - 1)))
        inputs_sample();
    if (hop.may_choose && WANT & (_BV(WANT_BRAKE) | _BV(WANT_STOP)))
        return choose_again();
    if (--hop.left) {
        player.due += HOP_CYCLES;
    } else {
        player.due += hop.last;
        set_mode(player.after_hops);
    }
    set_compare();
    return true;
}

uint8_t player_play(void)
{
    switch (MODE) {
    case MODE_HOP:
        return or_stop(play_hop());
    case MODE_RISE:
        return play_rise();
    case MODE_FALL:
        return or_stop(play_fall());
    default:
        return play_slowly();
    }
}

/* ---- in the main loop, with the timer stopped */

static void set_timer(void)
{
    player.patience = PATIENCE;
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
}

/* The match that was found to be due may have passed meanwhile; how much it moves. Moved even if it is
 * little: a match in the past would come a whole turn of the timer later. */
SELDOM static uint16_t see_to_match(uint16_t was_due)
{
    if (MODE == MODE_HOP)
        return 0;
    uint16_t moved = 0, wait = player.due - was_due;
    cli();
    uint16_t gone = TCNT1 - was_due + player.early + NEAR_CYCLES + SET_CYCLES;
    sei();
    if (wait < gone) {
        moved = gone - wait;
        player.due += moved;
    }
    set_compare();
    return moved;
}

SELDOM void player_start(uint32_t stood)
{
    player.halt = PLAYING;
    player.fall_cycles = 0;
    player.cycles = 0;
    player.from_rest = !player.block;
    player.rest.stands = true;
    player.rest.stood = stood;
    player.rest.ready = PREPARED_CYCLES;
    cli();
    uint16_t now = TCNT1;
    sei();
    player.due = is_phase_card() ? now + START_CYCLES : now;
    if (!go_on())
        return;
    if (!is_phase_card())
        see_to_match(now);
    set_timer();
}

SELDOM void player_continue(void)
{
    player.halt = PLAYING;
    uint16_t was_due = player.due;
    player.cycles = player.last_cycles;
    if (!go_on())
        return;
    player.late_ticks += is_much(see_to_match(was_due), player.cycles);
    set_timer();
}

void player_rest(void)
{
    player.cycles = player.last_cycles = 0;
    player.from_rest = true;
    player.moved = player.beats_left = 0;
}

void player_drop(void)
{
    if (player.block)
        inputs_end_block();
    player.block = 0;
    player.limits_owed = false;
    player.from_rest = true;
    piece_tail = piece_head;
}
