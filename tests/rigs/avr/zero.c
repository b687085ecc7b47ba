/* CTC mode with OCR1A = 0: a match on every clock. PORTB: the interrupt came. */
#include "common.h"

ISR(TIMER1_COMPA_vect) {
    OUT(PORTB, 1);
    TIMSK1 = 0;
}

int main(void) {
    sei();
    OCR1A = 0;
    TIMSK1 = _BV(OCIE1A);
    TCCR1B = _BV(WGM12) | _BV(CS10);
    for (;;)
        ;
}
