"""An endless move is braked, and its steps are read at standstill (manual: X4Brake).

As printed it waits by counting, with a misprint that lets it count for ever, and its last two
comments are exchanged. Here it waits by the timer.
"""

from fraese.x4step import X4Brake, X4GetState, X4GetSteps, X4GetTimer, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetTimer() < 300:
        pass
    X4Brake()
    while X4GetState():
        pass
    print(X4GetSteps(1), "steps")
    X4ReInit()


if __name__ == "__main__":
    main()
