/* The wire between the host and USART0, and the host's end of it.
 *
 * Rule 1: a frame is start bit, data bits, parity if set, stop bits: 10 bits for 8N1.
 * Rule 2: the host does not listen before it speaks. What arrives while RXEN is off is lost.
 * Rule 3: sender and receiver have a baud rate each. Where they differ, the receiver samples at the
 *         wrong places, and may find no stop bit.
 *
 *   ____ s 0 1 2 3 4 5 6 7 P ____ s 0 1 ...        gap between frames as fed
 *        |                 |
 *   uart_frame_starts   uart_frame_ends
 */
#include <string.h>

#include "simstate.h"

#define STOCK_FRAME_BITS 11 /* the stock model always adds a parity bit */

/* ---- rates ---- */

static int bit_cycles(const sim_t *sim) {
    const uint8_t *data = sim->avr->data;
    int divisor = (data[UBRR0L] | (data[UBRR0H] & 0x0F) << 8) + 1;
    return divisor * (data[UCSR0A] & UCSR0A_U2X ? 8 : 16);
}

static int frame_bits(const sim_t *sim) {
    if (!sim_repairs(sim, SIM_REPAIR_UART))
        return STOCK_FRAME_BITS;
    uint8_t control = sim->avr->data[UCSR0C];
    int parity_bits = control & 0x20 ? 1 : 0;
    int stop_bits = control & 0x08 ? 2 : 1;
    return 1 + 5 + (control >> 1 & 3) + parity_bits + stop_bits;
}

static double host_bit_cycles(const sim_t *sim) {
    return sim->uart.host_bit_cycles > 0 ? sim->uart.host_bit_cycles : bit_cycles(sim);
}

static uint64_t host_frame_cycles(const sim_t *sim) {
    return (uint64_t)(frame_bits(sim) * host_bit_cycles(sim) + 0.5);
}

double sim_bit_cycles(const sim_t *sim) { return bit_cycles(sim); }
void sim_host_bit_cycles(sim_t *sim, double cycles) { sim->uart.host_bit_cycles = cycles; }

/* What a receiver makes of a byte sent at another rate: it samples the middle of each of its own
 * bits. `stop` is the level where the stop bit should be. */
static uint8_t heard(uint8_t byte, double sender_bit_cycles, double receiver_bit_cycles,
                     int *stop) {
    double ratio = receiver_bit_cycles / sender_bit_cycles;
    unsigned line = 0xFFFFFE00u | (unsigned)byte << 1; /* bit 0: start; from bit 9 on: idle */
    unsigned result = 0;
    for (int i = 0; i <= 9; i++) {
        int at = (int)((i + 0.5) * ratio);
        unsigned level = at > 31 ? 1 : line >> at & 1;
        result |= level << i;
    }
    *stop = result >> 9 & 1;
    return (uint8_t)(result >> 1);
}

uint64_t wire_frame_cycles(const sim_t *sim) {
    return (uint64_t)(frame_bits(sim) * bit_cycles(sim));
}

/* ---- from the host ---- */

/* The wire: the end of one frame, and the start of the next. */
static avr_cycle_count_t wire(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    if (uart->on_wire >= 0) {
        uart_frame_ends(sim);
        if (!QUEUE_EMPTY(uart->fed) && uart->fed.items[uart->fed.head].gap_cycles)
            return uart->wire_due = when + uart->fed.items[uart->fed.head].gap_cycles;
    }
    if (QUEUE_EMPTY(uart->fed))
        return 0;
    fed_t next = uart->fed.items[uart->fed.head];
    if (next.earliest_cycle > when)
        return uart->wire_due = next.earliest_cycle;
    uart->fed.head++;
    int stop;
    uint8_t byte = heard(next.byte, host_bit_cycles(sim), bit_cycles(sim), &stop);
    uart_frame_starts(sim, byte, !stop);
    return uart->wire_due = when + host_frame_cycles(sim);
}

/* The stock receiver, fed through its own door. */
static avr_cycle_count_t stock_wire(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    if (QUEUE_EMPTY(uart->fed))
        return 0;
    fed_t next = uart->fed.items[uart->fed.head];
    if (next.earliest_cycle > when)
        return uart->wire_due = next.earliest_cycle;
    uart->fed.head++;
    sim->counters.rx_bytes++;
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT), next.byte);
    return uart->wire_due = when + host_frame_cycles(sim) + next.gap_cycles;
}

void wire_start(sim_t *sim) {
    avr_cycle_timer_t pump = sim_repairs(sim, SIM_REPAIR_UART) ? wire : stock_wire;
    if (!avr_cycle_timer_status(sim->avr, pump, NULL))
        sim_at(sim, sim->uart.wire_due, pump);
}

/* ---- to the host ---- */

void wire_sent(sim_t *sim, uint64_t cycle, uint8_t byte) {
    int stop;
    byte = heard(byte, bit_cycles(sim), host_bit_cycles(sim), &stop);
    sim_event_t event = {cycle, 'T', byte, {0}};
    QUEUE_PUSH(sim->uart.sent, event);
    sim->counters.tx_bytes++;
}

/* ---- the host's end ---- */

void sim_feed(sim_t *sim, const uint8_t *bytes, size_t count, uint64_t earliest_cycle,
              uint32_t gap_cycles) {
    for (size_t i = 0; i < count; i++) {
        fed_t fed = {earliest_cycle, gap_cycles, bytes[i]};
        QUEUE_PUSH(sim->uart.fed, fed);
    }
    if (count)
        wire_start(sim);
}

size_t sim_backlog(const sim_t *sim) {
    return QUEUE_COUNT(sim->uart.fed) + (sim->uart.on_wire >= 0);
}

void sim_drop_backlog(sim_t *sim) { sim->uart.fed.head = sim->uart.fed.tail = 0; }

size_t sim_take(sim_t *sim, sim_event_t *events, size_t room) {
    size_t count = QUEUE_COUNT(sim->uart.sent);
    if (count > room)
        count = room;
    if (count)
        memcpy(events, sim->uart.sent.items + sim->uart.sent.head, count * sizeof *events);
    sim->uart.sent.head += count;
    return count;
}
