/* Four data bytes with a strobe each, and a pulse on pin 17, wired as an Uno is. */
#include "common.h"

enum { STROBE = _BV(2), IDLE = STROBE };

static void put(uint8_t byte) {
    uint8_t high = (uint8_t)(IDLE | byte >> 6);
    uint8_t low = (uint8_t)(byte << 2);
    __asm__ volatile("out %0, %1\n nop\n out %2, %3" ::"I"(_SFR_IO_ADDR(PORTD)), "r"(low),
                     "I"(_SFR_IO_ADDR(PORTB)), "r"(high));
    PORTB &= (uint8_t)~STROBE;
    PORTB |= STROBE;
}

int main(void) {
    PORTB = IDLE; /* before the direction: nStrobe must not twitch */
    DDRB = 0x1F;
    DDRD = 0xFC;
    DDRC = _BV(5);
    put(0x49);
    put(0x49);
    put(0xC3);
    put(0xC4);
    PORTC |= _BV(5);
    PORTC &= (uint8_t)~_BV(5);
    for (;;)
        ;
}
