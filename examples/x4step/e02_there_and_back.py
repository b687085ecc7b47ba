"""Four axes there, and the way back loaded meanwhile (manual, section 2).

The printed fragment lacks the slashes of its comments, X4Init and the end.
"""

from fraese.x4step import X4GetState, X4Init, X4Load, X4ReInit, X4Start


def main() -> None:
    X4Init(2)
    X4Load(1000, 800, 600, 400, 1000, 50)
    X4Start()
    # Loaded while the axes move: nothing is to be worked out when they stand.
    X4Load(-1000, -800, -600, -400, 1000, 50)
    while X4GetState():
        pass
    X4Start()
    while X4GetState():
        pass
    X4ReInit()


if __name__ == "__main__":
    main()
