"""An axis moves until pin 15 is high (manual: X4GetIn).

On a simulated port the inputs rest high, so it ends at once; begin with pin 15 low, by
FRAESE_X4STEP_PINS=15=low or low_pins in the configuration, and it waits for a hand.
"""

from fraese.x4step import X4Brake, X4GetIn, X4Init, X4MovePos, X4ReInit


def main() -> None:
    X4Init(2)
    X4MovePos(1, 1000, 50)
    while X4GetIn() & 0x01 == 0:
        pass
    X4Brake()
    X4ReInit()


if __name__ == "__main__":
    main()
