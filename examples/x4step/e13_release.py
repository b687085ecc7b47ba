"""Plus or minus moves an axis for as long as the key is held (manual: X4BrakeCodes, BEISP7).

The axis is started by the key's make code and braked by its break code, 128 more. The printed
program reads the make code from port 60h of the PC, and misspells its header.
"""

from fraese.x4step import (
    X4BrakeCodes,
    X4GetState,
    X4Init,
    X4MoveNeg,
    X4MovePos,
    X4ReInit,
    getch,
    last_scan_code,
)


def main() -> None:
    X4Init(2)
    moves = {"+": X4MovePos, "-": X4MoveNeg}
    move = moves.get(getch())
    if move:
        X4BrakeCodes([last_scan_code() + 128, 0])
        move(1, 1000, 50)
        while X4GetState():
            pass
    X4ReInit()


if __name__ == "__main__":
    main()
