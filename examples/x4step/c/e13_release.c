/* Plus or minus moves an axis for as long as the key is held. As printed a header is misspelt. */
#include <conio.h>
#include <dos.h>
#include "x4step.h"

main()
{
    char codes[2];

    X4Init(2);
    codes[1] = 0;
    switch (getch()) {
    case '+':
        codes[0] = inp(0x60) + 128;
        X4BrakeCodes(codes);
        X4MovePos(1, 1000, 50);
        break;
    case '-':
        codes[0] = inp(0x60) + 128;
        X4BrakeCodes(codes);
        X4MoveNeg(1, 1000, 50);
        break;
    }
    while (X4GetState())
        ;
    X4ReInit();
}
