"""The lines between computer and card, as they were written and read while somebody listened.

    access   register and value, as the driver made it
    edge     a pin of the plug (DB25) that became another level

Rule 1: times are those of the machine, seconds since the recording began.
"""

from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from fraese.motor.pins import CONTROL_PINS, DATA_PINS, STATUS_PINS, Line
from fraese.motor.seams import CONTROL, DATA, STATUS
from fraese.testing.failures import NoSuchName

_PINS: Final[Mapping[int, Mapping[int, Line]]] = {
    DATA: DATA_PINS,
    STATUS: STATUS_PINS,
    CONTROL: CONTROL_PINS,
}
_NS_PER_S: Final = 1_000_000_000


class Access(NamedTuple):
    """One access to a register: 0 data, 1 status (what was read), 2 control."""

    at_s: float
    register: int
    value: int


class Edge(NamedTuple):
    """A pin that became high, or low."""

    at_s: float
    high: bool


class Lines:
    """What was recorded.

    Args:
        from_ns: when it began.

    Attributes:
        accesses: in order; a reading that was as the one before is left out.
    """

    def __init__(self, from_ns: int) -> None:
        self._from_ns = from_ns
        self.accesses: list[Access] = []

    def note(self, at_ns: int, register: int, value: int) -> None:
        """One more access."""
        self.accesses.append(Access((at_ns - self._from_ns) / _NS_PER_S, register, value))

    def writes(self) -> list[tuple[int, int]]:
        """Registers and values as they were written, without times and readings."""
        return [(register, value) for _, register, value in self.accesses if register != STATUS]

    def edges(self, pin: int) -> list[Edge]:
        """Where a pin of the plug changed; its level before the first access does not count.

        Args:
            pin: of the DB25: 2 to 9 data, 1 14 16 17 control, 10 11 12 13 15 inputs.

        Raises:
            NoSuchName: it carries no signal.
        """
        return list(self._edges(pin))

    def _edges(self, pin: int) -> Iterator[Edge]:
        register, line = _behind(pin)
        before: bool | None = None
        for at_s, there, value in self.accesses:
            if there == register:
                high = bool(value & line.bit) != line.inverted
                if before is not None and high is not before:
                    yield Edge(at_s, high)
                before = high


def _behind(pin: int) -> tuple[int, Line]:
    for register, pins in _PINS.items():
        if pin in pins:
            return register, pins[pin]
    known = sorted(pin for pins in _PINS.values() for pin in pins)
    raise NoSuchName(str(pin), map(str, known))
