/* Echoes at 250 kbaud. Each byte also goes to the plug, with a strobe, wired as an Uno is. 0xFF is
 * answered by what the status lines read. */
#include "common.h"

static void plug(uint8_t byte) {
    PORTD = (uint8_t)(byte << 2);
    PORTB = (uint8_t)(_BV(2) | byte >> 6);
    PORTB &= (uint8_t)~_BV(2);
    PORTB |= _BV(2);
}

int main(void) {
    PORTB = _BV(2);
    DDRB = 0x1F;
    DDRD = 0xFC;
    UBRR0 = 7;
    UCSR0A = _BV(U2X0);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
    for (;;) {
        while (!(UCSR0A & _BV(RXC0)))
            ;
        uint8_t byte = UDR0;
        while (!(UCSR0A & _BV(UDRE0)))
            ;
        UDR0 = byte == 0xFF ? PINC & 0x1F : byte;
        plug(byte);
    }
}
