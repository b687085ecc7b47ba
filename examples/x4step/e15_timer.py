"""An axis is braked after half a second by the timer (manual: X4ClearTimer, X4GetTimer).

X4ReInit follows the brake at once: it waits until the ramp is driven.
"""

from fraese.x4step import X4Brake, X4ClearTimer, X4GetTimer, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    X4ClearTimer()
    while X4GetTimer() < 500:
        pass
    X4Brake()
    X4ReInit()


if __name__ == "__main__":
    main()
