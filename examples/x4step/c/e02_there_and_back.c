/* Four axes there, and the way back loaded meanwhile. */
#include "x4step.h"

main()
{
    X4Init(2);
    X4Load(1000, 800, 600, 400, 1000, 50);
    X4Start();
    X4Load(-1000, -800, -600, -400, 1000, 50);
    while (X4GetState())
        ;
    X4Start();
    while (X4GetState())
        ;
    X4ReInit();
}
