/* Rules: reader.h. The records: docs/bridge-protocol.md, section 4. */
#include "reader.h"

#include <avr/interrupt.h>
#include <string.h>

#include "arith.h"
#include "board.h"
#include "card.h"
#include "inputs.h"
#include "line.h"
#include "makeout.h"
#include "player.h"
#include "power.h"
#include "run.h"
#include "throttle.h"

static uint8_t ring[BOARD_RING];
static uint16_t head, tail, used;

/* Where a record stands that has not come wholly. */
static struct {
    enum { LENGTH, LENGTH_LOW, DRY_BACK, DRY_TICK, BODY } wants;
    uint16_t left;
    uint8_t back;
    uint8_t shift;
    uint32_t tick;
    uint16_t serial;
} arrival;

/* The block that is being decoded, and what goes on from block to block. */
static struct {
    uint8_t pieces_left; /* 0: a head is next */
    uint8_t slot;
    bool is_ready;
    bool is_broken;
    ticks_t ticks; /* in the pieces so far */
    uint32_t goes_on_q8;
    uint32_t exit_cycles;
    uint32_t accel_q, jump_q8, jump_cycles, jump_before;
    uint16_t override_q8;
    uint8_t share;
    energy_t energy;
    uint8_t data;
    bool is_ramp; /* the last piece was one, as the drives are told */
    uint16_t serial;
} reading;

/* On its own: inlined, it would leave its caller no registers. */
#define APART __attribute__((noinline))

/* ---- the ring */

SELDOM static void store(const uint8_t *bytes, uint8_t count)
{
    uint16_t room = BOARD_RING - head;
    used += count;
    if (count >= room) {
        memcpy(ring + head, bytes, room);
        bytes += room;
        count -= (uint8_t)room;
        head = 0;
        line_poll();
    }
    memcpy(ring + head, bytes, count);
    head += count;
    line_poll();
}

static uint8_t take_u8(void)
{
    line_poll();
    uint8_t byte = ring[tail];
    if (++tail == BOARD_RING)
        tail = 0;
    used--;
    return byte;
}

APART static uint32_t take(uint8_t bytes)
{
    union {
        uint32_t value;
        uint8_t byte[4];
    } number = {0};
    for (uint8_t i = 0; i < bytes; i++)
        number.byte[i] = take_u8();
    return number.value;
}

static int32_t take_signed(uint8_t bytes)
{
    uint32_t value = take(bytes);
    if (bytes == 1)
        return (int8_t)value;
    return bytes == 2 ? (int16_t)value : (int32_t)value;
}

uint16_t reader_free(void)
{
    return BOARD_RING - used;
}

bool reader_has_bytes(void)
{
    return used || arrival.wants != LENGTH;
}

bool reader_has_ready(void)
{
    return player.block ? piece_head != piece_tail : player_has_block();
}

/* ---- arrival */

SELDOM static void set_dry_point(void)
{
    throttle.dry_point = false;
    if (arrival.back == DRY_NONE)
        return;
    throttle.dry_serial = arrival.serial - arrival.back;
    throttle.dry_tick = arrival.tick;
    __asm__ __volatile__("" ::: "memory");
    throttle.dry_point = true;
    /* A block that begins from now on sees it itself. */
    player_offer();
    if ((int16_t)(*(volatile uint16_t *)&player.serial - throttle.dry_serial) >= 0)
        wish(MAY_RUN_DRY);
}

SELDOM static void record_arrived(void)
{
    arrival.serial++;
    set_dry_point();
    cli();
    records_waiting++;
    sei();
    arrival.wants = LENGTH;
    run_refilled();
}

SELDOM static void arrive(uint8_t byte)
{
    switch (arrival.wants) {
    case LENGTH:
        arrival.left = byte & 0x7F;
        arrival.wants = byte & 0x80 ? LENGTH_LOW : DRY_BACK;
        break;
    case LENGTH_LOW:
        arrival.left = arrival.left << 8 | byte;
        arrival.wants = DRY_BACK;
        break;
    case DRY_BACK:
        arrival.back = byte;
        arrival.tick = arrival.shift = 0;
        arrival.wants = byte == DRY_NONE ? BODY : DRY_TICK;
        break;
    case DRY_TICK:
        arrival.tick |= (uint32_t)(byte & 0x7F) << arrival.shift;
        arrival.shift += 7;
        if (!(byte & 0x80))
            arrival.wants = BODY;
        break;
    case BODY: /* see reader_take */
        break;
    }
}

