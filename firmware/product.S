// uint32_t product_q16(uint32_t a, uint32_t b): a * b >> 16, or the largest number there is.
//
//                  a3 a2 a1 a0     r25 .. r22
//               *  b3 b2 b1 b0     r21 .. r18
//     p7 p6 | p5 p4 p3 p2 | p1 p0  a column at a time, lowest first
//
// Rule 1: C would call four multiplications of 16 bits and add with care, 600 cycles; this takes
//         140, and a junction in a ramp needs two of them between two steps.

#define COLUMN_LOW r26
#define COLUMN_HIGH r27
#define CARRY r30
#define ZERO r31

.macro add_part one other
    mul  \one, \other
    add  COLUMN_LOW, r0
    adc  COLUMN_HIGH, r1
    adc  CARRY, ZERO
.endm

.macro next_column
    mov  COLUMN_LOW, COLUMN_HIGH
    mov  COLUMN_HIGH, CARRY
    clr  CARRY
.endm

    .text
    .global product_q16
product_q16:
    push r16
    push r17
    push r28
    push r29
    clr  ZERO
    clr  CARRY
    mul  r22, r18
    mov  COLUMN_LOW, r1
    clr  COLUMN_HIGH
    add_part r22, r19
    add_part r23, r18
    next_column
    add_part r22, r20
    add_part r23, r19
    add_part r24, r18
    mov  r16, COLUMN_LOW
    next_column
    add_part r22, r21
    add_part r23, r20
    add_part r24, r19
    add_part r25, r18
    mov  r17, COLUMN_LOW
    next_column
    add_part r23, r21
    add_part r24, r20
    add_part r25, r19
    mov  r28, COLUMN_LOW
    next_column
    add_part r24, r21
    add_part r25, r20
    mov  r29, COLUMN_LOW
    next_column
    add_part r25, r21
    or   COLUMN_LOW, COLUMN_HIGH
    breq 1f
    ldi  r16, 0xFF
    ldi  r17, 0xFF
    movw r28, r16
1:  movw r22, r16
    movw r24, r28
    pop  r29
    pop  r28
    pop  r17
    pop  r16
    clr  r1
    ret

// uint16_t fraction_q16(uint32_t a, uint32_t b): (a << 16) / b; a < b < 2^24.
//
// Rule 2: a bit takes 14 cycles, in C 38; two of these for every block come between the others that
//         a machine of many short lines waits for. Bits are shifted in as `less`, and turned at the end.

    .global fraction_q16
fraction_q16:                       // a: r24..r22, b: r20..r18, quotient r27:r26
    ldi  r21, 16
1:  lsl  r22
    rol  r23
    rol  r24
    brcs 2f
    cp   r22, r18
    cpc  r23, r19
    cpc  r24, r20
    brcs 3f
2:  sub  r22, r18
    sbc  r23, r19
    sbc  r24, r20
    clc
3:  rol  r26
    rol  r27
    dec  r21
    brne 1b
    com  r26
    com  r27
    movw r24, r26
    ret
