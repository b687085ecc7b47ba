"""The way out does not wait for a terminal.

    told to end --> brake --> motors off, state kept --> the picture, last words --> gone
                                      '---- a little later, if that way is blocked --^

Rule 1: the process ends by itself only when the machine is closed: until then it stays.
Rule 2: its exit code is the one that the orderly way would have given.
"""

import contextlib
import os
import threading
from collections.abc import Callable
from typing import Final

from fraese.earlyterminal import EARLY

#: From motors off and state kept to the end: longer than last words take, short for who waits.
_PATIENCE_S: Final = 0.7


class Departure:
    """Ends the process if its orderly end takes too long.

    Args:
        patience_s: how long that may take from when the machine is closed.
        leave: ends the process with an exit code, whatever else it does.
    """

    def __init__(
        self, patience_s: float = _PATIENCE_S, leave: Callable[[int], object] = os._exit
    ) -> None:
        self._patience_s = patience_s
        self._leave = leave
        self._lock = threading.Lock()
        self._hurries = False
        self._code: int | None = None
        self._timer: threading.Timer | None = None

    def hurry(self) -> None:
        """The program has been told to end; from any thread."""
        with self._lock:
            self._hurries = True
            self._watch()

    def machine_is_closed(self, code: int) -> None:
        """Motors off, state kept.

        Args:
            code: the exit code of the process.
        """
        with self._lock:
            self._code = code
            self._watch()

    def is_done(self) -> None:
        """The way out is free."""
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()

    def _watch(self) -> None:
        if not self._hurries or self._code is None or self._timer is not None:
            return
        self._timer = threading.Timer(self._patience_s, self._leave, (self._code,))
        self._timer.daemon = True
        self._timer.start()


class Closing:
    """Closes something once; whoever comes while it is being closed waits.

    Args:
        close: called once. What it raises, everybody gets.
    """

    def __init__(self, close: Callable[[], object]) -> None:
        self._close = close
        self._lock = threading.Lock()
        self._is_closed = False
        self._failure: Exception | None = None

    def __call__(self) -> None:
        """Close it, or wait until it is closed."""
        with self._lock:
            if not self._is_closed:
                self._is_closed = True
                try:
                    self._close()
                except Exception as error:
                    self._failure = error
        if self._failure is not None:
            raise self._failure

    def code(self, code: int) -> int:
        """Close it; this exit code, or another if that failed."""
        try:
            self()
        except Exception:
            return code or 1
        return code


def left_at_once(fd: int) -> Callable[[int], None]:
    """What ends the process with an exit code; the terminal is in the mode it was started in."""
    attributes = EARLY.before
    with contextlib.suppress(ImportError, OSError, ValueError):
        import termios

        with contextlib.suppress(termios.error):
            attributes = attributes or termios.tcgetattr(fd)

    def leave(code: int) -> None:
        if attributes is not None:
            with contextlib.suppress(OSError, termios.error):
                termios.tcsetattr(fd, termios.TCSANOW, attributes)
        os._exit(code)

    return leave


def in_background(action: Callable[[], object], name: str) -> None:
    """Begin this in a thread of its own; what goes wrong in it, another way finds too."""

    def go() -> None:
        with contextlib.suppress(Exception):
            action()

    threading.Thread(target=go, name=name, daemon=True).start()
