"""One axis moves until ESC is pressed (manual: X4Init).

The printed comments stand one line too low.
"""

from fraese.x4step import X4GetState, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    X4ReInit()


if __name__ == "__main__":
    main()
