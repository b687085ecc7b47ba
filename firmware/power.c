/* Rules: power.h. */
#include "power.h"

#include <avr/interrupt.h>

#include "arith.h"
#include "board.h"
#include "player.h"

/* From 0 to 255 and back to 0 at once; the pin is left to its latch. */
#define APART (_BV(WGM21) | _BV(WGM20))
/* Set at 0, cleared at the match; or the other way round. */
#define HIGH_FIRST (APART | _BV(COM2A1))
#define LOW_FIRST (HIGH_FIRST | _BV(COM2A0))

struct power power;

void power_take(uint8_t how)
{
    bool is_high = how & POWER_HIGH;
    board_power(is_high);
    TCCR2A = APART;
    TCCR2B = how & POWER_RATE;
    power.connected = how & POWER_RATE ? is_high ? HIGH_FIRST : LOW_FIRST : 0;
}

/* In the interrupt, or with interrupts off. */
static inline __attribute__((always_inline)) void set(uint8_t share)
{
    if (!share) {
        TCCR2A = APART;
        return;
    }
    OCR2A = share;
    if (TCCR2A != APART)
        return;
    TCNT2 = 0xFF; /* what the pin was last is not shown: a period begins with the next count */
    TCCR2A = power.connected;
}

static __attribute__((noinline)) uint8_t share_at(energy_t energy, const uint32_t *at)
{
    __uint24 cycles = *(const __uint24 *)at;
    if (((const uint8_t *)at)[3])
        return 0; /* a tick of a second */
    return energy < cycles ? (uint8_t)(fraction_q16(energy, cycles) >> 8) : POWER_FULL;
}

void power_prepare(struct block *block)
{
    if (block->outputs_due & DUE_POWER && block->energy)
        block->share = share_at(block->energy, &block->entry_cycles);
}

void power_enter(const struct block *block)
{
    if (power.connected && block->outputs_due & DUE_POWER)
        set(block->share);
}

void power_rest(void)
{
    if (power.connected)
        TCCR2A = APART;
}

/* The second lock is as long as one may be: nothing is worked out in it. */
void power_service(void)
{
    if (!power.connected)
        return;
    uint8_t share = 0, taken = *(volatile uint8_t *)&player.taken;
    cli();
    const struct block *block = player.block;
    uint32_t cycles = player.cycles;
    sei();
    if (block && player.halt == PLAYING) /* who stands has halted, or has no block */
        share = block->energy ? share_at(block->energy, &cycles) : block->share;
    cli();
    if (!share || (*(volatile uint8_t *)&player.taken == taken && player.halt == PLAYING))
        set(share);
    sei();
}
