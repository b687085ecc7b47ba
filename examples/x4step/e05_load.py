"""A thousand steps there, and back by a path that is loaded meanwhile (manual: X4Load)."""

from fraese.x4step import X4GetState, X4Init, X4Load, X4ReInit, X4Start


def main() -> None:
    X4Init(2)
    X4Load(1000, 0, 0, 0, 1000, 50)
    X4Start()
    X4Load(-1000, 0, 0, 0, 1000, 50)
    while X4GetState():
        pass
    X4Start()
    while X4GetState():
        pass
    X4ReInit()


if __name__ == "__main__":
    main()
