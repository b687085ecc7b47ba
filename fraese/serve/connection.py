"""The line to one sender: what is told to him never waits, whoever tells it."""

import os
import threading
from collections.abc import Callable
from typing import Final

#: Who reads nothing for so long is told no more.
_MOST_WAITING_BYTES: Final = 1 << 20
_READ_BYTES: Final = 1 << 14


class Connection:
    """An open descriptor, read and written without waiting.

    Args:
        fd: of a terminal or a socket; does not block.
        name: of who is at the other end, for people.
        wants_turn: called when something is left to write; from any thread.
    """

    def __init__(self, fd: int, name: str, wants_turn: Callable[[], object]) -> None:
        self.fd = fd
        self.name = name
        self._wants_turn = wants_turn
        self._lock = threading.Lock()
        self._waiting = bytearray()
        self._is_closed = False

    def put(self, text: str) -> None:
        """Tell him this; from any thread."""
        with self._lock:
            if self._is_closed or len(self._waiting) > _MOST_WAITING_BYTES:
                return
            was_waiting = bool(self._waiting)
            self._waiting += text.encode("ascii", "replace")
            if not was_waiting:
                self._write()
            left = bool(self._waiting) and not was_waiting
        if left:
            self._wants_turn()

    def flush(self) -> None:
        """Write what can be written."""
        with self._lock:
            if not self._is_closed:
                self._write()

    @property
    def is_waiting(self) -> bool:
        """Something is left to write."""
        return bool(self._waiting)

    def read(self) -> bytes | None:
        """What has come; None: he has gone."""
        try:
            return os.read(self.fd, _READ_BYTES) or None
        except BlockingIOError:
            return b""
        except OSError:
            return None

    def close(self) -> None:
        """Nothing more is written; the descriptor is its owner's."""
        with self._lock:
            self._is_closed = True
            self._waiting.clear()

    def _write(self) -> None:
        try:
            while self._waiting:
                del self._waiting[: os.write(self.fd, self._waiting)]
        except BlockingIOError:
            pass
        except OSError:
            # Who reads will see that he has gone.
            self._waiting.clear()
