"""A Port that wraps any other and remembers every access."""

from typing import NamedTuple

from fraese.motor.seams import CONTROL, DATA, STATUS, Clock, Port


class Access(NamedTuple):
    """One access to a register; for STATUS ``value`` is what was read."""

    at_ns: int
    register: int
    value: int


class Recorder:
    """Passes everything on and writes it down.

    Attributes:
        accesses: in order.
    """

    def __init__(self, port: Port, clock: Clock) -> None:
        self._port = port
        self._clock = clock
        self.accesses: list[Access] = []

    def write_data(self, value: int) -> None:
        """Note, and pass on."""
        self.accesses.append(Access(self._clock.now_ns(), DATA, value))
        self._port.write_data(value)

    def write_control(self, value: int) -> None:
        """Note, and pass on."""
        self.accesses.append(Access(self._clock.now_ns(), CONTROL, value))
        self._port.write_control(value)

    def read_status(self) -> int:
        """Pass on, and note the answer."""
        value = self._port.read_status()
        self.accesses.append(Access(self._clock.now_ns(), STATUS, value))
        return value

    def close(self) -> None:
        """Pass on."""
        self._port.close()

    def writes(self) -> list[tuple[int, int]]:
        """Registers and values written, without readings and times."""
        return [(a.register, a.value) for a in self.accesses if a.register != STATUS]
