/* Rules: commands.h. */
#include "commands.h"

#include <avr/pgmspace.h>
#include <string.h>

#include "board.h"
#include "card.h"
#include "frames.h"
#include "inputs.h"
#include "link.h"
#include "player.h"
#include "power.h"
#include "reader.h"
#include "run.h"
#include "throttle.h"

struct link link;

#define ANY_LENGTH 0xFF
#define NEEDS_CARD 0x01
#define NEEDS_REST 0x02
#define NEEDS_EPOCH 0x04


static uint8_t do_table(const uint8_t *payload, uint8_t length)
{
    if (!length || !card_take_table(payload[0], payload + 1, length - 1))
        return REFUSED_PAYLOAD;
    return 0;
}

static uint8_t do_card(const uint8_t *payload, uint8_t length)
{
    (void)length;
    if (!card_load(payload))
        return REFUSED_PAYLOAD;
    power_forget();
    inputs_begin();
    run_take_card();
    reader_drop();
    return 0;
}

static uint8_t do_blocks(const uint8_t *payload, uint8_t length)
{
    if (length < 2)
        return REFUSED_PAYLOAD;
    reader_take(payload + 1, length - 1);
    return 0;
}

static uint8_t do_start(const uint8_t *payload, uint8_t length)
{
    (void)payload, (void)length;
    run_start();
    return 0;
}

static uint8_t do_resume(const uint8_t *payload, uint8_t length)
{
    (void)payload, (void)length;
    run_resume();
    return 0;
}

static uint8_t do_flush(const uint8_t *payload, uint8_t length)
{
    (void)payload, (void)length;
    run_flush();
    return 0;
}

static uint8_t do_idle(const uint8_t *payload, uint8_t length)
{
    (void)length;
    card_idle(payload[0] == 1);
    return 0;
}

static uint8_t do_outputs(const uint8_t *payload, uint8_t length)
{
    (void)length;
    run_set_outputs(payload[0], payload[1]);
    return 0;
}

static uint8_t do_mode(const uint8_t *payload, uint8_t length)
{
    (void)length;
    inputs.ignores_switch = payload[0] == 1;
    return 0;
}

static uint8_t do_override(const uint8_t *payload, uint8_t length)
{
    (void)length;
    throttle_set_override((uint16_t)(payload[0] | payload[1] << 8));
    return 0;
}

static uint8_t do_phases(const uint8_t *payload, uint8_t length)
{
    (void)length;
    for (uint8_t motor = 0; motor < MOTORS_MAX; motor++) {
        uint8_t table = card.facts.table_length ? card.facts.table_length : 1;
        tracks.motor[motor].phase = payload[motor] % table;
    }
    return 0;
}

static uint8_t do_ping(const uint8_t *payload, uint8_t length)
{
    (void)payload, (void)length;
    return 0;
}

static uint8_t do_power(const uint8_t *payload, uint8_t length)
{
    (void)length;
    power_take(payload[0]);
    return 0;
}

static uint8_t do_close(const uint8_t *payload, uint8_t length)
{
    (void)payload, (void)length;
    run_close();
    link.session_ends = true;
    return 0;
}

struct command {
    uint8_t length; /* of the payload */
    uint8_t needs;
    uint8_t (*carry_out)(const uint8_t *payload, uint8_t length);
};

static const struct command commands[] PROGMEM = {
    [KIND_TABLE] = {ANY_LENGTH, NEEDS_REST, do_table},
    [KIND_CARD] = {CARD_LENGTH, NEEDS_REST, do_card},
    [KIND_BLOCKS] = {ANY_LENGTH, NEEDS_CARD | NEEDS_EPOCH, do_blocks},
    [KIND_START] = {1, NEEDS_CARD | NEEDS_EPOCH, do_start},
    [KIND_RESUME] = {0, NEEDS_CARD, do_resume},
    [KIND_FLUSH] = {0, NEEDS_CARD | NEEDS_REST, do_flush},
    [KIND_IDLE] = {1, NEEDS_CARD | NEEDS_REST, do_idle},
    [KIND_OUTPUTS] = {2, NEEDS_CARD, do_outputs},
    [KIND_MODE] = {1, 0, do_mode},
    [KIND_OVERRIDE] = {2, 0, do_override},
    [KIND_PHASES] = {MOTORS_MAX, NEEDS_CARD | NEEDS_REST, do_phases},
    [KIND_PING] = {ANY_LENGTH, 0, do_ping},
    [KIND_CLOSE] = {0, NEEDS_CARD, do_close},
    [KIND_POWER] = {1, NEEDS_CARD | NEEDS_REST, do_power},
};

static uint8_t refusal_of(const struct command *command, const uint8_t *payload, uint8_t length)
{
    if (command->length != ANY_LENGTH && command->length != length)
        return REFUSED_PAYLOAD;
    if (command->needs & NEEDS_CARD && !card.loaded)
        return REFUSED_NO_CARD;
    if (command->needs & NEEDS_REST && run_is_moving())
        return REFUSED_MOVING;
    if (command->needs & NEEDS_EPOCH && (!length || payload[0] != run.epoch))
        return REFUSED_EPOCH;
    return 0;
}

static void carry_out(const uint8_t *content, uint8_t length)
{
    uint8_t kind = content[0], code = REFUSED_KIND;
    const uint8_t *payload = content + 2;
    struct command command = {0};
    if (kind < sizeof commands / sizeof *commands)
        memcpy_P(&command, &commands[kind], sizeof command);
    if (command.carry_out) {
        code = refusal_of(&command, payload, length);
        if (!code)
            code = command.carry_out(payload, length);
    }
    if (code) {
        link.refused_seq = content[1];
        link.refused_code = code;
    }
}

static void hello(const uint8_t *payload, uint8_t length)
{
    link.hello_due = true;
    if (length != 3 || run_is_moving())
        return;
    uint16_t session = (uint16_t)(payload[1] | payload[2] << 8);
    if (session == link.session)
        return; /* said again */
    run_forget();
    reader_forget();
    link.session = session;
    link.next_seq = 0;
    link.refused_code = link.refused_seq = 0;
    link.ack_due = link.gap = link.session_ends = false;
}

void command_take(const uint8_t *content, uint8_t length)
{
    uint8_t kind = content[0], ahead = (uint8_t)(content[1] - link.next_seq);
    if (kind == KIND_HELLO) {
        hello(content + 2, length);
        return;
    }
    link.ack_due = true;
    if (!link.session) {
        link.refused_seq = content[1];
        link.refused_code = REFUSED_NO_HELLO;
        return;
    }
    if (ahead) {
        link.gap = ahead < 0x80;
        return;
    }
    if (kind == KIND_BLOCKS && length > 1 && (uint16_t)(length - 1) > reader_free())
        return;
    link.next_seq++;
    link.gap = false;
    carry_out(content, length);
}

void command_urgent(uint8_t byte)
{
    if (byte == URGENT_STATUS)
        link.status_due = true;
    else if (byte == URGENT_BRAKE && card.loaded)
        run_brake();
    else if (byte == URGENT_STOP && card.loaded)
        run_stop();
}
