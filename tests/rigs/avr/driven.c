/* C0 is an input with a pull-up, and driven low from outside. C5 is an output of the same port. */
#include "common.h"

int main(void) {
    DDRC = _BV(5);
    PORTC = 0x1F;
    while (PINC & 1)
        ;
    PORTC = 0x3F;
    OUT(PORTD, PINC);
    for (;;)
        ;
}
