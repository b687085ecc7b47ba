/* Which key has braked? */
#include <stdio.h>
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
    switch (X4LastBrakeCode()) {
    case 1:
        printf("ESC has braked\n");
        break;
    case 28:
        printf("ENTER has braked\n");
        break;
    }
    X4ReInit();
}
