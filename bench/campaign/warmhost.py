"""``python -m bench.campaign.warmhost FD``: processes that have imported everything already.

    campaign --argv, environment, folder, streams--> this process --fork--> python -m MODULE
             <--pid ... exit code--------------------------'

Rule 1: what is forked is as a person would have started it, but for the time that Python's imports
        take: arguments, environment, folder, streams, session and terminal are its own, signals are
        as they are by default, it has one thread, and it ends as Python ends.
Rule 2: nothing but imports happens here before; so nothing is shared that a fault could touch.
Rule 3: numbers of files, never objects: those of others must not be closed in a child by a garbage
        collector.
"""

import contextlib
import fcntl
import gc
import importlib
import json
import os
import pkgutil
import runpy
import select
import signal
import socket
import sys
import termios
from pathlib import Path
from typing import Any, Final

#: Those that are imported by name only, or are programs.
_NOT: Final = ("__main__", ".lookthrough", ".bareloop")
_MOST_BYTES: Final = 200_000
_HIGHEST_FD: Final = 512
#: What a shell ignores for what it runs in the background.
_AS_IN_FRONT: Final[dict[int, Any]] = {
    signal.SIGINT: signal.default_int_handler,
    signal.SIGQUIT: signal.SIG_DFL,
    signal.SIGHUP: signal.SIG_DFL,
    signal.SIGCHLD: signal.SIG_DFL,
}


def _import_everything() -> None:
    import fraese

    for module in pkgutil.walk_packages(fraese.__path__, "fraese."):
        if not module.name.endswith(_NOT):
            # What another system has is not imported here.
            with contextlib.suppress(ImportError):
                importlib.import_module(module.name)
    with contextlib.suppress(ImportError):
        importlib.import_module("textual.drivers.linux_driver")
    gc.collect()
    gc.freeze()


class Host:
    """Forks, and says how it ended.

    Args:
        asked: socket on which is asked for processes.
    """

    def __init__(self, asked: int) -> None:
        self._asked = asked
        self._told: dict[int, int] = {}
        self._woken, self._wakes = os.pipe()
        for fd in (self._woken, self._wakes):
            os.set_blocking(fd, False)
        signal.signal(signal.SIGCHLD, lambda number, frame: None)
        signal.set_wakeup_fd(self._wakes, warn_on_full_buffer=False)

    def serve(self) -> dict[str, Any] | None:
        """Until nobody can ask any more; in a child: what it is to be."""
        while True:
            ready = select.select([self._asked, self._woken], [], [])[0]
            if self._woken in ready:
                with contextlib.suppress(BlockingIOError):
                    os.read(self._woken, 4096)
                self._bury()
            if self._asked in ready:
                order, fds = self._next()
                if order is None:
                    return None
                if self._begin(order, fds):
                    return order

    def _next(self) -> tuple[dict[str, Any] | None, list[int]]:
        with socket.socket(fileno=os.dup(self._asked)) as line:
            data, fds, _, _ = socket.recv_fds(line, _MOST_BYTES, 4)
        return (json.loads(data), fds) if data else (None, [])

    def _begin(self, order: dict[str, Any], fds: list[int]) -> bool:
        """Fork; True: this is the child."""
        pid = os.fork()
        if not pid:
            _take(fds[:3], order)
            return True
        for fd in fds[:3]:
            os.close(fd)
        self._told[pid] = fds[3]
        _say(fds[3], pid)
        return False

    def _bury(self) -> None:
        while self._told:
            pid, status = os.waitpid(-1, os.WNOHANG)
            if not pid:
                return
            told = self._told.pop(pid)
            _say(told, os.waitstatus_to_exitcode(status))
            os.close(told)


def _say(fd: int, number: int) -> None:
    # Who is gone is not told.
    with contextlib.suppress(BrokenPipeError):
        os.write(fd, f"{number}\n".encode())


def _take(streams: list[int], order: dict[str, Any]) -> None:
    """The child: its own streams, signals, session, folder and environment."""
    signal.set_wakeup_fd(-1)
    for signalled, handler in _AS_IN_FRONT.items():
        signal.signal(signalled, handler)
    for number, fd in enumerate(streams):
        os.dup2(fd, number)
    os.closerange(3, _HIGHEST_FD)
    if order["session"]:
        os.setsid()
    if order["control"]:
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    os.chdir(order["cwd"])
    os.environ.clear()
    os.environ.update(order["env"])
    sys.argv = ["-m", *order["arguments"]]
    sys.path[0] = os.getcwd()
    lines = 1 if os.isatty(1) else -1
    sys.stdin = sys.__stdin__ = os.fdopen(0, "r", closefd=False)  # type: ignore[misc]
    sys.stdout = sys.__stdout__ = os.fdopen(1, "w", lines, closefd=False)  # type: ignore[misc]
    sys.stderr = sys.__stderr__ = os.fdopen(  # type: ignore[misc]
        2, "w", 1, errors="backslashreplace", closefd=False
    )


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[2]))
    _import_everything()
    if (_order := Host(int(sys.argv[1])).serve()) is not None:
        # As ``python -m`` does it; the end of this module is the end of the process.
        runpy.run_module(_order["module"], run_name="__main__", alter_sys=True)
