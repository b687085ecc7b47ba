"""The lines of a port as a waveform file (VCD), for GTKWave, PulseView and others.

    driver --> TracedPort --> port
                   |
               Waveform --> FILE.vcd: one wire a line, ``pin03_clock1``

Rule 1: a wire is named by its pin of the DB25 and by what hangs on it.
Rule 2: time is the driver's clock, in ns, and begins at the first access.
Rule 3: only changes are written. What a line was before its first write is not known (x).
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from vcd import VCDWriter

from fraese.errors import PortError
from fraese.motor.pins import CONTROL_PINS, DATA_PINS, STATUS_PINS, Line
from fraese.motor.seams import CONTROL, DATA, STATUS, Clock, Port

_PINS: Final[Mapping[int, Mapping[int, Line]]] = {
    DATA: DATA_PINS,
    STATUS: STATUS_PINS,
    CONTROL: CONTROL_PINS,
}


class Waveform:
    """A waveform file.

    Args:
        path: of the file; what was there before is gone.
        scope: what the lines belong to, one word.
        names: what hangs on a pin, one word each.

    Raises:
        PortError: if it cannot be written.
    """

    def __init__(self, path: Path, scope: str, names: Mapping[int, str]) -> None:
        try:
            self._file = path.open("w", encoding="ascii")
        except OSError as error:
            raise PortError(f"{path}: the waveform cannot be written: {error.strerror}.") from error
        self._writer = VCDWriter(self._file, timescale="1 ns", version="fraese")
        self._wires: dict[int, list[tuple[Line, Any]]] = {
            register: [
                (line, self._writer.register_var(scope, _name(pin, names), "wire", size=1))
                for pin, line in pins.items()
            ]
            for register, pins in _PINS.items()
        }
        self._levels: dict[int, int] = {}
        self._begin_ns: int | None = None
        self._now_ns = 0

    def note(self, at_ns: int, register: int, value: int) -> None:
        """A register was written, or read, with this value."""
        if value == self._levels.get(register):
            return
        self._levels[register] = value
        if self._begin_ns is None:
            self._begin_ns = at_ns
        self._now_ns = at_ns - self._begin_ns
        for line, wire in self._wires[register]:
            self._writer.change(wire, self._now_ns, int(bool(value & line.bit) != line.inverted))

    def close(self, at_ns: int) -> None:
        """The last moment, and the end of the file."""
        self._writer.close(max(self._now_ns, at_ns - (self._begin_ns or at_ns)))
        self._file.close()


class TracedPort:
    """A port whose every access goes into a waveform, and on.

    Args:
        port: to pass on to.
        clock: when.
        waveform: to write to; closed with the port.
    """

    def __init__(self, port: Port, clock: Clock, waveform: Waveform) -> None:
        self._port = port
        self._clock = clock
        self._waveform = waveform

    def write_data(self, value: int) -> None:
        """Note, and pass on."""
        self._waveform.note(self._clock.now_ns(), DATA, value)
        self._port.write_data(value)

    def write_control(self, value: int) -> None:
        """Note, and pass on."""
        self._waveform.note(self._clock.now_ns(), CONTROL, value)
        self._port.write_control(value)

    def read_status(self) -> int:
        """Pass on, and note the answer."""
        value = self._port.read_status()
        self._waveform.note(self._clock.now_ns(), STATUS, value)
        return value

    def close(self) -> None:
        """The file is whole; pass on."""
        self._waveform.close(self._clock.now_ns())
        self._port.close()


def _name(pin: int, names: Mapping[int, str]) -> str:
    return f"pin{pin:02d}_{names.get(pin, 'line')}"
