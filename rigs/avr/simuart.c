/* USART0, as the data sheet has it (ATmega328P, chapter 20). The wire itself is in simwire.c.
 *
 * Rule 1: the receiver keeps two bytes, and a third in its shift register until the next start
 *         bit. Then the third is lost, DOR is set, and it is counted.
 * Rule 2: the transmitter has a shift register and one byte of buffer. UDRE says the buffer is
 *         free; TXC that both are empty.
 * Rule 3: RXC and UDRE interrupts are levels: they come again while their cause lasts.
 *
 *   wire     s 1 P  s 2 P  s 3 P  s 4 P           frames, nobody reads
 *   buffer        1      1,2    1,2
 *   held                        3   | 3 is lost here, at the start bit, not when 4 is complete
 */
#include "simstate.h"

enum { RXC = 0x80, TXC = 0x40, UDRE = 0x20, FE = 0x10, DOR = 0x08, UPE = 0x04, MPCM = 0x01 };
enum { RXCIE = 0x80, TXCIE = 0x40, UDRIE = 0x20, RXEN = 0x10, TXEN = 0x08 };

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

void uart_frame_starts(sim_t *sim, uint8_t byte, int framing_error) {
    uart_t *uart = &sim->uart;
    if (uart->held >= 0) {
        uart->held = -1;
        sim->counters.overruns++;
        sim->avr->data[UCSR0A] |= DOR;
    }
    uart->on_wire = byte;
    uart->framing_error = framing_error;
}

void uart_frame_ends(sim_t *sim) {
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

static avr_cycle_count_t shifted_out(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    wire_sent(sim, when, (uint8_t)uart->tx_shift);
    uart->tx_shift = uart->tx_buffer;
    uart->tx_buffer = -1;
    if (uart->tx_shift < 0) {
        avr_raise_interrupt(avr, &sim->uart_io->txc);
        return 0;
    }
    avr_raise_interrupt(avr, &sim->uart_io->udrc);
    return uart->tx_due = when + wire_frame_cycles(sim);
}

static void write_udr(avr_t *avr, avr_io_addr_t address, uint8_t byte, void *param) {
    (void)address, (void)param;
    sim_t *sim = sim_of(avr);
    uart_t *uart = &sim->uart;
    if (!(avr->data[UCSR0B] & TXEN))
        return;
    if (uart->tx_shift < 0) { /* moves on into the shift register at once: UDRE stays */
        uart->tx_shift = byte;
        uart->tx_due = sim_write_cycle(sim) + wire_frame_cycles(sim);
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
    uint8_t settable = UCSR0A_U2X | MPCM;
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
    if (sim_backlog(sim)) /* the host does not notice a reset */
        wire_start(sim);
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
    wire_sent(sim, sim->avr->cycle, (uint8_t)byte);
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