void reader_take(const uint8_t *bytes, uint8_t count)
{
    while (count) {
        if (arrival.wants != BODY) {
            arrive(*bytes++);
            count--;
            continue;
        }
        uint8_t part = arrival.left < count ? (uint8_t)arrival.left : count;
        store(bytes, part);
        bytes += part;
        count -= part;
        arrival.left -= part;
        if (!arrival.left)
            record_arrived();
    }
}

uint16_t reader_last_serial(void)
{
    return arrival.serial;
}

SELDOM void reader_drop(void)
{
    head = tail = used = 0;
    records_waiting = 0;
    throttle.dry_point = false;
    memset(&reading, 0, sizeof reading);
    reading.accel_q = reading.jump_q8 = 1;
    reading.jump_cycles = RATE_CYCLES;
    reading.data = card.data;
    reading.serial = arrival.serial;
    blocks_read = player.taken = 0;
    player.next = 0;
    arrival.wants = LENGTH;
}

void reader_forget(void)
{
    arrival.serial = 0;
    reader_drop();
}

/* ---- decoding */

/* What follows a bad block would be wrong: nothing more is decoded before the queue is dropped. */
static void refuse(void)
{
    reading.is_broken = true;
    run_refuse_block();
}

APART static uint32_t take_short(void)
{
    uint8_t mantissa = take_u8();
    return (uint32_t)mantissa << (take_u8() & 31);
}

APART static void take_limits(uint8_t law, uint8_t rare)
{
    if (law & LAW_ACCEL)
        reading.accel_q = take_short();
    else if (rare & RARE_ACCEL)
        reading.accel_q = take(4);
    uint32_t jump = reading.jump_q8;
    if (law & LAW_JUMP)
        jump = take_short();
    else if (rare & RARE_JUMP)
        jump = take(4);
    if (jump != reading.jump_q8) {
        reading.jump_q8 = jump;
        reading.jump_cycles = rate_over(jump ? jump : 1);
    }
    if (law & LAW_OVERRIDE)
        reading.override_q8 = (uint16_t)take(2);
}

static const uint8_t widths[] = {1, 2, 4, 4};

APART static void set_mover(struct mover *mover, uint8_t motor, bool forward)
{
    if (card.facts.type == CARD_CLOCKS) {
        mover->at = card.facts.motor_bits[motor] & 0xAA;
        mover->delta = (int8_t)_BV(motor);
        return;
    }
    mover->at = (uint8_t)(uintptr_t)&tracks.motor[motor];
    mover->delta = forward ? 1 : -1;
}

/* Steps of every motor; the longest way. */
SELDOM static ticks_t take_steps(struct block *block, uint8_t shape, ticks_t *steps)
{
    uint8_t width = widths[(shape >> SHAPE_WIDTH_SHIFT) & 3];
    uint8_t moving = shape & SHAPE_MOTORS, forward = 0, leader = 0, leading = 0;
    ticks_t longest = 0;
    for (uint8_t motor = 0, bit = 1; motor < MOTORS_MAX; motor++, bit <<= 1, steps++) {
        if (!(moving & bit))
            continue;
        int32_t way = take_signed(width);
        if (way > 0)
            forward |= bit;
        ticks_t length = (ticks_t)(way < 0 ? -way : way);
        *steps = length;
        if (length > longest) {
            longest = length;
            leader = motor;
            leading = bit;
        }
    }
    block->moving = moving;
    block->forward = forward;
    block->leading = leading;
    if (moving)
        set_mover(&block->leader, leader, forward & leading);
    return longest;
}

/* Eighths of these many ticks take 16 bits. */
#define NARROW_TICKS (0x10000UL >> 3)

SELDOM static void set_minors(struct block *block, const ticks_t *steps)
{
    ticks_t ticks = block->ticks, limit = ticks << 3;
    struct minor *minor = block->minor;
    uint8_t count = 0, bits = block->moving & (uint8_t)~block->leading;
    block->limit = limit;
    for (uint8_t motor = 0, bit = 1; motor < MOTORS_MAX; motor++, bit <<= 1, steps++) {
        line_poll();
        if (!(bits & bit))
            continue;
        set_mover(&minor->mover, motor, block->forward & bit);
        minor->sum = ((ticks - *steps) >> 1 << 3) - limit;
        minor++;
        block->steps[count] = *steps;
        block->minor_bits[count] = bit;
        count++;
    }
    bool is_narrow = ticks < NARROW_TICKS;
    block->narrow = is_narrow ? count : 0;
    block->wide = is_narrow ? 0 : count;
}

