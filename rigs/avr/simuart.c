/* USART0, as the data sheet has it (ATmega328P, chapter 20), and the host at the other end.
 *
 * Rule 1: a frame is start bit, data bits, parity if set, stop bits: 10 bits for 8N1.
 * Rule 2: the receiver keeps two bytes, and a third in its shift register until the next start
 *         bit. Then the third is lost, DOR is set, and it is counted.
 * Rule 3: the transmitter has a shift register and one byte of buffer. UDRE says the buffer is
 *         free; TXC that both are empty.
 * Rule 4: RXC and UDRE interrupts are levels: they come again while their cause lasts.
 * Rule 5: the host does not listen before it speaks: what arrives while RXEN is off is lost.
 *
 *   wire    ____ s 0 1 2 3 4 5 6 7 P ____ s 0 1 ...        10 bits each, gap between them as fed
 *                |                 |      |
 *           on_wire = byte     received   next start bit: a held third byte is lost here
 */
#include <string.h>

#include "simstate.h"

#define UCSR0A 0xC0
#define UCSR0B 0xC1
#define UCSR0C 0xC2
#define UBRR0L 0xC4
#define UBRR0H 0xC5
#define UDR0 0xC6
enum { RXC = 0x80, TXC = 0x40, UDRE = 0x20, FE = 0x10, DOR = 0x08, UPE = 0x04, U2X = 0x02 };
enum { MPCM = 0x01 };
enum { RXCIE = 0x80, TXCIE = 0x40, UDRIE = 0x20, RXEN = 0x10, TXEN = 0x08 };
#define STOCK_FRAME_BITS 11 /* the stock model always adds a parity bit */

