"""The pipe from the host: it rings with a byte, and is at its end when the host is dead."""

import contextlib
import os
import select
from typing import Final

from fraese.errors import PortError
from fraese.phrases import phrase

_LENGTH_BYTES: Final = 8
_AT_ONCE: Final = 4096


class HostLine:
    """The child's end of the pipe.

    Args:
        fd: to read from.

    Attributes:
        broken: the host has closed its end, or is dead.
    """

    def __init__(self, fd: int) -> None:
        self._fd = fd
        self._poll = select.poll()
        self._poll.register(fd, select.POLLIN | select.POLLHUP)
        self.broken = False

    def read_message(self) -> bytes:
        """The one message of the start: its length, then itself.

        Raises:
            PortError: if the host is gone before its end.
        """
        return self._read(int.from_bytes(self._read(_LENGTH_BYTES), "big"))

    def _read(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            part = os.read(self._fd, size - len(data))
            if not part:
                raise PortError(phrase("The program that drives the step process is gone."))
            data += part
        return data

    def listen(self) -> None:
        """From now on reading does not wait."""
        os.set_blocking(self._fd, False)

    def look(self) -> bool:
        """Take the rings so far; True: the line is broken."""
        with contextlib.suppress(BlockingIOError):
            self.broken = not os.read(self._fd, _AT_ONCE)
        return self.broken

    def doze(self, timeout_s: float) -> None:
        """Sleep until somebody rings, or for so long."""
        if not self.broken and self._poll.poll(timeout_s * 1000):
            self.look()


def message(data: bytes) -> bytes:
    """What ``read_message`` reads."""
    return len(data).to_bytes(_LENGTH_BYTES, "big") + data
