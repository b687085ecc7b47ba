"""With the app, and without: does the display delay a step?

    slices   with, without | without, with | with, without | ...    in the same minutes

Rule 1: in both, a hog keeps the other cores busy, and the step process does the same: 5 kHz on
        three axes, nine writes and three readings every 200 us.
Rule 2: the app runs in a terminal of its own that is read as fast as it draws, and redraws at its
        full rate while the motors move.
Rule 3: what counts is the difference within a pair: the machine is another one a minute later.
"""

import contextlib
import fcntl
import os
import pty
import select
import signal
import struct
import tempfile
import termios
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.timing.figures import Row, Section, together
from bench.timing.single import row
from fraese.motor.realtime.cores import core_for_steps
from fraese.motor.realtime.kernel import kernel_facts
from fraese.motor.realtime.measure import hogs
from fraese.motor.realtime.system import PRIORITY
from fraese.spawn import command, environment

_SLICES = 10
_ROWS, _COLUMNS = 40, 120
_PATIENCE_S = 60.0
_START_KEY = b"s"
_LAST_WORD = b"Hold"
_INTERVAL_US = 200.0


class Terminal:
    """The app in a pseudo-terminal that somebody looks at."""

    def __init__(self, seconds: float, folder: Path) -> None:
        self.folder = folder
        arguments = command("bench.timing.appchild", str(seconds), str(folder))
        self._pid, self._fd = pty.fork()
        if self._pid == 0:
            places = {"XDG_STATE_HOME": str(folder), "TERM": "xterm-256color"}
            os.execve(arguments[0], arguments, {**environment(), **places})
        fcntl.ioctl(self._fd, termios.TIOCSWINSZ, struct.pack("HHHH", _ROWS, _COLUMNS, 0, 0))
        self.drawn = 0
        self._seen = b""

    def look(self, seconds: float) -> None:
        """Take what is drawn for so long."""
        until_s = time.monotonic() + seconds
        while (left_s := until_s - time.monotonic()) > 0:
            if select.select([self._fd], [], [], left_s)[0]:
                part = os.read(self._fd, 1 << 16)
                self.drawn += len(part)
                self._seen = (self._seen + part)[-(1 << 16) :]

    def look_until(self, word: bytes) -> None:
        """Until this is drawn."""
        end_s = time.monotonic() + _PATIENCE_S
        while word not in self._seen:
            self.look(0.1)
            assert time.monotonic() < end_s, self._seen[-2000:]

    def press(self, key: bytes) -> None:
        """A key."""
        os.write(self._fd, key)

    def close(self) -> None:
        """Leave by signal."""
        os.kill(self._pid, signal.SIGTERM)
        with contextlib.suppress(OSError):
            self.look(5)
        os.waitpid(self._pid, 0)


def _with_app(seconds: float) -> tuple[Row, float]:
    """One slice; how many bytes a second were drawn."""
    with tempfile.TemporaryDirectory() as folder:
        terminal = Terminal(seconds, Path(folder))
        try:
            terminal.look_until(_LAST_WORD)
            terminal.look(1.0)
            terminal.press(_START_KEY)
            before, began_s = terminal.drawn, time.monotonic()
            samples = Path(folder) / "samples"
            while not samples.exists():
                terminal.look(0.1)
                assert time.monotonic() < began_s + seconds + _PATIENCE_S, "nothing moved"
            drawn = (terminal.drawn - before) / (time.monotonic() - began_s)
            head, _, data = samples.read_bytes().partition(b"\n")
        finally:
            terminal.close()
    late_us = np.frombuffer(data, np.uint32) / 1000.0
    return Row("with", late_us, _INTERVAL_US, (len(late_us) - 1) / float(head)), drawn


@contextlib.contextmanager
def _others_busy() -> Iterator[None]:
    """All cores but the one of the steps have something to do."""
    facts = kernel_facts(PRIORITY)
    cores = [core for core in facts.cores if core != core_for_steps(None, facts)]
    with hogs(len(cores)) as pids:
        for pid, core in zip(pids, cores, strict=True):
            os.sched_setaffinity(pid, {core})
        yield


def paired(seconds: float) -> Section:
    """Alternate slices of so many seconds in all, each kind."""
    slice_s = max(2.0, seconds / _SLICES)
    with_app, without, drawn = [], [], []

    def app() -> None:
        measured, bytes_s = _with_app(slice_s)
        with_app.append(measured)
        drawn.append(bytes_s)

    def alone() -> None:
        without.append(row("without", "smc", slice_s)[0])

    with _others_busy():
        for number in range(_SLICES):
            for measure in (app, alone) if number % 2 == 0 else (alone, app):
                measure()
    rows = [together("with the app", with_app), together("without it", without)]
    said = [
        f"The app drew {np.mean(drawn) / 1000:.1f} kB a second meanwhile.",
        f"With the app minus without, mean of {_SLICES} pairs and its standard error: median"
        f" {_difference(with_app, without, 0)}, p99.9 {_difference(with_app, without, 2)}.",
        f"Slice by slice p99.9 was {_span(with_app)} with the app, {_span(without)} without it.",
    ]
    return Section("app", "With the app, and without it", rows, said)


def _difference(with_app: list[Row], without: list[Row], percentile: int) -> str:
    """Within the pairs."""
    apart = [
        a.percentiles_us()[percentile] - b.percentiles_us()[percentile]
        for a, b in zip(with_app, without, strict=True)
    ]
    error = np.std(apart, ddof=1) / len(apart) ** 0.5
    return (
        f"{np.mean(apart):+.2f} +- {error:.2f} us ({sum(each > 0 for each in apart)} times worse)"
    )


def _span(rows: list[Row]) -> str:
    p999 = sorted(each.percentiles_us()[2] for each in rows)
    return f"{p999[0]:.1f} to {p999[-1]:.1f} us (median {np.median(p999):.1f})"
