"""One axis moves until ESC is pressed, then all is given back (manual: X4ReInit).

As printed its loop lacks a closing bracket.
"""

from fraese.x4step import X4GetState, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    # All lines are low after this, the terminal is as it was.
    X4ReInit()


if __name__ == "__main__":
    main()
