/* An interrupt is pending when SEI comes. PORTD is written after it, PORTB by the interrupt. */
#include "common.h"

MARKING_ISR(TIMER1_COMPA_vect)

int main(void) {
    TIMSK1 = _BV(OCIE1A);
    OCR1A = 10;
    TCCR1B = _BV(CS10);
    while (!(TIFR1 & _BV(OCF1A)))
        ;
    __asm__ volatile("sei\n"
                     "out %0, r1\n"
                     "out %0, r1\n"
                     "out %0, r1\n" ::"I"(_SFR_IO_ADDR(PORTD)));
    for (;;)
        ;
}
