/* One axis moves until ESC, then all is given back. As printed, a bracket is missing. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    while (X4GetState())
        ;
    X4ReInit();
}
