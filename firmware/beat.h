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

/* Two port bytes with nothing in between: both are worked out before the first is written. */
HERE void write_pair(volatile uint8_t *one, uint8_t a, volatile uint8_t *other, uint8_t b)
{
    __asm__ __volatile__("" : "+r"(a), "+r"(b));
    *one = a;
    *other = b;
}

struct entry {
    uint8_t low, high; /* port bytes */
};

/* The port bytes of the next beat, in the order in which they are written. Read by beats.S. */
struct beat {
    struct entry entry[MOTORS_MAX];
    uint8_t end;  /* low byte of the address behind the last one */
    uint8_t mask; /* all their motors; clock lines: their bits of the data byte */
    /* Readings that need no look: ((pins ^ quiet) | restless) & mind == 0. */
    uint8_t quiet, restless, mind;
    uint8_t pins[MOTORS_MAX]; /* what was read after each */
    struct entry rest; /* clock lines at rest */

    bool control_due; /* outputs change first */
    uint8_t control_high, control_extra;
};

extern struct beat beat;

static inline uint8_t beat_count(void)
{
    return (uint8_t)(beat.end - (uint8_t)(uintptr_t)beat.entry) / sizeof(struct entry);
}

/* Wait until the timer shows `due`, to the cycle, then write two port bytes at once.
 *
 * What is waited for is a little later than `due`, by as much as the shortest way from the reading
 * of the counter to the writes takes: so being just in time needs no way of its own. The loop takes
 * off 3 cycles at a time; the two comparisons behind it the rest, 0 to 2, as one cycle each. Who is
 * late takes the same way as who is just in time, so that it is known to the cycle how late.
 */
#define WAIT_OUT                     \
    "lds  __tmp_reg__, %[count_low]  \n\t" \
    "sub  %A[left], __tmp_reg__      \n\t" \
    "lds  __tmp_reg__, %[count_high] \n\t" \
    "sbc  %B[left], __tmp_reg__      \n\t" \
    "subi %A[left], 0xF0             \n\t" \
    "sbci %B[left], 0xFF             \n\t" \
    "movw %A[spare], %A[left]        \n\t" \
    "brpl 1f                         \n\t" \
    "ldi  %A[left], 0                \n\t" \
    "1: subi %A[left], 3             \n\t" \
    "brcc 1b                         \n\t" \
    "cpi  %A[left], 0xFE             \n\t" \
    "brsh .+0                        \n\t" \
    "cpi  %A[left], 0xFF             \n\t" \
    "brsh .+0                        \n\t"
#define COUNTER [count_low] "n"(_SFR_MEM_ADDR(TCNT1L)), [count_high] "n"(_SFR_MEM_ADDR(TCNT1H))

HERE uint16_t lateness(int16_t spare)
{
    return spare < 0 ? (uint16_t)-spare : 0;
}

/* How late it is; 0: it was waited for. */
HERE uint16_t wait_for(uint16_t due)
{
    int16_t spare;
    __asm__ __volatile__(WAIT_OUT : [left] "+d"(due), [spare] "=&r"(spare) : COUNTER);
    return lateness(spare);
}

/* The same, and the writes. */
#define DEFINE_WRITE_AT(name, one, other)                                                   \
    HERE uint16_t name(uint16_t due, uint8_t a, uint8_t b)                                  \
    {                                                                                       \
        int16_t spare;                                                                      \
        __asm__ __volatile__(WAIT_OUT "out %[one_], %[a_] \n\t out %[other_], %[b_]"        \
                             : [left] "+d"(due), [spare] "=&r"(spare)                       \
                             : COUNTER, [one_] "I"(_SFR_IO_ADDR(one)),                      \
                               [other_] "I"(_SFR_IO_ADDR(other)), [a_] "r"(a), [b_] "r"(b)); \
        return lateness(spare);                                                             \
    }

DEFINE_WRITE_AT(write_data_at, PORT_LOW, PORT_HIGH)
DEFINE_WRITE_AT(write_control_at, PORT_HIGH, PORT_EXTRA)

#endif
