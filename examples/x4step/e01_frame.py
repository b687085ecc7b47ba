"""The frame of every program: X4Init first, X4ReInit last (manual, section 2).

The printed frame is the only place that names the constant LPT1.
"""

from fraese.x4step import LPT1, X4Init, X4ReInit


def main() -> None:
    X4Init(LPT1)
    # Everything else goes here.
    X4ReInit()


if __name__ == "__main__":
    main()
