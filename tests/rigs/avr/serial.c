/* Sends 1 2 3 as fast as it may, writing PORTB at each; then shows what it hears on PORTD. */
#include "common.h"

int main(void) {
    serial_at_1_mbaud();
    for (uint8_t byte = 1; byte <= 3; byte++) {
        while (!(UCSR0A & _BV(UDRE0)))
            ;
        UDR0 = byte;
        OUT(PORTB, byte);
    }
    for (;;)
        if (UCSR0A & _BV(RXC0))
            OUT(PORTD, UDR0);
}
