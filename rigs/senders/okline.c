/* As fast as anything behind a serial line of 115200 baud can be: each line is answered with "ok" at once, and nothing is
 * done about it. No grbl is faster. */
#include <avr/interrupt.h>
#include <avr/io.h>

static volatile uint8_t answers;

ISR(USART_RX_vect)
{
    if (UDR0 == '\n')
        answers++;
}

static void put(char byte)
{
    while (!(UCSR0A & _BV(UDRE0)))
        ;
    UDR0 = byte;
}

int main(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = 16;
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
    sei();
    for (;;) {
        if (!answers)
            continue;
        cli();
        answers--;
        sei();
        put('o');
        put('k');
        put('\r');
        put('\n');
    }
}
