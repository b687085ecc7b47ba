/* Rules: frames.h. */
#include "frames.h"

#include <util/crc16.h>

#include "commands.h"
#include "line.h"
#include "run.h"

/* So many bytes of content are taken at one go. */
#define RUN 16

static struct {
    uint8_t content[CONTENT_MAX];
    uint8_t length;
    uint16_t crc;
    uint8_t previous;
    bool is_open, is_escaped, is_damaged;
} in = {.crc = CRC_START};

static struct {
    uint8_t content[2 + REPORT_MAX + 2];
    uint8_t length; /* with its CRC; 0: nothing to send */
    uint8_t at;
    uint16_t crc; /* of what was sent */
    uint8_t sequence;
    bool is_escaped; /* the byte at `at` is half sent */
    bool is_flagged;
} out;

static void begin_frame(void)
{
    in.length = 0;
    in.crc = CRC_START;
    in.is_open = in.is_escaped = in.is_damaged = false;
}

static bool end_frame(void)
{
    bool was_open = in.is_open, is_sound = !in.is_damaged && !in.is_escaped;
    is_sound = is_sound && in.length >= 4 && in.crc == 0;
    uint8_t length = in.length;
    begin_frame();
    if (!was_open)
        return false;
    if (!is_sound) {
        line.errors++;
        return false;
    }
    run.life = run.now;
    command_take(in.content, length - 4);
    return true;
}

static void take_urgent(uint8_t byte)
{
    if (in.is_open && byte != in.previous) {
        in.is_damaged = true;
        return;
    }
    run.life = run.now;
    command_urgent(byte);
}

static void take_content(uint8_t byte)
{
    in.is_open = true;
    if (in.length == CONTENT_MAX) {
        in.is_damaged = true;
        return;
    }
    in.content[in.length++] = byte;
    in.crc = _crc_xmodem_update(in.crc, byte);
}

/* True at the end of a frame. */
static bool take_byte(uint8_t byte)
{
    bool ended = false;
    if ((byte & RESERVED_MASK) != RESERVED) {
        take_content(in.is_escaped ? byte ^ ESCAPE_XOR : byte);
        in.is_escaped = false;
    } else if (byte == FLAG) {
        ended = end_frame();
    } else if (byte == ESCAPE) {
        in.is_open = true;
        in.is_damaged |= in.is_escaped;
        in.is_escaped = true;
    } else {
        take_urgent(byte);
    }
    in.previous = byte;
    return ended;
}

/* Content that needs no second look, as far as it has come: nothing reserved, nothing escaped. */
static void take_plain_content(void)
{
    uint8_t tail = line.tail, room = CONTENT_MAX - in.length;
    uint8_t most = room < RUN ? room : RUN, left = most;
    uint8_t *to = in.content + in.length;
    uint16_t crc = in.crc;
    for (; left && tail != *(volatile uint8_t *)&line.head; left--) {
        if (!(left & 3))
            line_poll();
        uint8_t byte = line.bytes[tail];
        if ((byte & RESERVED_MASK) == RESERVED)
            break;
        *to++ = byte;
        crc = _crc_xmodem_update(crc, byte);
        tail = (uint8_t)(tail + 1) & (LINE_RING - 1);
    }
    if (left == most)
        return;
    line.tail = tail;
    in.length += most - left;
    in.crc = crc;
    in.previous = 0;
    in.is_open = true;
}

void frames_receive(void)
{
    if (!in.is_escaped)
        take_plain_content();
    for (uint8_t n = 0; n < 8; n++) {
        int16_t byte = line_next();
        if (byte < 0 || take_byte((uint8_t)byte))
            return;
    }
}

bool frames_may_begin(void)
{
    return !out.length;
}

uint8_t *frames_open(uint8_t kind)
{
    out.content[0] = kind;
    out.content[1] = out.sequence++;
    return out.content + 2;
}

void frames_close(uint8_t payload_length)
{
    out.length = (uint8_t)(2 + payload_length + 2);
    out.crc = CRC_START;
    out.at = 0;
    out.is_flagged = out.is_escaped = false;
}

void frames_send(void)
{
    if (!out.length || !line_may_send())
        return;
    if (!out.is_flagged) {
        out.is_flagged = true;
        UDR0 = FLAG;
        return;
    }
    if (out.at == out.length) {
        out.length = 0;
        UDR0 = FLAG;
        return;
    }
    if (out.at == out.length - 2) {
        /* Worked out byte by byte: all at once it would take as long as fifteen come in. */
        out.content[out.at] = (uint8_t)(out.crc >> 8);
        out.content[out.at + 1] = (uint8_t)out.crc;
    }
    uint8_t byte = out.content[out.at];
    if (out.is_escaped) {
        out.is_escaped = false;
        byte ^= ESCAPE_XOR;
    } else if ((byte & RESERVED_MASK) == RESERVED) {
        out.is_escaped = true;
        UDR0 = ESCAPE;
        return;
    }
    out.crc = _crc_xmodem_update(out.crc, out.content[out.at]);
    out.at++;
    UDR0 = byte;
}