/* Direction bits of the motors that move; the others keep theirs. */
SELDOM static void set_data(struct block *block)
{
    uint8_t data = reading.data, highs = block->forward;
    const uint8_t *bits = card.facts.motor_bits;
    if (!card.facts.forward_high)
        highs = ~highs;
    for (uint8_t bit = 1; bit < _BV(MOTORS_MAX); bit <<= 1, bits++) {
        uint8_t line = *bits & 0x55;
        if (block->moving & bit)
            data = highs & bit ? data | line : data & (uint8_t)~line;
    }
    if (data != reading.data)
        block->is_plain = false; /* directions turn */
    block->data = reading.data = data;
}

SELDOM static void take_watch(struct block *block)
{
    uint8_t mask = take_u8();
    block->watch_pins = pins_of(mask);
    block->watch_value = levels_of(take_u8()) & block->watch_pins;
    block->watch_action = take_u8();
}

/* A power holds until another one comes. */
SELDOM static void take_power(struct block *block, uint8_t rare)
{
    reading.energy = rare & RARE_ENERGY ? (energy_t)take_short() : 0;
    reading.share = rare & RARE_SHARE ? take_u8() : 0;
    if (is_phase_card())
        block->outputs_due |= DUE_POWER;
}

static void block_is_ready(void)
{
    reading.is_ready = true;
    blocks_read++;
    cli();
    records_waiting--;
    sei();
    player_offer();
}

SELDOM static void read_head(void)
{
    struct block *block = &blocks[reading.slot];
    ticks_t steps[MOTORS_MAX];
    uint8_t shape = take_u8(), law = take_u8();
    uint8_t rare = shape & SHAPE_RARE ? take_u8() : 0;
    uint8_t count = law & LAW_PIECES;
    if (count == LAW_PIECES)
        count = take_u8();
    block->ticks = take_steps(block, shape, steps);
    if (!block->moving && count)
        block->ticks = 1; /* a dwell: how many is known with its last piece */
    set_minors(block, steps);
    line_poll();
    take_limits(law, rare);
    block->accel_q = reading.accel_q;
    block->jump_q8 = reading.jump_q8;
    block->jump_cycles = reading.jump_cycles;
    block->jump_before = reading.jump_before;
    reading.jump_before = block->moving ? reading.jump_cycles : 0;
    block->override_q8 = reading.override_q8;
    block->top_cycles = rare & RARE_TOP ? take(3) : 0;
    block->watch_pins = 0;
    if (rare & RARE_WATCH)
        take_watch(block);
    block->outputs_due = rare & RARE_OUTPUTS;
    block->outputs = block->outputs_due ? take_u8() : 0;
    if (rare & (RARE_SHARE | RARE_ENERGY))
        take_power(block, rare);
    block->share = reading.share;
    block->energy = reading.energy;
    block->flags = 0;
    block->beats = 0;
    block->is_plain = true;
    block->shortest = 0xFFFF;
    block->serial = ++reading.serial;
    block->entry_cycles = 0;
    block->piece_end = 0;
    block->piece_is_last = true;
    block->exit_cycles = reading.exit_cycles;
    line_poll();
    if (card.facts.type == CARD_CLOCKS)
        set_data(block);
    reading.is_ready = false;
    reading.ticks = 0;
    reading.goes_on_q8 = 0;
    reading.pieces_left = count;
    if (!count) {
        reading.exit_cycles = 0;
        block->is_plain = false;
        block_is_ready();
        reading.slot ^= 1;
    }
}

static ticks_t take_ticks(uint8_t shape, const struct block *block)
{
    shape &= PIECE_TICKS;
    if (!shape)
        return block->ticks - reading.ticks;
    return take(shape == 3 ? 4 : shape);
}

static uint32_t take_interval(uint8_t shape)
{
    shape = (shape >> PIECE_INTERVAL_SHIFT) & 7;
    if (shape >= 3)
        return take(shape - 1);
    return reading.goes_on_q8 + (shape ? (uint32_t)take_signed(shape) : 0);
}

