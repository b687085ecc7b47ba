"""The plug of a parallel port: which register bit is behind which pin of a DB25 (IEEE 1284).

data     pins 2 to 9                 as they are
status   pins 10 11 12 13 15         11 is inverted
control  pins 1 14 16 17             1, 14 and 17 are inverted
"""

from collections.abc import Mapping
from typing import Final, NamedTuple


class Line(NamedTuple):
    """One line of a register.

    Attributes:
        bit: its mask in the register.
        inverted: a set bit is a low pin.
    """

    bit: int
    inverted: bool


DATA_PINS: Final[Mapping[int, Line]] = {2 + bit: Line(1 << bit, False) for bit in range(8)}

STATUS_PINS: Final[Mapping[int, Line]] = {
    10: Line(0x40, False),
    11: Line(0x80, True),
    12: Line(0x20, False),
    13: Line(0x10, False),
    15: Line(0x08, False),
}

CONTROL_PINS: Final[Mapping[int, Line]] = {
    1: Line(0x01, True),
    14: Line(0x02, True),
    16: Line(0x04, False),
    17: Line(0x08, True),
}


def levels(register: int, pins: Mapping[int, Line]) -> dict[int, bool]:
    """Level (True: high) of each of these pins, by pin, from the value of their register."""
    return {pin: bool(register & line.bit) != line.inverted for pin, line in pins.items()}
