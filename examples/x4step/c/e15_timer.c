/* An axis is braked after half a second by the timer. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    X4ClearTimer();
    while (X4GetTimer() < 500)
        ;
    X4Brake();
    X4ReInit();
}
