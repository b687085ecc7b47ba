/* One instruction after another between two writes of PORTB: its cost is the gap less 1. The number
 * is the data sheet's (chapter 31); the test reads it here. */
#include "common.h"

#define COST(cycles, instruction)                                                                  \
    __asm__ volatile("out %0, r1\n " instruction "\n out %0, r1\n" ::"I"(_SFR_IO_ADDR(PORTB))      \
                     : "r16", "r17", "r18", "r19", "r20", "r24", "r25", "r26", "r27", "r30",       \
                       "r31", "r0", "memory")

static volatile uint8_t cell[4];

int main(void) {
    __asm__ volatile("ldi r26, lo8(cell)\n ldi r27, hi8(cell)\n"
                     "ldi r30, lo8(cell)\n ldi r31, hi8(cell)\n" ::
                         : "r26", "r27", "r30", "r31");
    cell[0] = 0;
    COST(1, "nop");
    COST(2, "adiw r24, 1");
    COST(2, "lds r16, cell");
    COST(2, "sts cell, r16");
    COST(2, "ld r16, X");
    COST(2, "ld r16, X+");
    COST(2, "ld r16, -X");
    COST(2, "ldd r16, Z+1");
    COST(2, "std Z+1, r16");
    COST(2, "st X, r16");
    COST(2, "push r16");
    COST(2, "pop r16");
    COST(3, "lpm r16, Z");
    COST(3, "lpm r16, Z+");
    COST(2, "sbiw r30, 1");
    COST(3, "mul r16, r17\n clr r1");
    COST(2, "sbi 0x1e, 0");
    COST(2, "rjmp .+0");
    COST(3, "sez\n breq .+0");
    COST(2, "clz\n breq .+0");
    COST(3, "clr r16\n sbrc r16, 0\n nop");
    COST(3, "clr r16\n sbrs r16, 0\n nop");
    COST(4, "clr r16\n sbrc r16, 0\n lds r16, cell");
    COST(9, "rcall .+2\n rjmp .+2\n ret");
    COST(10, "call 1f\n rjmp 2f\n 1: ret\n 2:");
    COST(4, "ldi r30, lo8(gs(1f))\n ldi r31, hi8(gs(1f))\n ijmp\n 1:");
    COST(11, "ldi r30, lo8(gs(1f))\n ldi r31, hi8(gs(1f))\n icall\n rjmp 2f\n 1: ret\n 2:");
    COST(3, "jmp 1f\n 1:");
    for (;;)
        ;
}
