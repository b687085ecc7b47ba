/* Copies PINC to PORTD, every 2 cycles, then every 4 when it jumps back. */
#include "common.h"

int main(void) {
    DDRD = 0xFF;
    for (;;)
        __asm__ volatile(".rept 1000\n in r24, %0\n out %1, r24\n .endr" ::"I"(_SFR_IO_ADDR(PINC)),
                         "I"(_SFR_IO_ADDR(PORTD))
                         : "r24");
}
