/* An endless move is stopped without a ramp. As printed its counter is not declared. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    while (X4GetTimer() < 300)
        ;
    X4Stop();
    X4ReInit();
}
