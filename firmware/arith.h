/* Divisions and products of the throttle, exactly as the Python core works them out.
 *
 * Rule 1: results that do not fit are the largest that does; the core's would be beyond any use.
 * Rule 2: short where it matters: the higher the rate, the fewer bits a quotient has.
 */
#ifndef ARITH_H
#define ARITH_H

#include <stdint.h>

/* RATE_CYCLES / divisor, rounded down: rate to interval and back; divisor not 0. */
uint32_t rate_over(uint32_t divisor);

/* a * b >> 16 (product.S). */
uint32_t product_q16(uint32_t a, uint32_t b);

/* (a << 16) / b; both below 2^24, b not 0. */
uint32_t ratio_q16(uint32_t a, uint32_t b);

/* The same where a is less than b (product.S). */
uint16_t fraction_q16(uint32_t a, uint32_t b);

/* max(1, rate * wanted / planned); planned not 0. */
uint32_t scaled_rate(uint32_t rate, uint16_t wanted, uint16_t planned);

static inline uint32_t sum_or_most(uint32_t a, uint32_t b)
{
    uint32_t sum = a + b;
    return sum < a ? 0xFFFFFFFFUL : sum;
}

#endif
