/* The compare flag is set long before its interrupt is enabled. PORTB: the interrupt came. */
#include "common.h"

MARKING_ISR(TIMER1_COMPA_vect)

int main(void) {
    sei();
    OCR1A = 10;
    TCCR1B = _BV(CS10);
    while (!(TIFR1 & _BV(OCF1A)))
        ;
    TIMSK1 = _BV(OCIE1A);
    for (;;)
        ;
}
