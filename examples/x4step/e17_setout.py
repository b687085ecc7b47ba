"""Signal 1 is on while the axis moves (manual: X4SetOut)."""

from fraese.x4step import SIGNAL1OFF, SIGNAL1ON, X4GetState, X4Init, X4MovePos, X4ReInit, X4SetOut


def main() -> None:
    X4Init(2)
    X4SetOut(SIGNAL1ON)
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    X4SetOut(SIGNAL1OFF)
    X4ReInit()


if __name__ == "__main__":
    main()
