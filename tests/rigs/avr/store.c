/* OUT moves the pins after 1 cycle, SBI after 2. */
#include "common.h"

int main(void) {
    OUT(PORTB, 0);
    __asm__ volatile("sbi %0, 0" ::"I"(_SFR_IO_ADDR(PORTB)));
    for (;;)
        ;
}
