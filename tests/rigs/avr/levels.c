/* Serial by interrupts, which stay off until C0 goes high. Received bytes go to PORTD, one each
 * interrupt; 1 to 5 are sent. */
#include "common.h"

static uint8_t next = 1;

ISR(USART_RX_vect) { OUT(PORTD, UDR0); }

ISR(USART_UDRE_vect) {
    if (next > 5)
        UCSR0B &= (uint8_t)~_BV(UDRIE0);
    else
        UDR0 = next++;
}

int main(void) {
    serial_at_1_mbaud();
    UCSR0B |= _BV(RXCIE0) | _BV(UDRIE0);
    while (!(PINC & 1))
        ;
    sei();
    for (;;)
        ;
}
