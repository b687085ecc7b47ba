/* Rules: card.h. */
#include "card.h"

#include "beat.h"
#include "power.h"

#define STROBE_NOPS() __builtin_avr_delay_cycles(6)

struct card card; /* and tracks: beats.S */

static const uint8_t zero_bytes[] = {0x1B, 0x5B, 0x9B};

void card_write_data(uint8_t data)
{
    write_pair(&PORT_LOW, DATA_LOW(data), &PORT_HIGH, DATA_HIGH(data) | card.control_high);
}

void card_shadow_control(uint8_t control)
{
    card.control = control;
    card.control_high = CONTROL_HIGH(control);
    for (uint8_t motor = 0; motor < MOTORS_MAX; motor++)
        tracks.motor[motor].high =
            (uint8_t)(DATA_HIGH(card.facts.motor_bits[motor] & 0xC0) | card.control_high);
}

void card_write_control(void)
{
    write_pair(&PORT_HIGH, (PORT_HIGH & DATA_HIGH_MASK) | card.control_high,
               &PORT_EXTRA, CONTROL_EXTRA(card.control) | EXTRA_REST);
}

static void strobe(void)
{
    PORT_HIGH &= (uint8_t)~_BV(STROBE_BIT);
    STROBE_NOPS();
    PORT_HIGH |= _BV(STROBE_BIT);
}

static void latch(uint8_t low, uint8_t high)
{
    write_pair(&PORT_LOW, low, &PORT_HIGH, high | card.control_high);
    strobe();
}

void card_after_reset(void)
{
    card_shadow_control(CONTROL_INVERTED & 0x0E); /* pins 14, 16, 17 low, pin 1 (strobe) high */
    card_write_control();
    board_directions();
    for (uint8_t i = 0; i < sizeof zero_bytes; i++)
        latch(DATA_LOW(zero_bytes[i]), DATA_HIGH(zero_bytes[i]));
    card_write_data(0);
}

static bool is_sound(const struct card_facts *facts)
{
    bool phases = facts->type == CARD_PHASES;
    if (facts->type > CARD_CLOCKS || facts->motors < 1 || facts->motors > MOTORS_MAX)
        return false;
    if (phases && (facts->table_length < TABLE_MIN || facts->table_length > TABLE_MAX))
        return false;
    return facts->outputs <= 4 && facts->readings && facts->strobe <= 1;
}

bool card_take_table(uint8_t which, const uint8_t *entries, uint8_t length)
{
    if (which > 1 || length < TABLE_MIN || length > TABLE_MAX)
        return false;
    uint8_t *table = which ? card.hold : tracks.table;
    while (length--)
        table[length] = DATA_LOW(entries[length] & 0x3F);
    return true;
}

/* Clock and direction: both data bits of a motor. What is no such pair means that it has its place. */
static uint8_t pair_of(uint8_t motor, uint8_t bits)
{
    uint8_t clock = bits & 0xAA;
    bool is_pair = clock && !(clock & (uint8_t)(clock - 1)) && bits == (clock | clock >> 1);
    return is_pair ? bits : (uint8_t)(3 << 2 * motor);
}

bool card_load(const uint8_t *bytes)
{
    const struct card_facts *facts = (const struct card_facts *)bytes;
    _Static_assert(sizeof *facts == CARD_LENGTH, "the card as it is uploaded");
    if (!is_sound(facts))
        return false;
    card.facts = *facts;
    for (uint8_t motor = 0; motor < MOTORS_MAX; motor++) {
        if (facts->type == CARD_CLOCKS)
            card.facts.motor_bits[motor] = pair_of(motor, facts->motor_bits[motor]);
        tracks.motor[motor].low = DATA_LOW(facts->motor_bits[motor] & 0xC0);
        tracks.motor[motor].bit = (uint8_t)_BV(motor);
        tracks.motor[motor].phase = 0;
    }
    card_shadow_control(facts->control_rest & 0x0F);
    card.data = facts->clock_rest;
    card.boost_mask = facts->boost.mask;
    card.boost_high = CONTROL_HIGH(facts->boost.mask ^ CONTROL_INVERTED);
    card.outputs = 0;
    card.loaded = true;
    card_idle(false);
    return true;
}

/* Each motor's byte at standstill: from a table (0 drive, 1 hold), or without current. */
static void stand(const uint8_t *table)
{
    for (uint8_t motor = 0; motor < card.facts.motors; motor++) {
        const struct motor *track = &tracks.motor[motor];
        uint8_t low = table ? table[track->phase] : DATA_LOW(card.facts.off & 0x3F);
        latch(low | track->low, track->high);
    }
}

void card_energise(void)
{
    if (card.facts.type == CARD_PHASES)
        stand(tracks.table);
    else
        card_set_outputs(card.facts.enable, card.facts.enable);
    card.energised = true;
}

static uint8_t with(uint8_t control, const struct output *line, bool on)
{
    return (uint8_t)((control & ~line->mask) | ((on ? line->on : ~line->on) & line->mask));
}

void card_idle(bool hold)
{
    const struct card_facts *facts = &card.facts;
    card.energised = false;
    if (facts->type == CARD_PHASES) {
        stand(hold && facts->holds ? card.hold : 0);
        return;
    }
    card_write_data(card.data);
    card.control = with(with(card.control, &facts->active, false), &facts->boost, false);
    card_shadow_control(card_control_with(facts->enable, hold ? facts->enable : 0));
    card_write_control();
}

uint8_t card_control_with(uint8_t mask, uint8_t value)
{
    uint8_t control = card.control;
    for (uint8_t i = 0; i < card.facts.outputs; i++)
        if (mask & _BV(i))
            control = with(control, &card.facts.output[i], value & _BV(i));
    return control;
}

static void change_control(uint8_t control)
{
    if (control == card.control)
        return;
    card_shadow_control(control);
    card_write_control();
}

void card_set_outputs(uint8_t mask, uint8_t value)
{
    change_control(card_control_with(mask, value));
}

void card_want_outputs(uint8_t mask, uint8_t value, bool standing)
{
    card.outputs = (uint8_t)((card.outputs & ~mask) | (value & mask));
    card_set_outputs(standing ? mask & ~card.facts.safe : mask, value);
}

void card_signals(bool active, bool boost)
{
    change_control(
        with(with(card.control, &card.facts.active, active), &card.facts.boost, boost));
}

void card_run(void)
{
    card_set_outputs(card.facts.safe, card.outputs);
}

void card_rest(void)
{
    card_signals(false, false);
    card_set_outputs(card.facts.safe, 0);
    power_rest();
}

void card_forget_safe_outputs(void)
{
    card.outputs &= (uint8_t)~card.facts.safe;
}
