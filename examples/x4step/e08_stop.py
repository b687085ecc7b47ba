"""An endless move is stopped without a ramp (manual: X4Stop).

The motor may turn on by steps that nobody counts: such a machine is to be referenced again. As
printed the counter of its waiting loop is not declared; here it waits by the timer.
"""

from fraese.x4step import X4GetTimer, X4Init, X4MovePos, X4ReInit, X4Stop


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetTimer() < 300:
        pass
    X4Stop()
    X4ReInit()


if __name__ == "__main__":
    main()
