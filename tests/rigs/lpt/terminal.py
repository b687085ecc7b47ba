"""A program in a pseudo-terminal: keys in, what it draws out."""

import fcntl
import os
import pty
import select
import struct
import subprocess
import termios
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

_ROWS: Final = 40
_COLUMNS: Final = 120
_PATIENCE_S: Final = 20.0

#: What a terminal sends for these keys.
KEYS: Final = {"right": b"\x1b[C", "left": b"\x1b[D", "escape": b"\x1b", "enter": b"\r"}


class Terminal:
    """A terminal with one program in it.

    Args:
        command: the program and its arguments.
        folder: where it is started.
        environment: of the program.
        popen: what starts it.

    Attributes:
        process: the program.
    """

    def __init__(
        self,
        command: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        popen: Any = subprocess.Popen,
    ) -> None:
        self._near, far = pty.openpty()
        fcntl.ioctl(far, termios.TIOCSWINSZ, struct.pack("HHHH", _ROWS, _COLUMNS, 0, 0))
        self.process: subprocess.Popen[bytes] = popen(
            command,
            stdin=far,
            stdout=far,
            stderr=far,
            cwd=folder,
            env={**environment, "TERM": "xterm-256color"},
            start_new_session=True,
        )
        os.close(far)
        self._drawn = b""

    def press(self, *keys: str) -> None:
        """Press keys, by name or as they are written."""
        for key in keys:
            os.write(self._near, KEYS.get(key, key.encode()))

    def wait_for(self, text: str) -> None:
        """Until this was drawn, after what was waited for before."""
        until_s = time.monotonic() + _PATIENCE_S
        while text.encode() not in self._drawn:
            left_s = until_s - time.monotonic()
            assert self._read(left_s), f"{text!r} was not drawn; last: {self._drawn[-2000:]!r}"
        self._drawn = self._drawn.partition(text.encode())[2]

    def wait_for_end(self) -> int:
        """Until the program has ended; its exit code."""
        until_s = time.monotonic() + _PATIENCE_S
        while self.process.poll() is None:
            assert time.monotonic() < until_s, "the program does not end"
            self._read(0.05)
        return self.process.returncode

    def close(self) -> None:
        """The program, if it still runs, and the terminal are gone."""
        self.process.kill()
        self.process.wait()
        os.close(self._near)

    def _read(self, timeout_s: float) -> bool:
        if not select.select([self._near], [], [], max(timeout_s, 0))[0]:
            return False
        try:
            self._drawn += os.read(self._near, 65536)
        except OSError:  # the program has closed its side
            return False
        return True
