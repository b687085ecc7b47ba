"""Processes that begin at once: like ``subprocess.Popen``, without the time of Python's imports.

Most of an attempt's time was the start of two or three Pythons, and no fault is injected there. The
step process is started by its program as always.
"""

import contextlib
import json
import os
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import IO, Any, Final

from tests.rigs.lpt.fakeport import library, missing

_ROOT: Final = Path(__file__).parents[2]
_LOOK_S: Final = 0.002


@cache
def _host() -> socket.socket:
    """Ask it for processes; it ends with this one."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    preload = {} if missing() else {"LD_PRELOAD": str(library())}
    subprocess.Popen(
        [sys.executable, "-m", "bench.campaign.warmhost", str(theirs.fileno())],
        pass_fds=(theirs.fileno(),),
        cwd=_ROOT,
        env={**os.environ, **preload},
        stdin=subprocess.DEVNULL,
    )
    theirs.close()
    return ours


_lock: Final = threading.Lock()


class Warm:
    """What is used of ``subprocess.Popen``.

    Args:
        command: a Python, -m, a module, its arguments.
        stdin, stdout, stderr: as there; files, or PIPE, or DEVNULL.
        cwd: where it is started.
        env: its environment.
        text: its streams are read as text.
        start_new_session: its session is its own.
        preexec_fn: it takes control of its terminal; no other use is known here.

    Attributes:
        pid: its number.
        returncode: as there; None while it runs.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        stdin: int | None = None,
        stdout: int | None = None,
        stderr: int | None = None,
        cwd: Path = _ROOT,
        env: Mapping[str, str] | None = None,
        text: bool = False,
        start_new_session: bool = False,
        preexec_fn: Callable[[], None] | None = None,
    ) -> None:
        _, dash_m, module, *arguments = command
        assert dash_m == "-m", command
        self.returncode: int | None = None
        ours, told = os.pipe()
        ends = [_end(stream, number) for number, stream in enumerate((stdin, stdout, stderr))]
        order = {
            "module": module,
            "arguments": arguments,
            "cwd": str(cwd),
            "env": dict(os.environ if env is None else env),
            "session": start_new_session,
            "control": preexec_fn is not None,
        }
        with _lock:
            fds = [*(theirs for theirs, _ in ends), told]
            socket.send_fds(_host(), [json.dumps(order).encode()], fds)
        os.close(told)
        for given, (theirs, _) in zip((stdin, stdout, stderr), ends, strict=True):
            if given is None or given < 0:
                os.close(theirs)
        self._told = os.fdopen(ours, "r")
        self.pid = int(self._told.readline())
        self.stdin, self.stdout, self.stderr = (
            None if near is None else os.fdopen(near, mode if text else mode + "b")
            for (_, near), mode in zip(ends, ("w", "r", "r"), strict=True)
        )
        # Of ``communicate``, which is subprocess's.
        self.args = command

    def poll(self) -> int | None:
        """How it ended; None: it runs."""
        if self.returncode is None and select.select([self._told], [], [], 0)[0]:
            said = self._told.readline()
            self._told.close()
            assert said, "the host of warm processes has died"
            self.returncode = int(said)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """How it ended, when it has."""
        until_s = time.monotonic() + (1e9 if timeout is None else timeout)
        while (code := self.poll()) is None:
            if time.monotonic() > until_s:
                raise subprocess.TimeoutExpired(self.args, timeout or 0)
            time.sleep(_LOOK_S)
        return code

    def send_signal(self, number: int) -> None:
        """While it runs."""
        if self.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def terminate(self) -> None:
        """In order."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """At once."""
        self.send_signal(signal.SIGKILL)

    def communicate(self, timeout: float | None = None) -> tuple[Any, Any]:
        """What it said, and its end."""
        if self.stdin is not None:
            with contextlib.suppress(OSError):
                self.stdin.close()
        said: dict[int, Any] = {}
        readers = [
            threading.Thread(target=_read, args=(number, stream, said), daemon=True)
            for number, stream in enumerate((self.stdout, self.stderr))
            if stream is not None and not stream.closed
        ]
        for reader in readers:
            reader.start()
        self.wait(timeout)
        for reader in readers:
            reader.join(timeout)
        return said.get(0), said.get(1)

    def __enter__(self) -> "Warm":
        return self

    def __exit__(self, *_: object) -> None:
        for stream in (self.stdin, self.stdout, self.stderr):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()
        self.wait()


def _read(number: int, stream: IO[Any], said: dict[int, Any]) -> None:
    # Who waits again after a wait that was too long finds it read.
    with contextlib.suppress(ValueError), stream:
        said[number] = stream.read()


def _end(stream: int | None, number: int) -> tuple[int, int | None]:
    """The child's end, and ours if there is one."""
    if stream is None:
        return os.dup(number), None
    if stream == subprocess.DEVNULL:
        return os.open(os.devnull, os.O_RDWR), None
    if stream != subprocess.PIPE:
        return stream, None
    reads, writes = os.pipe()
    return (reads, writes) if number == 0 else (writes, reads)
