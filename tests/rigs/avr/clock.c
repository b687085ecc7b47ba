/* A clock on B0. After each rising edge PORTD shows what C0 reads. */
#include "common.h"

int main(void) {
    DDRB = 1;
    for (;;) {
        OUT(PORTB, 1);
        OUT(PORTD, PINC);
        __asm__ volatile("nop\n nop\n nop\n nop");
        OUT(PORTB, 0);
    }
}
