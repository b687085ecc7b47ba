"""What hangs on the lines of a port, and what a card makes of them, for who looks at waveforms.

Rule 1: everything is told from the accesses to the registers, as electronics would see them.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

from fraese.motor.phases import currents_of
from fraese.motor.pins import CONTROL_PINS
from fraese.motor.seams import CONTROL, DATA

_STROBE: Final = CONTROL_PINS[1].bit
_SOCKET_SHIFT: Final = 6
_NOTHING: Final = ()


class Decoder(Protocol):
    """Quantities behind the lines.

    Attributes:
        names: one word for each.
    """

    names: Sequence[str]

    def seen(self, register: int, value: int) -> Iterable[tuple[int, int]]:
        """An access: quantities, by their number, and what they are from now on."""


def no_decoder() -> None:
    """There is nothing behind the lines but themselves."""


@dataclass(frozen=True)
class Meaning:
    """What hangs on the lines.

    Attributes:
        pins: one word for a pin of the DB25.
        decoder: makes a new decoder for the quantities behind them.
    """

    pins: Mapping[int, str]
    decoder: Callable[[], Decoder | None] = no_decoder


class CoilCurrents:
    """The currents that a phase card sets, in per cent of the maximum: two coils an axis.

    Args:
        axes: name of the axis in each socket.
        levels: per cent for each of the four codes.
    """

    def __init__(self, axes: Mapping[int, str], levels: tuple[int, int, int, int]) -> None:
        self.names: Sequence[str] = [
            f"{name}_coil_{coil}" for name in axes.values() for coil in "ab"
        ]
        self._first = {socket: 2 * number for number, socket in enumerate(axes)}
        self._currents = [currents_of(byte, levels) for byte in range(64)]
        self._data = self._control = 0

    def seen(self, register: int, value: int) -> Iterable[tuple[int, int]]:
        """The strobe's setting edge latches the byte."""
        if register == DATA:
            self._data = value
        if register != CONTROL:
            return _NOTHING
        latches = value & _STROBE and not self._control & _STROBE
        self._control = value
        first = self._first.get(self._data >> _SOCKET_SHIFT)
        if not latches or first is None:
            return _NOTHING
        a_percent, b_percent = self._currents[self._data & 63]
        return (first, a_percent), (first + 1, b_percent)
