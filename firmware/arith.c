/* Rules: arith.h. */
#include "arith.h"

#include "line.h"
#include "state.h"

uint32_t rate_over(uint32_t divisor)
{
    uint32_t rest = RATE_CYCLES, quotient = 0;
    uint8_t bits = 1;
    while (!(divisor >> 24)) {
        divisor <<= 8;
        bits += 8;
    }
    while (!(divisor & 0x80000000UL)) {
        divisor <<= 1;
        bits++;
    }
    line_poll();
    do {
        if (!(bits & 7))
            line_poll();
        quotient <<= 1;
        if (rest >= divisor) {
            rest -= divisor;
            quotient |= 1;
        }
        divisor >>= 1;
    } while (--bits);
    return quotient;
}

uint32_t ratio_q16(uint32_t a, uint32_t b)
{
    uint32_t whole = 0;
    if (a >= b) {
        if (a - b < b) { /* near one, as most junctions are */
            whole = 1;
            a -= b;
        } else {
            whole = a / b;
            a -= whole * b;
        }
    }
    if (whole >> 16)
        return 0xFFFFFFFFUL;
    if (!a)
        return whole << 16;
    line_poll();
    return whole << 16 | fraction_q16(a, b);
}

uint32_t scaled_rate(uint32_t rate, uint16_t wanted, uint16_t planned)
{
    /* Long division of a product of 48 bits, whose last 16 are shifted in as they are needed. */
    uint32_t high = (rate >> 16) * wanted;
    uint32_t low = (rate & 0xFFFF) * wanted;
    high += low >> 16;
    uint32_t quotient = high / planned;
    uint32_t rest = high % planned;
    line_poll();
    uint16_t bits = (uint16_t)low;
    if (quotient >> 16)
        return 0xFFFFFFFFUL;
    for (uint8_t bit = 16; bit; bit--) {
        if (!(bit & 7))
            line_poll();
        rest = rest << 1 | bits >> 15;
        bits <<= 1;
        quotient <<= 1;
        if (rest >= planned) {
            rest -= planned;
            quotient |= 1;
        }
    }
    return quotient ? quotient : 1;
}
