/* The state is asked until ESC has ended a move. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4MovePos(1, 1000, 50);
    while (X4GetState())
        ;
    X4ReInit();
}
