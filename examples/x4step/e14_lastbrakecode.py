"""Which key has braked? (Manual: X4LastBrakeCode.)

The printed comments stand one line too low.
"""

from fraese.x4step import X4BrakeCodes, X4GetState, X4Init, X4LastBrakeCode, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4BrakeCodes([28, 0])
    X4MovePos(1, 1000, 50)
    while X4GetState():
        pass
    keys = {1: "ESC", 28: "ENTER"}
    key = keys.get(X4LastBrakeCode())
    if key:
        print(key, "has braked")
    X4ReInit()


if __name__ == "__main__":
    main()
