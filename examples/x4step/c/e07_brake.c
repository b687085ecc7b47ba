/* An endless move is braked, and its steps are read. As printed it waits for ever. */
#include <stdio.h>
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    while (X4GetTimer() < 300)
        ;
    X4Brake();
    while (X4GetState())
        ;
    printf("%ld steps\n", X4GetSteps(1));
    X4ReInit();
}
