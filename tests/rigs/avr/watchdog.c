/* Shows on PORTB why it was reset, on PORTD what is left of a mark in memory, and hangs. */
#include "common.h"

#include <avr/wdt.h>

static uint8_t mark __attribute__((section(".noinit")));

int main(void) {
    uint8_t cause = MCUSR;
    MCUSR = 0;
    wdt_disable();
    DDRD = 0xFF;
    OUT(PORTB, cause);
    OUT(PORTD, mark);
    mark = 0x5A;
    wdt_enable(WDTO_15MS);
    OUT(PORTD, 1);
    for (;;)
        ;
}
