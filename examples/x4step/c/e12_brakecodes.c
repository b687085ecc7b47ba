/* ENTER brakes too, not only ESC. */
#include "x4step.h"

main()
{
    char codes[2];

    X4Init(2);
    codes[0] = 28;
    codes[1] = 0;
    X4BrakeCodes(codes);
    X4MovePos(1, 1000, 50);
    while (X4GetState())
        ;
    X4ReInit();
}
