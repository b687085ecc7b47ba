/* Normal mode with OCR1A = 0 and a loop of 9 cycles with a RET in it: 65,536 is no multiple of 9, so
 * the match comes in another cycle of the loop at each turn. PORTB: the interrupt came. */
#include "common.h"

MARKING_ISR(TIMER1_COMPA_vect)

static void __attribute__((noinline)) nothing(void) {
    __asm__ volatile("");
}

int main(void) {
    OCR1A = 0;
    TIMSK1 = _BV(OCIE1A);
    TCCR1B = _BV(CS10);
    sei();
    for (;;)
        nothing();
}
