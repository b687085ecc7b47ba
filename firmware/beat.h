/* What the timer interrupt does at a deadline, and the few instructions that must be exact.
 *
 * Rule 1: all of it is inlined into one interrupt; a call costs what a write costs.
 */
#ifndef BEAT_H
#define BEAT_H

#include "board.h"
#include "card.h"
#include "state.h"

/* A bit that no status line has. */
#define RESTLESS 0x80

#define HERE static inline __attribute__((always_inline))

/* The port bytes of the next beat, in the order in which they are written. */
struct beat {
    uint8_t count;
    uint8_t low[MOTORS_MAX], high[MOTORS_MAX];
    uint8_t motor[MOTORS_MAX]; /* a bit each */
    uint8_t pins[MOTORS_MAX];  /* what was read after each */
    bool control_due;          /* outputs change first */
    uint8_t control_high, control_extra;
    /* Readings that need no look: ((pins ^ quiet) | restless) & mind == 0. */
    uint8_t quiet, restless, mind;
};

extern struct beat beat;

/* Wait until the timer shows `due`, to the cycle; how late it is already otherwise.
 *
 * From the reading of the counter to the end 12 cycles pass at least. The loop takes off 3 at a
 * time; the two comparisons behind it take off the rest, 0 to 2, as one cycle each.
 */
HERE uint16_t wait_for(uint16_t due)
{
    uint16_t left = due;
    __asm__ __volatile__(
        "lds  __tmp_reg__, %[low]   \n\t"
        "sub  %A[left], __tmp_reg__ \n\t"
        "lds  __tmp_reg__, %[high]  \n\t"
        "sbc  %B[left], __tmp_reg__ \n\t"
        "brmi 2f                    \n\t"
        "subi %A[left], 13          \n\t"
        "brcs 3f                    \n\t"
        "1: subi %A[left], 3        \n\t"
        "brcc 1b                    \n\t"
        "cpi  %A[left], 0xFE        \n\t"
        "brsh .+0                   \n\t"
        "cpi  %A[left], 0xFF        \n\t"
        "brsh .+0                   \n\t"
        "3: ldi %A[left], 0         \n\t"
        "ldi  %B[left], 0           \n\t"
        "2:                         \n\t"
        : [left] "+d"(left)
        : [low] "n"(_SFR_MEM_ADDR(TCNT1L)), [high] "n"(_SFR_MEM_ADDR(TCNT1H)));
    return (uint16_t)-left;
}

/* A minor axis in one beat: true when it steps. */
HERE bool minor_steps(struct minor *minor, uint32_t limit)
{
    uint32_t sum;
    uint8_t step;
    __asm__(
        "ld   %A[sum], %a[at]       \n\t"
        "ldd  %B[sum], %a[at]+1     \n\t"
        "ldd  %C[sum], %a[at]+2     \n\t"
        "ldd  %D[sum], %a[at]+3     \n\t"
        "ldd  __tmp_reg__, %a[at]+4 \n\t"
        "add  %A[sum], __tmp_reg__  \n\t"
        "ldd  __tmp_reg__, %a[at]+5 \n\t"
        "adc  %B[sum], __tmp_reg__  \n\t"
        "ldd  __tmp_reg__, %a[at]+6 \n\t"
        "adc  %C[sum], __tmp_reg__  \n\t"
        "ldd  __tmp_reg__, %a[at]+7 \n\t"
        "adc  %D[sum], __tmp_reg__  \n\t"
        "sbc  %[step], %[step]      \n\t"
        : [sum] "=&r"(sum), [step] "=&r"(step)
        : [at] "b"(minor), "m"(*minor));
    if (step)
        sum -= limit;
    minor->sum = sum;
    return step;
}

/* One motor of a phase card moves on in its table: its port bytes into the beat. */
HERE void add_movement(uint8_t motor, uint8_t forward, uint8_t *count, uint8_t high)
{
    uint8_t at = card.phase[motor];
    uint8_t bit = (uint8_t)_BV(motor);
    if (forward & bit) {
        if (++at == card.facts.table_length)
            at = 0;
    } else {
        if (!at)
            at = card.facts.table_length;
        at--;
    }
    card.phase[motor] = at;
    uint8_t n = *count;
    beat.low[n] = card.table[0][at] | card.motor_low[motor];
    beat.high[n] = card.motor_high[motor] | high;
    beat.motor[n] = bit;
    *count = n + 1;
}

#endif
