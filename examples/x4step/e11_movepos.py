"""An axis moves one way until ESC, then the other way (manual: X4MovePos, X4MoveNeg).

The manual prints an example for the positive direction only.
"""

from fraese.x4step import X4GetState, X4Init, X4MoveNeg, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    X4MoveNeg(1, 1000, 50)
    while X4GetState():
        pass
    X4ReInit()


if __name__ == "__main__":
    main()
