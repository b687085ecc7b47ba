/* Rules: commands.h. The layouts: docs/bridge-protocol.md, section 5. */
#include <string.h>

#include "board.h"
#include "card.h"
#include "commands.h"
#include "frames.h"
#include "inputs.h"
#include "line.h"
#include "link.h"
#include "player.h"
#include "reader.h"
#include "run.h"
#include "throttle.h"

#define FIRMWARE_MAJOR 1
#define FIRMWARE_MINOR 4

static uint8_t reset_reason;
static uint16_t boots;
static uint8_t run_version, inputs_version;
static uint8_t *at;

void commands_begin(uint8_t reason, uint16_t boot_count)
{
    reset_reason = reason;
    boots = boot_count;
}

static void u8(uint8_t value)
{
    line_poll();
    *at++ = value;
}

static void u16(uint16_t value)
{
    u8((uint8_t)value);
    u8((uint8_t)(value >> 8));
}

static void u32(uint32_t value)
{
    u16((uint16_t)value);
    u16((uint16_t)(value >> 16));
}

static void place(const struct place *place)
{
    u16(place->serial);
    u32(place->done);
    u8(place->moved);
}

static void add_ack(void)
{
    u8(link.next_seq);
    u16(link.session);
    u8(link.gap ? ACK_GAP : 0);
    u8(run.epoch);
    u16(reader_free());
    u8(link.refused_seq);
    u8(link.refused_code);
    link.ack_due = link.gap = false;
}

/* What the interrupt changes, as of one moment. */
static uint32_t copy_place(struct place *place)
{
    uint32_t interval;
    uint8_t version;
    do {
        version = *(volatile uint8_t *)&player.done;
        place->serial = player.serial;
        place->done = player.done;
        place->moved = player.moved;
        interval = player_last();
    } while (version != *(volatile uint8_t *)&player.done
             || place->serial != *(volatile uint16_t *)&player.serial);
    return interval;
}

static uint8_t state_bits(void)
{
    uint8_t bits = 0;
    if (run_is_moving())
        bits |= STATE_MOVING;
    if (throttle.state == HELD)
        bits |= STATE_HELD;
    if (card.energised)
        bits |= STATE_ENERGISED;
    if (wished(WANT_BRAKE) || throttle.state == CLOSING)
        bits |= STATE_BRAKING;
    if (is_contact())
        bits |= STATE_SWITCH;
    if (inputs.latched)
        bits |= STATE_LATCHED;
    if (run.torn)
        bits |= STATE_TORN;
    if (throttle.dry)
        bits |= STATE_DRY;
    return bits;
}

static uint8_t more_bits(void)
{
    uint8_t bits = player.block ? MORE_IN_HAND : 0;
    if (card.loaded)
        bits |= MORE_CARD;
    if (is_contact())
        bits |= MORE_CONTACT;
    return bits;
}

static void send_status(void)
{
    struct place here;
    at = frames_open(KIND_STATUS);
    uint8_t *start = at;
    run_version = run.version;
    inputs_version = *(volatile uint8_t *)&inputs.version;
    link.status_due = false;
    uint32_t interval = copy_place(&here);
    add_ack();
    u8(state_bits());
    u8(more_bits());
    u8(run.ended);
    place(&here);
    u16(reader_last_serial());
    u32(interval);
    u8(status_of(PIN_STATUS & STATUS_PINS));
    place(&inputs.latched_at);
    u16(inputs.contact_serial);
    u16(inputs.contact_oldest);
    u16(player.late_ticks);
    u8(throttle.dry_queues);
    u8(throttle.late_throttle);
    u8(line.errors);
    u8(run.brakes);
    u8(run.stops);
    u16(throttle.override_q8);
    for (uint8_t motor = 0; motor < MOTORS_MAX; motor++)
        u8(tracks.motor[motor].phase);
    u8(run.torn_serial);
    frames_close((uint8_t)(at - start));
}

static void send_ack(void)
{
    at = frames_open(KIND_ACK);
    uint8_t *start = at;
    add_ack();
    frames_close((uint8_t)(at - start));
    if (link.session_ends)
        link.session = 0;
    link.session_ends = false;
}

static void send_hello(void)
{
    at = frames_open(KIND_HELLO_REPLY);
    uint8_t *start = at;
    link.hello_due = false;
    u8(PROTOCOL_VERSION);
    u16(link.session);
    u8(FIRMWARE_MAJOR);
    u8(FIRMWARE_MINOR);
    u16(BOARD_RING);
    u8(PAYLOAD_MAX);
    u8(MOTORS_MAX);
    u8(TABLE_MAX);
    u8(WINDOW);
    u8(ABLE_PHASES | ABLE_CLOCKS | ABLE_POWER);
    u8(reset_reason);
    u16(boots);
    u8(run_is_moving());
    for (const char *name = BOARD_NAME; *name; name++)
        u8((uint8_t)*name);
    frames_close((uint8_t)(at - start));
}

void reports_service(void)
{
    if (!frames_may_begin())
        return;
    bool has_news = run_version != run.version
        || inputs_version != *(volatile uint8_t *)&inputs.version;
    if (link.hello_due)
        send_hello();
    else if (link.session && (link.status_due || has_news))
        send_status();
    else if (link.status_due)
        send_status();
    else if (link.ack_due)
        send_ack();
}