static int32_t take_add(uint8_t shape)
{
    shape = (shape >> PIECE_ADD_SHIFT) & 3;
    return shape ? take_signed(widths[shape - 1]) : 0;
}

/* First piece known: the block can be played. */
static void finish_block(struct block *block)
{
    block->entry_cycles = block->interval_q8 >> 8;
    if (!block->top_cycles)
        block->top_cycles = block->entry_cycles;
    if (block->override_q8 > throttle.override_q8)
        throttle_prepare(block);
    make_out_ahead(block);
    power_prepare(block);
    block_is_ready();
}

SELDOM static void read_piece(void)
{
    struct block *block = &blocks[reading.slot];
    uint8_t shape = take_u8();
    ticks_t ticks = take_ticks(shape, block);
    uint32_t interval_q8 = take_interval(shape);
    int32_t add_q8 = take_add(shape);
    line_poll();
    reading.ticks += ticks;
    reading.goes_on_q8 = interval_q8 + (uint32_t)ticks * (uint32_t)add_q8;
    bool is_last = --reading.pieces_left == 0;
    bool is_whole = !block->moving || reading.ticks == block->ticks;
    if (!ticks || (is_last && !is_whole) || (block->moving && interval_q8 < 256)) {
        refuse();
        return;
    }
    if (is_last) {
        if (!block->moving)
            block->ticks = reading.ticks;
        reading.exit_cycles = block->moving ? (reading.goes_on_q8 - (uint32_t)add_q8) >> 8 : 0;
    }
    if (ticks == 1 && card.facts.type == CARD_PHASES)
        add_q8 = 0; /* it is never added */
    bool was_ramp = reading.is_ramp;
    reading.is_ramp = shape & PIECE_RAMP;
    bool turns_boost = card.facts.type == CARD_CLOCKS && reading.is_ramp != was_ramp;
    if (reading.is_ready) {
        struct piece *piece = &pieces[piece_head];
        piece->end = reading.ticks;
        piece->interval_q8 = interval_q8;
        piece->add_q8 = add_q8;
        piece->last = is_last;
        piece->is_ramp = reading.is_ramp;
        make_out_piece_ahead(block, piece);
        if (turns_boost)
            piece->ramps = card.facts.boost.mask & 0x08 ? RAMP_SLOW : piece->ramps | _BV(RAMP_TURNS);
        piece_head = (uint8_t)(piece_head + 1) & (PIECES - 1);
    } else {
        block->piece_end = reading.ticks;
        block->interval_q8 = interval_q8;
        block->add_q8 = add_q8;
        block->piece_is_last = is_last;
        block->is_ramp = reading.is_ramp;
        block->is_plain &= !turns_boost;
        finish_block(block);
    }
    if (is_last)
        reading.slot ^= 1;
}

/* Ratios of the coming junction, for a throttle that may not be open then. While it is open, what
 * comes over the line goes first. One at a time: a slot may become free meanwhile. */
SELDOM static bool prepare_junction(void)
{
    if (throttle.state == OPEN && line_waiting())
        return false;
    struct block *block = &blocks[*(volatile uint8_t *)&player.taken & 1];
    if (!player_has_block() || block->flags & BLOCK_RATIOS)
        return false;
    if (!block->moving || !block->exit_cycles || !block->entry_cycles)
        return false;
    if (!(block->flags & BLOCK_SLOWER)) {
        block->slower_q16 = ratio_q16(block->entry_cycles, block->exit_cycles);
        block->flags |= BLOCK_SLOWER;
        return true;
    }
    block->faster_q16 = ratio_q16(block->exit_cycles, block->entry_cycles);
    __asm__ __volatile__("" ::: "memory");
    block->flags |= BLOCK_RATIOS;
    return true;
}

static bool is_slot_free(void)
{
    uint8_t ahead = blocks_read - *(volatile uint8_t *)&player.taken;
    return ahead < 2 && player.block != &blocks[reading.slot];
}

bool reader_service(void)
{
    if (reading.is_broken)
        return false;
    if (!reading.pieces_left) {
        if (!records_waiting || !is_slot_free())
            return prepare_junction();
        read_head();
    } else if (reading.is_ready && ((piece_head + 1) & (PIECES - 1)) == piece_tail) {
        return prepare_junction();
    }
    if (reading.pieces_left)
        read_piece();
    return true;
}
