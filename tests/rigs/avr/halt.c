/* Sleeps with interrupts off. Nothing can wake it. */
#include "common.h"

#include <avr/sleep.h>

int main(void) {
    sleep_enable();
    sleep_cpu();
    for (;;)
        ;
}
