/* Arduino Mega 2560: ATmega2560 at 16 MHz.
 *
 *   PORTA (pins 22 to 29)   D0 .. D7
 *   PORTC (pins 37 to 30)   bit 0: pin 1, bit 1: pin 14, bit 2: pin 16, bit 3: pin 17
 *   PORTF (A0 to A4)        pins 11, 10, 12, 13, 15
 *   PB4   (pin 10)          pulses of a laser's power
 *
 * The rules are those of the Uno; here a data byte is one port, and all control lines another.
 */
#ifndef BOARD_MEGA_H
#define BOARD_MEGA_H

#include <avr/io.h>
#ifndef __ASSEMBLER__
#include <stdbool.h>
#include <stdint.h>
#endif

#define BOARD_NAME "mega"
#define BOARD_RING 6144

#define PORT_LOW PORTA
#define PORT_HIGH PORTC
#define PORT_EXTRA PORTC
#define DATA_LOW(data) ((uint8_t)(data))
#define DATA_HIGH(data) ((uint8_t)((data) & 0))
#define DATA_HIGH_MASK 0x00

#define CONTROL_INVERTED 0x0B
#define CONTROL_HIGH(control) ((uint8_t)(((control) ^ CONTROL_INVERTED) & 0x0F))
#define CONTROL_EXTRA(control) CONTROL_HIGH(control)
#define STROBE_BIT 0

#define PIN_STATUS PINF
#define STATUS_PINS 0x1F
#define EXTRA_REST 0x00

#ifndef __ASSEMBLER__
static inline void board_directions(void)
{
    DDRA = 0xFF;
    DDRC = 0x0F;
    PORTF = STATUS_PINS; /* pull-ups */
}

/* OC2A is PB4, pin 10 of the board: a pin of its own. */
static inline void board_power(bool is_high)
{
    if (is_high)
        PORTB &= (uint8_t)~_BV(PB4);
    else
        PORTB |= _BV(PB4);
    DDRB |= _BV(PB4);
}
#endif

#endif
