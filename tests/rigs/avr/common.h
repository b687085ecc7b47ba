/* What the small firmwares share. Each shows one fact on its ports, in as few instructions as
 * it takes, so that the cycles can be counted by hand. */
#ifndef COMMON_H
#define COMMON_H

#include <avr/interrupt.h>
#include <avr/io.h>

/* One OUT instruction, 1 cycle, whatever the optimiser thinks. */
#define OUT(port, value)                                                                           \
    __asm__ volatile("out %0, %1" ::"I"(_SFR_IO_ADDR(port)), "r"((uint8_t)(value)))

/* An interrupt that does nothing but write PORTB: entry 4, jmp 3, out 1, reti 4 = 12 cycles. */
#define MARKING_ISR(vector)                                                                        \
    ISR(vector, ISR_NAKED) { __asm__ volatile("out %0, r1\n reti" ::"I"(_SFR_IO_ADDR(PORTB))); }

static inline void serial_at_1_mbaud(void) {
    UBRR0 = 1; /* 16 cycles a bit */
    UCSR0A = _BV(U2X0);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
}

#endif
