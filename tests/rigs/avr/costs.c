/* One instruction after another between two writes of PORTB: their cost is the gap less 1. */
#include "common.h"

#define COST(instruction)                                                                          \
    __asm__ volatile("out %0, r1\n " instruction "\n out %0, r1\n" ::"I"(_SFR_IO_ADDR(PORTB))      \
                     : "r16", "r17", "r18", "r19", "r20", "r24", "r25", "r26", "r27", "r30",       \
                       "r31", "r0", "memory")

static volatile uint8_t cell[4];

int main(void) {
    __asm__ volatile("ldi r26, lo8(cell)\n ldi r27, hi8(cell)\n"
                     "ldi r30, lo8(cell)\n ldi r31, hi8(cell)\n" ::
                         : "r26", "r27", "r30", "r31");
    cell[0] = 0;
    COST("nop");
    COST("adiw r24, 1");
    COST("lds r16, cell");
    COST("sts cell, r16");
    COST("ld r16, X");
    COST("ld r16, X+");
    COST("ld r16, -X");
    COST("ldd r16, Z+1");
    COST("std Z+1, r16");
    COST("st X, r16");
    COST("push r16");
    COST("pop r16");
    COST("lpm r16, Z");
    COST("lpm r16, Z+");
    COST("sbiw r30, 1");
    COST("mul r16, r17\n clr r1");
    COST("sbi %0, 0");
    COST("rjmp .+0");
    COST("sez\n breq .+0");
    COST("clz\n breq .+0");
    COST("clr r16\n sbrc r16, 0\n nop");
    COST("clr r16\n sbrs r16, 0\n nop");
    COST("clr r16\n sbrs r16, 0\n lds r16, cell");
    COST("rcall .+2\n rjmp .+2\n ret");
    COST("call 1f\n rjmp 2f\n 1: ret\n 2:");
    COST("ldi r30, lo8(gs(1f))\n ldi r31, hi8(gs(1f))\n ijmp\n 1:");
    COST("ldi r30, lo8(gs(1f))\n ldi r31, hi8(gs(1f))\n icall\n rjmp 2f\n 1: ret\n 2:");
    COST("jmp 1f\n 1:");
    for (;;)
        ;
}
