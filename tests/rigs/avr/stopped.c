/* A count written to a stopped timer. PORTB: the count soon after the start. PORTD: the count
 * after it was stopped again, twice. */
#include "common.h"

int main(void) {
    TCNT0 = 200;
    TCCR0B = _BV(CS00);
    OUT(PORTB, TCNT0);
    TCCR0B = 0;
    OUT(PORTD, TCNT0);
    OUT(PORTD, TCNT0);
    for (;;)
        ;
}
