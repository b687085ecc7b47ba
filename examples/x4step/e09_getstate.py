"""The state of the axes is asked until ESC has ended a move (manual: X4GetState)."""

from fraese.x4step import X4GetState, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    X4ReInit()


if __name__ == "__main__":
    main()
