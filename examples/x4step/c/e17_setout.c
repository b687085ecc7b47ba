/* Signal 1 is on while the axis moves. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4SetOut(SIGNAL1ON);
    X4MovePos(1, 1000, 50);
    while (X4GetState())
        ;
    X4SetOut(SIGNAL1OFF);
    X4ReInit();
}
