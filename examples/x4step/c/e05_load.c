/* A thousand steps there, and back by a path loaded meanwhile. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4Load(1000, 0, 0, 0, 1000, 50);
    X4Start();
    X4Load(-1000, 0, 0, 0, 1000, 50);
    while (X4GetState())
        ;
    X4Start();
    while (X4GetState())
        ;
    X4ReInit();
}
