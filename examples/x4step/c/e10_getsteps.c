/* The steps are shown while the axis moves. As printed the format is that of an int. */
#include <stdio.h>
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    while (X4GetState())
        printf("%ld\n", X4GetSteps(1));
    X4ReInit();
}
