/* The power of a lamp (a laser): pulses of timer 2 on one pin, in shares of 1/256 of its full power.
 *
 *   block ------ share ------------------------> compare register        M3: constant
 *   block ------ energy / interval as played --> compare register        M4: with the speed
 *
 * Rule 1: dark means that the timer is taken off the pin, whose latch rests at the level that is off. So
 *         whatever stops the timer, resets the chip or forgets to write leaves it dark.
 * Rule 2: the main loop follows the block and the interval of the tick in hand. With a phase card the
 *         interrupt sets it where a block is taken in hand; with clock lines there is no time for it.
 *         With either it darkens it where the motors come to rest.
 * Rule 3: the main loop writes what it has worked out only while the block is still in hand and time
 *         runs: both are looked at with interrupts off.
 * Rule 4: where no host has asked for it, neither timer nor pin is touched.
 */
#ifndef POWER_H
#define POWER_H

#include "state.h"

struct power {
    uint8_t connected; /* TCCR2A while the pin is the timer's; 0: nobody has asked for pulses */
};

extern struct power power;

/* A card knows of no lamp. At standstill. */
static inline void power_forget(void)
{
    power.connected = 0;
    TCCR2A = 0;
}

/* Pulses as the host wants them: POWER_RATE, POWER_HIGH. At standstill. */
void power_take(uint8_t how);
/* The share with which a block of some energy begins; main loop. */
void power_prepare(struct block *block);
/* A block is taken in hand that says another power than the one before. */
void power_enter(const struct block *block);
/* The motors come to rest. */
void power_rest(void);
/* Main loop. */
void power_service(void);

#endif
