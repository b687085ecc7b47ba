"""ENTER brakes too, not only ESC (manual: X4BrakeCodes)."""

from fraese.x4step import X4BrakeCodes, X4GetState, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    # Make code of ENTER; a 0 ends the list.
    X4BrakeCodes([28, 0])
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    X4ReInit()


if __name__ == "__main__":
    main()
