/* The serial line: bytes in by polling, one frame out at a time.
 *
 *   wire -> UART (2 bytes + shift register) -> line_poll() -> ring of 64 -> line_next()
 *
 * Rule 1: no receive interrupt: it would cost the steps up to 74 cycles of jitter. Whoever works
 *         for longer than two bytes take (1280 cycles at 250,000 baud) calls line_poll(), and the
 *         timer interrupt does.
 * Rule 2: line_poll() may run in the interrupt and in the main loop; there it locks.
 */
#ifndef LINE_H
#define LINE_H

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdbool.h>
#include <stdint.h>

#include "layout.h"

#ifndef BAUD
#define BAUD 250000UL
#endif

#define LINE_FRAMING 0x10 /* FE0: a byte without its stop bit */

struct line {
    uint8_t head, tail;
    uint8_t errors; /* damaged frames, framing errors and overruns */
    uint8_t bytes[LINE_RING];
};

extern struct line line;

void line_begin(void);

static inline bool line_has_byte(void)
{
    return UCSR0A & _BV(RXC0);
}

/* Take a byte from the UART if there is one; locks for 25 cycles at most. */
static inline void line_poll(void)
{
    if (!line_has_byte())
        return;
    uint8_t sreg = SREG, status;
    cli();
    status = UCSR0A; /* again: an interrupt may have taken it */
    if (status & _BV(RXC0)) {
        uint8_t head = line.head;
        line.bytes[head] = UDR0;
        line.head = (uint8_t)(head + 1) & (LINE_RING - 1);
    }
    SREG = sreg;
    if (status & (_BV(FE0) | _BV(DOR0)))
        line.errors++;
}

/* Bytes that came and were not looked at. */
static inline uint8_t line_waiting(void)
{
    return (uint8_t)(*(volatile uint8_t *)&line.head - line.tail) & (LINE_RING - 1);
}

/* The next byte that came, or -1. */
static inline int16_t line_next(void)
{
    line_poll();
    uint8_t tail = line.tail;
    if (!line_waiting())
        return -1;
    uint8_t byte = line.bytes[tail];
    line.tail = (uint8_t)(tail + 1) & (LINE_RING - 1);
    return byte;
}

static inline bool line_may_send(void)
{
    return UCSR0A & _BV(UDRE0);
}

#endif
