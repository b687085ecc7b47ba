"""A Port that wraps any other and says what is done with it, and when."""

from collections.abc import Callable

from fraese.motor.seams import CONTROL, DATA, STATUS, Port

#: Takes an access: time in ns, register, value.
Note = Callable[[int, int, int], None]


class TracedPort:
    """Passes everything on; a reading that is as the last one is not worth a note.

    Args:
        port: to pass on to.
        now_ns: when.
        note: takes every access.
    """

    def __init__(self, port: Port, now_ns: Callable[[], int], note: Note) -> None:
        self._port = port
        self._now_ns = now_ns
        self._note = note
        self._status = -1

    def write_data(self, value: int) -> None:
        """Note, and pass on."""
        self._note(self._now_ns(), DATA, value)
        self._port.write_data(value)

    def write_control(self, value: int) -> None:
        """Note, and pass on."""
        self._note(self._now_ns(), CONTROL, value)
        self._port.write_control(value)

    def read_status(self) -> int:
        """Pass on, and note the answer."""
        value = self._port.read_status()
        if value != self._status:
            self._status = value
            self._note(self._now_ns(), STATUS, value)
        return value

    def close(self) -> None:
        """Pass on."""
        self._port.close()
