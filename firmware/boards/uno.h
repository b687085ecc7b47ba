/* Arduino Uno and Nano: ATmega328P at 16 MHz.
 *
 *            PORTD                    PORTB                        PORTC
 *   7  6  5  4  3  2  1  0     5   4  3  2  1  0         5  4  3  2  1  0
 *   D5 D4 D3 D2 D1 D0 TX RX    LED 16 14 1  D7 D6        17 15 13 12 10 11     (numbers: DB25 pins)
 *   `---- data ----'               `-----' control       `' control
 *                                           `----' data     `------------' status
 *
 * Rule 1: no 8-bit port is free, so a data byte is two writes one cycle apart, low part first. The
 *         strobe comes after both.
 * Rule 2: the control lines are spoken of as the control register counts them: pins 1, 14 and 17
 *         are inverted between register and pin, 16 is not.
 * Rule 3: the status lines sit in one port, so that a reading is one instruction. The register's
 *         bit 7 is the inverse of pin 11.
 * Rule 4: PB5 stays an input without pull-up: the boot loader blinks its LED.
 */
#ifndef BOARD_UNO_H
#define BOARD_UNO_H

#include <avr/io.h>
#ifndef __ASSEMBLER__
#include <stdbool.h>
#include <stdint.h>
#endif

#define BOARD_NAME "uno"
#define BOARD_RING 840

/* Data byte to port bytes. PD0 is RX with pull-up, PD1 is TX. */
#define PORT_LOW PORTD
#define PORT_HIGH PORTB
#define PORT_EXTRA PORTC
#define DATA_LOW(data) ((uint8_t)((uint8_t)((data) << 2) | 0x01))
#define DATA_HIGH(data) ((uint8_t)((data) >> 6))
#define DATA_HIGH_MASK 0x03

/* Control register to port bytes: bit 0 (pin 1), 1 (pin 14), 2 (pin 16) on PB2 to PB4, 3 on PC5. */
#define CONTROL_INVERTED 0x0B
#define CONTROL_HIGH(control) ((uint8_t)((((control) ^ CONTROL_INVERTED) & 0x07) << 2))
#define CONTROL_EXTRA(control) ((uint8_t)((((control) ^ CONTROL_INVERTED) & 0x08) << 2))
#define STROBE_BIT 2

/* Status lines as they are in PINC: bit 0 is pin 11, then 10, 12, 13, 15. */
#define PIN_STATUS PINC
#define STATUS_PINS 0x1F
#define EXTRA_REST 0x1F /* pull-ups of the status lines */

#ifndef __ASSEMBLER__
static inline void board_directions(void)
{
    DDRB |= 0x1F;
    DDRC = 0x20;
    DDRD = 0xFE;
}

/* OC2A is PB3, pin 14 of the plug: an output already, and its latch is off with the card at rest. */
static inline void board_power(bool is_high)
{
    (void)is_high;
}
#endif

#endif