static int bit_cycles(const sim_t *sim) {
    const uint8_t *data = sim->avr->data;
    int divisor = (data[UBRR0L] | (data[UBRR0H] & 0x0F) << 8) + 1;
    return divisor * (data[UCSR0A] & U2X ? 8 : 16);
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
static uint8_t heard(uint8_t byte, double sender_bit_cycles, double receiver_bit_cycles, int *stop) {
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

/* ---- receiver ---- */

static void offer_received(sim_t *sim) {
    if (sim->uart.buffered)
        avr_raise_interrupt(sim->avr, &sim->uart_io->rxc);
}

static void keep(sim_t *sim, uint8_t byte) {
    uart_t *uart = &sim->uart;
    if (uart->buffered < 2)
        uart->buffer[uart->buffered++] = byte;
    else
        uart->held = byte;
    offer_received(sim);
}

static void frame_starts(sim_t *sim, uint8_t byte) {
    uart_t *uart = &sim->uart;
    int stop;
    if (uart->held >= 0) {
        uart->held = -1;
        sim->counters.overruns++;
        sim->avr->data[UCSR0A] |= DOR;
    }
    uart->on_wire = heard(byte, host_bit_cycles(sim), bit_cycles(sim), &stop);
    uart->framing_error = !stop;
}

static void frame_ends(sim_t *sim) {
    uart_t *uart = &sim->uart;
    uint8_t byte = (uint8_t)uart->on_wire;
    uart->on_wire = -1;
    sim->counters.rx_bytes++;
    if (!(sim->avr->data[UCSR0B] & RXEN)) {
        sim->counters.unheard++;
        return;
    }
    if (uart->framing_error) {
        sim->counters.framing_errors++;
        sim->avr->data[UCSR0A] |= FE;
    }
    keep(sim, byte);
}

/* The wire: the end of one frame, and the start of the next. */
static avr_cycle_count_t wire(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    if (uart->on_wire >= 0) {
        frame_ends(sim);
        if (!QUEUE_EMPTY(uart->fed) && uart->fed.items[uart->fed.head].gap_cycles)
            return uart->wire_due = when + uart->fed.items[uart->fed.head].gap_cycles;
    }
    if (QUEUE_EMPTY(uart->fed))
        return 0;
    fed_t next = uart->fed.items[uart->fed.head];
    if (next.earliest_cycle > when)
        return uart->wire_due = next.earliest_cycle;
    uart->fed.head++;
    frame_starts(sim, next.byte);
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

static void start_wire(sim_t *sim) {
    avr_cycle_timer_t pump = sim_repairs(sim, SIM_REPAIR_UART) ? wire : stock_wire;
    if (!avr_cycle_timer_status(sim->avr, pump, NULL))
        sim_at(sim, sim->uart.wire_due, pump);
}

static uint8_t read_udr(avr_t *avr, avr_io_addr_t address, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    uint8_t byte = uart->buffer[0]; /* an empty buffer reads its last byte again */
    if (uart->buffered)
        uart->buffered--;
    if (uart->buffered)
        uart->buffer[0] = uart->buffer[1];
    if (uart->held >= 0) {
        uart->buffer[uart->buffered++] = (uint8_t)uart->held;
        uart->held = -1;
    }
    avr_clear_interrupt(avr, &sim->uart_io->rxc);
    avr->data[UCSR0A] &= (uint8_t)~(RXC | FE | DOR | UPE);
    offer_received(sim);
    return avr->data[address] = byte;
}

static void flush_receiver(sim_t *sim) {
    sim->uart.buffered = 0;
    sim->uart.held = -1;
    avr_clear_interrupt(sim->avr, &sim->uart_io->rxc);
    sim->avr->data[UCSR0A] &= (uint8_t)~(RXC | FE | DOR | UPE);
}

/* ---- transmitter ---- */

static void sent(sim_t *sim, uint64_t cycle, uint8_t byte) {
    int stop;
    byte = heard(byte, bit_cycles(sim), host_bit_cycles(sim), &stop);
    sim_event_t event = {cycle, 'T', byte, {0}};
    QUEUE_PUSH(sim->uart.sent, event);
    sim->counters.tx_bytes++;
}

static avr_cycle_count_t shifted_out(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    sent(sim, when, (uint8_t)uart->tx_shift);
    uart->tx_shift = uart->tx_buffer;
    uart->tx_buffer = -1;
    if (uart->tx_shift < 0) {
        avr_raise_interrupt(avr, &sim->uart_io->txc);
        return 0;
    }
    avr_raise_interrupt(avr, &sim->uart_io->udrc);
    return uart->tx_due = when + (uint64_t)(frame_bits(sim) * bit_cycles(sim));
}

static void write_udr(avr_t *avr, avr_io_addr_t address, uint8_t byte, void *param) {
    (void)address, (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    if (!(avr->data[UCSR0B] & TXEN))
        return;
    if (uart->tx_shift < 0) { /* moves on into the shift register at once: UDRE stays */
        uart->tx_shift = byte;
        uart->tx_due = sim_write_cycle(sim) + (uint64_t)(frame_bits(sim) * bit_cycles(sim));
        sim_at(sim, uart->tx_due, shifted_out);
    } else if (uart->tx_buffer < 0) {
        uart->tx_buffer = byte;
        avr_clear_interrupt(avr, &sim->uart_io->udrc);
        avr->data[UCSR0A] &= (uint8_t)~UDRE;
    } else {
        sim->counters.tx_dropped++;
    }
}

/* ---- control registers ---- */

static void write_ucsra(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uint8_t settable = U2X | MPCM;
    avr->data[address] = (uint8_t)((avr->data[address] & ~settable) | (value & settable));
    if (value & TXC) {
        avr_clear_interrupt(avr, &sim->uart_io->txc);
        avr->data[address] &= (uint8_t)~TXC;
    }
}

static void fire_if(sim_t *sim, avr_int_vector_t *vector, uint8_t enable, uint8_t flag) {
    const uint8_t *data = sim->avr->data;
    if (data[UCSR0B] & enable && data[UCSR0A] & flag && !vector->pending)
        avr_raise_interrupt(sim->avr, vector);
}

static void write_ucsrb(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uint8_t old = avr->data[address];
    avr->data[address] = value;
    if (old & RXEN && !(value & RXEN))
        flush_receiver(sim);
    fire_if(sim, &sim->uart_io->rxc, RXCIE, RXC);
    fire_if(sim, &sim->uart_io->txc, TXCIE & ~old, TXC);
    fire_if(sim, &sim->uart_io->udrc, UDRIE, UDRE);
}

void uart_after_interrupt(sim_t *sim) {
    if (!sim_repairs(sim, SIM_REPAIR_UART))
        return;
    fire_if(sim, &sim->uart_io->rxc, RXCIE, RXC);
    fire_if(sim, &sim->uart_io->udrc, UDRIE, UDRE);
}

/* ---- reset and open ---- */

void uart_reset(sim_t *sim) {
    uart_t *uart = &sim->uart;
    uart->buffered = 0;
    uart->held = uart->tx_shift = uart->tx_buffer = -1;
    if (uart->on_wire >= 0 || !QUEUE_EMPTY(uart->fed)) /* the host does not notice a reset */
        start_wire(sim);
}

void uart_after_reset(sim_t *sim) {
    if (!sim_repairs(sim, SIM_REPAIR_UART))
        return;
    sim->avr->data[UCSR0B] = 0; /* stock: the transmitter is on */
    sim->avr->data[UCSR0A] = UDRE;
    sim->avr->data[UCSR0C] = 0x06; /* 8N1 */
}

static void stock_sent(avr_irq_t *irq, uint32_t byte, void *param) {
    (void)irq;
    sim_t *sim = param;
    sent(sim, sim->avr->cycle, (uint8_t)byte);
}

static void take_register(avr_t *avr, avr_io_addr_t address, avr_io_read_t read,
                          avr_io_write_t write) {
    avr_io_addr_t io = AVR_DATA_TO_IO(address);
    avr->io[io].r.c = read;
    avr->io[io].r.param = NULL;
    avr->io[io].w.c = write;
    avr->io[io].w.param = NULL;
}

void uart_open(sim_t *sim) {
    avr_t *avr = sim->avr;
    uint32_t no_flags = 0; /* no echo to stdout, no sleep while polled */
    avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &no_flags);
    sim->uart.on_wire = -1;
    if (!sim_repairs(sim, SIM_REPAIR_UART)) {
        avr_irq_register_notify(
            avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), stock_sent, sim);
        return;
    }
    take_register(avr, UDR0, read_udr, write_udr);
    take_register(avr, UCSR0A, NULL, write_ucsra);
    take_register(avr, UCSR0B, NULL, write_ucsrb);
    take_register(avr, UBRR0L, NULL, NULL);
}

/* ---- the host's end ---- */

void sim_feed(sim_t *sim, const uint8_t *bytes, size_t count, uint64_t earliest_cycle,
              uint32_t gap_cycles) {
    for (size_t i = 0; i < count; i++) {
        fed_t fed = {earliest_cycle, gap_cycles, bytes[i]};
        QUEUE_PUSH(sim->uart.fed, fed);
    }
    if (count)
        start_wire(sim);
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
