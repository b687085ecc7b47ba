/* Timer 1 every 500 cycles; the core does 6000 NOPs, or sleeps. PORTD: 1 cycle after the
 * timer started. */
#include "common.h"

#include <avr/sleep.h>

MARKING_ISR(TIMER1_COMPA_vect)

int main(void) {
    OCR1A = 499;
    TIMSK1 = _BV(OCIE1A);
    sei();
    sleep_enable();
    __asm__ volatile("sts %0, %1\n out %2, r1" ::"n"(_SFR_MEM_ADDR(TCCR1B)),
                     "r"((uint8_t)(_BV(WGM12) | _BV(CS10))), "I"(_SFR_IO_ADDR(PORTD)));
#ifdef ASLEEP
    for (;;)
        sleep_cpu();
#else
    __asm__ volatile(".rept 6000\n nop\n .endr"); /* no jitter: all instructions take 1 cycle */
    for (;;)
        ;
#endif
}
