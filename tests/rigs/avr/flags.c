/* Two flags are set and one is cleared. PORTD: what is left. Then one pin is toggled through
 * PINB. */
#include "common.h"

int main(void) {
    OCR1A = 10;
    OCR1B = 20;
    TCCR1B = _BV(CS10);
    while (!(TIFR1 & _BV(OCF1B)))
        ;
    TIFR1 = _BV(OCF1A);
    OUT(PORTD, TIFR1);
    DDRB = 0x03;
    OUT(PORTB, 0x01);
    __asm__ volatile("sbi %0, 1" ::"I"(_SFR_IO_ADDR(PINB)));
    for (;;)
        ;
}
