/* The frame of every program. */
#include "x4step.h"

main()
{
    X4Init(LPT1);
    /* Everything else goes here. */
    X4ReInit();
}
