r"""Programs that forget X4ReInit, or do not get to it: ports are given back all the same.

    end of the program, exception, Ctrl-C      atexit
    SIGTERM, SIGHUP, SIGQUIT (Ctrl-\)           SystemExit in the main thread, then atexit
    kill -9                                    the step process, or the bridge, misses the program

Rule 1: signals that the program handles itself stay its own.
Rule 2: while a machine is open, threads take turns more often: the owner must not wait for 5 ms.
"""

import atexit
import signal
import sys
import threading
from types import FrameType
from typing import Any, Final, Protocol

from fraese.phrases import phrase
from fraese.x4step.complaints import complain

_SIGNALS: Final = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)
_TURN_S: Final = 0.000_5


class Closable(Protocol):
    """What must not stay open."""

    def close(self) -> None:
        """Axes braked, lines low, port given back."""


_open: list[Closable] = []
_before: dict[int, Any] = {}
_turn_before_s = 0.0


def hold(machine: Closable) -> None:
    """Close it, if nobody else does."""
    global _turn_before_s
    if not _open:
        _turn_before_s = sys.getswitchinterval()
        sys.setswitchinterval(min(_TURN_S, _turn_before_s))
        _take_signals()
    _open.append(machine)


def let_go(machine: Closable) -> None:
    """It is closed."""
    if machine not in _open:
        return
    _open.remove(machine)
    if not _open:
        sys.setswitchinterval(_turn_before_s)
        _give_signals_back()


@atexit.register
def close_all() -> None:
    """Close what is still open."""
    for machine in tuple(_open):
        try:
            machine.close()
        except Exception as error:
            # The others still have to be closed.
            complain(phrase("Not everything could be switched off: {error}", error=error))


def _take_signals() -> None:
    if threading.current_thread() is not threading.main_thread():
        return
    for number in _SIGNALS:
        if signal.getsignal(number) is signal.SIG_DFL:
            _before[number] = signal.signal(number, _leave)


def _give_signals_back() -> None:
    if threading.current_thread() is not threading.main_thread():
        return
    for number, handler in _before.items():
        if signal.getsignal(number) is _leave:
            signal.signal(number, handler)
    _before.clear()


def _leave(number: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + number)
