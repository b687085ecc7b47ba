/* Puts DEPTH bytes on the stack, and 100 in the data. */
#include "common.h"

volatile uint8_t data[100];

static __attribute__((noinline)) uint8_t deep(void) {
    volatile uint8_t bytes[DEPTH];
    for (uint16_t i = 0; i < DEPTH; i++)
        bytes[i] = (uint8_t)i;
    return bytes[data[0]];
}

int main(void) {
    data[0] = 3;
    OUT(PORTB, deep());
    for (;;)
        ;
}
