/* Three times the same value. */
#include "common.h"

int main(void) {
    OUT(PORTB, 5);
    OUT(PORTB, 5);
    OUT(PORTB, 5);
    for (;;)
        ;
}
