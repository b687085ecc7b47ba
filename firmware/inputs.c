/* Rules: inputs.h. */
#include "inputs.h"

#include "beat.h"
#include "player.h"
#include "run.h"
#include "throttle.h"

#define MARKS 6 /* of 4 ms: at least 20 ms back, at most 24 */

struct inputs inputs;
static uint16_t marks[MARKS];

/* Pin k is status bit 7 - k; the register shows the inverse of pin 11. */
uint8_t pins_of(uint8_t status_mask)
{
    uint8_t pins = 0;
    for (uint8_t bit = 0; bit < 5; bit++)
        if (status_mask & (0x80 >> bit))
            pins |= (uint8_t)_BV(bit);
    return pins;
}

uint8_t levels_of(uint8_t status)
{
    return pins_of(status) ^ 0x01;
}

uint8_t status_of(uint8_t pins)
{
    uint8_t status = 0;
    pins ^= 0x01;
    for (uint8_t bit = 0; bit < 5; bit++)
        if (pins & _BV(bit))
            status |= (uint8_t)(0x80 >> bit);
    return status;
}

static void set_condition(struct condition *condition, uint8_t pins, uint8_t value)
{
    condition->pins = pins;
    condition->value = value & pins;
    condition->run = 0;
    condition->is_true = false;
}

/* Which readings need a look: all while a condition is being counted or a watch waits, else those
 * that differ from the last. */
static void set_quiet(void)
{
    beat.restless = inputs.open.run || inputs.watching ? RESTLESS : 0;
    beat.quiet = inputs.pins;
    beat.mind = inputs.open.pins | beat.restless;
    player.is_minded = inputs.watching | inputs.watch_hides_switch | is_contact();
}

static bool needs_look(uint8_t pins)
{
    return ((pins ^ beat.quiet) | beat.restless) & beat.mind;
}

void inputs_begin(void)
{
    uint8_t pins = pins_of(card.facts.switch_mask);
    set_condition(&inputs.open, pins, ~levels_of(card.facts.switch_value));
    inputs.open.is_true = true;
    inputs.watching = inputs.watch_hides_switch = inputs.latched = false;
    beat.mind = beat.restless = RESTLESS;
}

/* One reading; true: it changed the condition. */
static bool take(struct condition *condition, uint8_t pins, const struct place *place)
{
    if (((pins & condition->pins) == condition->value) == condition->is_true) {
        condition->run = 0;
        return false;
    }
    if (condition->run == 0)
        condition->first = *place;
    if (++condition->run < card.facts.readings)
        return false;
    condition->run = 0;
    condition->is_true = !condition->is_true;
    return true;
}

static void note_contact(void)
{
    if (is_contact()) {
        inputs.contact_serial = player.serial;
        inputs.contact_oldest = marks[MARKS - 1];
    }
    inputs.version++;
}

static void act_on_watch(void)
{
    if (!player.block || inputs.watch_action == WATCH_IGNORE)
        return;
    if (inputs.watch_action == WATCH_STOP) {
        inputs.drop_when_still = true;
        throttle_settle_limits();
        bool above = player_last() && player.block->moving && is_above_jump(player_last());
        if (!above) {
            inputs.stop_reason = ENDED_WATCH;
            wish(WANT_STOP);
            return;
        }
    }
    wish(WANT_BRAKE);
}

static void act_on_switch(void)
{
    bool acts = is_contact() && !inputs.watch_hides_switch && !inputs.ignores_switch;
    if (acts && player.block && !inputs.drop_when_still) {
        inputs.stop_reason = ENDED_SWITCH;
        wish(WANT_STOP);
    }
}

static void examine(uint8_t pins, const struct place *place)
{
    inputs.pins = pins & STATUS_PINS;
    if (take(&inputs.open, pins, place))
        note_contact();
    bool fulfilled = inputs.watching && take(&inputs.watch, pins, place);
    if (fulfilled) {
        inputs.latched_at = inputs.watch.first;
        inputs.latched = true;
        inputs.watching = false;
        inputs.watch_hides_switch &= inputs.watch_reacts;
        inputs.version++;
    }
    set_quiet();
    if (fulfilled)
        act_on_watch();
    act_on_switch();
}

void inputs_begin_block(const struct block *block)
{
    inputs.watching = block->watch_pins != 0;
    if (inputs.watching) {
        set_condition(&inputs.watch, block->watch_pins, block->watch_value);
        inputs.watch_hides_switch = block->watch_pins & inputs.open.pins;
        inputs.watch_reacts = block->watch_action != WATCH_IGNORE;
        inputs.watch_action = block->watch_action;
        inputs.latched = false;
        set_quiet();
    }
    act_on_switch();
}

void inputs_end_block(void)
{
    if (!(inputs.watching | inputs.watch_hides_switch))
        return;
    inputs.watching = inputs.watch_hides_switch = false;
    set_quiet();
}

/* Clock lines are known by their bits of the data byte. */
static uint8_t motors_of_beat(void)
{
    if (card.facts.type == CARD_PHASES)
        return beat.mask;
    uint8_t motors = 0;
    for (uint8_t motor = 0; motor < MOTORS_MAX; motor++)
        if (beat.mask & card.facts.motor_bits[motor])
            motors |= (uint8_t)_BV(motor);
    return motors;
}

/* Movements are the leader's, if it is its beat, then those of the others in motor order. */
void inputs_examine_beat(void)
{
    struct place place = {player.serial, player.done, player.moved};
    uint8_t count = beat_count(), left = motors_of_beat();
    if (!count && needs_look(beat.pins[0]))
        examine(beat.pins[0], &place);
    for (uint8_t n = 0; n < count; n++) {
        uint8_t motors = left & (uint8_t)-left;
        if (n == count - 1)
            motors = left; /* clock lines: all at once */
        else if (!n && !player.beats_left)
            motors = player.block->leading;
        left &= (uint8_t)~motors;
        place.moved |= motors;
        uint8_t pins = beat.pins[n];
        if (needs_look(pins))
            examine(pins, &place);
    }
}

void inputs_sample(void)
{
    struct place place = {player.serial, player.done, player.moved};
    uint8_t pins = PIN_STATUS & STATUS_PINS;
    if (needs_look(pins))
        examine(pins, &place);
    inputs.pins = pins;
}

void inputs_mark_time(void)
{
    for (uint8_t i = MARKS - 1; i; i--)
        marks[i] = marks[i - 1];
    /* Standing, no block is in hand but the next. */
    marks[0] = run_is_moving() ? player.serial : player.serial + 1;
}
