/* Does not read until C0 goes high. Then PORTB shows UCSR0A and PORTD the byte, until none is
 * left. */
#include "common.h"

int main(void) {
    serial_at_1_mbaud();
    while (!(PINC & 1))
        ;
    uint8_t status;
    while ((status = UCSR0A) & _BV(RXC0)) {
        OUT(PORTB, status);
        OUT(PORTD, UDR0);
    }
    for (;;)
        ;
}
