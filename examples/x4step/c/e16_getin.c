/* An axis moves until pin 15 is high. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    while ((X4GetIn() & 0x01) == 0)
        ;
    X4Brake();
    X4ReInit();
}
