"""The steps are shown while the axis moves, until ESC (manual: X4GetSteps).

As printed it shows a long with the format of an int: under DOS only the low 16 bits.
"""

from fraese.x4step import X4GetState, X4GetSteps, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetState():
        print(X4GetSteps(1))
    X4ReInit()


if __name__ == "__main__":
    main()
