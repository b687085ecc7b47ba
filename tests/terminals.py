"""A program in a terminal of which nobody reads more than he wants to."""

import contextlib
import fcntl
import os
import pty
import select
import signal
import struct
import subprocess
import termios
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

PATIENCE_S: Final = 30.0


class Pty:
    """A program in a pseudo-terminal that controls it, as a shell starts it.

    Args:
        command: the program and its arguments.
        folder: where it is started.
        environment: of the program.
        size: rows and columns.
        output: what becomes standard output, and error; by default the terminal.
        popen: what starts it.

    Attributes:
        process: the program.
        near: the side of the person.
    """

    def __init__(
        self,
        command: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        *,
        size: tuple[int, int] = (24, 80),
        output: tuple[int | None, int | None] = (None, None),
        popen: Any = subprocess.Popen,
    ) -> None:
        self.near, far = pty.openpty()
        self.resize(*size)
        self.process: subprocess.Popen[bytes] = popen(
            command,
            stdin=far,
            stdout=far if output[0] is None else output[0],
            stderr=far if output[1] is None else output[1],
            cwd=folder,
            env=environment,
            start_new_session=True,
            preexec_fn=_take_control,
        )
        os.close(far)
        self.drawn = b""

    def resize(self, rows: int, columns: int) -> None:
        """Another size; the program is told."""
        fcntl.ioctl(self.near, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def type(self, keys: bytes) -> None:
        """What a keyboard sends."""
        os.write(self.near, keys)

    def read(self, timeout_s: float) -> bool:
        """What was drawn, if anything is within that time."""
        if not select.select([self.near], [], [], max(timeout_s, 0))[0]:
            return False
        try:
            self.drawn += os.read(self.near, 65536)
        except OSError:  # the program has closed its side
            return False
        return True

    def read_until(self, wanted: bytes) -> None:
        """Until this was drawn, after what was waited for before."""
        until_s = time.monotonic() + PATIENCE_S
        while wanted not in self.drawn:
            assert self.read(until_s - time.monotonic()), (wanted, self.drawn[-2000:])
        self.drawn = self.drawn.partition(wanted)[2]

    def end(self, *, reading: bool, within_s: float = PATIENCE_S) -> int:
        """Wait for the end of the program; its exit code.

        Args:
            reading: somebody reads meanwhile.
            within_s: how long it may take.
        """
        until_s = time.monotonic() + within_s
        while self.process.poll() is None:
            assert time.monotonic() < until_s, "the program does not end"
            if reading:
                self.read(0.02)
            else:
                time.sleep(0.01)
        if reading:
            while self.read(0):
                pass
        return self.process.returncode

    def hang_up(self) -> None:
        """The window is closed; the system sends SIGHUP."""
        os.close(self.near)
        self.near = -1

    def close(self) -> None:
        """The program, if it still runs, and the terminal are gone."""
        with contextlib.suppress(ProcessLookupError):
            self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        if self.near >= 0:
            os.close(self.near)


def _take_control() -> None:
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
