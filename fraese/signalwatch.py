"""Signals that end the program are heard by a thread of their own.

    signal --system's handler, at once--> socket --> watching thread: act(number)
       '---Python's handler, when the main thread gets to it--> in_main(number)

Rule 1: what the main thread waits for (a terminal that nobody reads, a lock, a disk) delays nothing
        that ``act`` does; nor does what else the machine is busy with, where the system lets it.
Rule 2: they are heard in a main thread only; elsewhere, and where there are none, nothing changes.
        Where sockets cannot be told of signals, the main thread acts.
"""

import contextlib
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Final

from fraese.comefirst import come_first_when_woken

#: Those of them that this system has: interrupt, terminate, terminal gone.
ENDING: Final[tuple[int, ...]] = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
_TELLS_SOCKETS: Final = sys.platform != "win32"


@contextlib.contextmanager
def watched(
    act: Callable[[int], object],
    in_main: Callable[[int], object] | None = None,
    numbers: tuple[int, ...] = ENDING,
) -> Iterator[None]:
    """Meanwhile these signals act instead of killing the program.

    Args:
        act: called in the watching thread, with the signal's number; it must not wait for long.
        in_main: called in the main thread when it gets to it; may raise there.
        numbers: the signals.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard, told = socket.socketpair()
    for end in (heard, told):
        end.setblocking(end is heard)

    def on_signal(number: int, frame: FrameType | None) -> None:
        if not _TELLS_SOCKETS:
            act(number)
        if in_main is not None:
            in_main(number)

    watcher = threading.Thread(target=_watch, args=(heard, act, numbers), name="signals")
    watcher.daemon = True
    watcher.start()
    before_fd = -1
    before: dict[int, object] = {}
    try:
        if _TELLS_SOCKETS:
            before_fd = signal.set_wakeup_fd(told.fileno(), warn_on_full_buffer=False)
        for number in numbers:
            before[number] = signal.signal(number, on_signal)
        yield
    finally:
        for number, handler in before.items():
            # None: it was set by somebody outside of Python, and cannot be put back.
            signal.signal(number, signal.SIG_DFL if handler is None else handler)  # type: ignore[arg-type]
        if _TELLS_SOCKETS:
            signal.set_wakeup_fd(before_fd)
        # What is closed here is read to its end there.
        told.close()
        if watcher is not threading.current_thread():
            watcher.join(timeout=1)
        heard.close()


def _watch(heard: socket.socket, act: Callable[[int], object], numbers: tuple[int, ...]) -> None:
    come_first_when_woken()
    while True:
        try:
            arrived = heard.recv(256)
        except OSError:
            return
        if not arrived:
            return
        for number in arrived:
            if number in numbers:
                # Whatever goes wrong with this one, the next is heard too.
                with contextlib.suppress(Exception):
                    act(number)
