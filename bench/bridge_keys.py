"""From a key to braking, through everything: terminal, app, driver, serial port, firmware.

    os.write(pty, ^C) -> Textual -> worker -> BridgeDriver.brake -> pty -> simhost: firmware
          |                                                      |                 |
          '------------- wall ---------------- mark of the brake byte --- log of the data lines

The app is the program that people start, in a pseudo-terminal of 80x24 with a jog running; the
microcontroller is `rigs/avr/simhost`.

Rule 1: what is measured ends with the first step that comes later than its plan.
Rule 2: until the brake byte comes out of the serial port the wall counts, from then on the chip's
        cycles: the simulation is slower than a chip where this machine is slow.
Rule 3: other programs on this machine make the app late, not the bridge. With the right to it,
        `nice -n -20` before the command shows what a quiet machine does.
"""

import os
import pty
import random
import select
import signal
import statistics
import struct
import sys
import termios
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from fcntl import ioctl
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

from fraese.motor.bridge import constants as c
from fraese.motor.seams import DATA
from rigs.avr.host import SimHost
from tests.bridge.device import image

#: Both are the stop key. After a lone Escape a terminal's user waits: more could follow it.
CTRL_C: Final = b"\x03"
ESCAPE: Final = b"\x1b"
_RIGHT, _LEFT, _WIDEST = b"\x1b[C", b"\x1b[D", b"5"
#: All inputs open.
_OPEN: Final = 0xF8
#: The last word of the first picture.
_LAST_WORD: Final = b"Hold"
_START_S: Final = 30.0
_WANTED_MS: Final = 10.0
#: A jog has its full rate after the ramp; then the key comes.
_RAMP_S: Final = 0.3
_JOG_S: Final = 2.0
_LOOK_S: Final = 0.02
_PLATEAU_S: Final = 0.02
_SEEN_S: Final = 0.6
#: Braking from full rate, and the app's last words on it.
_REST_S: Final = 0.8
_CYCLES_PER_S: Final = 16_000_000

_SETTINGS: Final = """
[port]
kind = "bridge"
device = "{device}"
[axes.x]
steps_per_rev = 1000
pitch_mm = {pitch_mm}
travel_mm = 300
max_rate_hz = {rate_hz}
start_rate_hz = 800
acceleration_hz_s = {acceleration_hz_s}
"""


class Latency(NamedTuple):
    """One try.

    Attributes:
        host_ms: from the write of the key until the brake byte comes out of the serial port.
        chip_ms: from there to the first step that comes late.
    """

    host_ms: float
    chip_ms: float

    @property
    def whole_ms(self) -> float:
        """Both."""
        return self.host_ms + self.chip_ms


class App:
    """The program in a terminal that is always read."""

    def __init__(self, folder: Path, config: Path) -> None:
        words = ["-m", "fraese", "--config", str(config), "--state", str(folder / "state")]
        self.pid, self.input = pty.fork()
        if self.pid == 0:
            os.environ["TERM"] = "xterm-256color"
            os.execv(sys.executable, [sys.executable, *words])
        ioctl(self.input, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        self._drawn = threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        tail = b""
        while select.select([self.input], [], [])[0]:
            try:
                tail = tail[-len(_LAST_WORD) :] + os.read(self.input, 65536)
            except OSError:  # the app has ended
                return
            if _LAST_WORD in tail:
                self._drawn.set()

    def await_picture(self) -> None:
        """Until it is there."""
        if not self._drawn.wait(_START_S):
            raise SystemExit("the app draws nothing")
        time.sleep(1)

    def press(self, key: bytes) -> None:
        """A person's finger."""
        os.write(self.input, key)

    def close(self) -> None:
        """Leave by signal."""
        os.kill(self.pid, signal.SIGTERM)
        os.waitpid(self.pid, 0)
        self._thread.join(2)


class Bench:
    """An app with a mill of one axis that matters, jogged to and fro.

    Args:
        app: with its picture drawn.
        host: the chip.
        rate_hz: of the jog.
    """

    def __init__(self, app: App, host: SimHost, rate_hz: int) -> None:
        self._app = app
        self._host = host
        self._full_cycles = _CYCLES_PER_S // rate_hz
        self._chance = random.Random(3)
        self._ways = 0

    def press_stop(self, key: bytes) -> Latency:
        """Jog, press the stop key at full rate, and see what came of it."""
        self._app.press(_LEFT if self._ways % 2 else _RIGHT)
        self._ways += 1
        self._await_full_rate()
        time.sleep(self._chance.random() * 0.2)
        self._steps()
        time.sleep(_PLATEAU_S)
        since_cycle = self._host.cycle
        self._host.await_mark()
        since_s = time.monotonic()
        self._app.press(key)
        time.sleep(_SEEN_S)
        late_cycle, mark = self._first_late(since_cycle), self._host.mark
        time.sleep(_REST_S)
        if mark is None:
            raise SystemExit("the motor braked, but not by the key")
        mark_cycle, mark_s = mark
        return Latency((mark_s - since_s) * 1000, (late_cycle - mark_cycle) / _CYCLES_PER_S * 1000)

    def _steps(self) -> list[int]:
        """Cycles of the motor's steps since the last call."""
        accesses = self._host.accesses()
        chosen = accesses[(accesses["register"] == DATA) & (accesses["value"] >> 6 == 0)]
        return [int(cycle) for cycle in chosen["cycle"]]

    def _await_full_rate(self) -> None:
        until_s = time.monotonic() + _START_S
        while time.monotonic() < until_s:
            time.sleep(_LOOK_S)
            gaps = _gaps(self._steps())
            if gaps and max(gaps) <= self._full_cycles + 1:
                return
        raise SystemExit("the jog does not reach its rate")

    def _first_late(self, since_cycle: int) -> int:
        """Cycle of the first step that comes later than every one of the plateau before the key."""
        steps = self._steps()
        planned = _gaps([cycle for cycle in steps if cycle < since_cycle])
        if not planned or max(planned) > self._full_cycles + 1:
            raise SystemExit("the jog did not run at its full rate when the key was pressed")
        for before, cycle in pairwise(steps):
            if cycle >= since_cycle and cycle - before > max(planned):
                return cycle
        raise SystemExit("the key had no effect")


def _gaps(steps: list[int]) -> list[int]:
    return [b - a for a, b in pairwise(steps)]


@contextmanager
def bench(rate_hz: int) -> Iterator[Bench]:
    """Everything started, at rest."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        config = folder / "fraese.toml"
        with SimHost(image(), folder, ("--mark", str(c.URGENT_BRAKE))) as host:
            host.set_status(_OPEN)
            config.write_text(
                _SETTINGS.format(
                    device=host.port,
                    rate_hz=rate_hz,
                    # The widest jog takes two seconds, its ramps a quarter each.
                    pitch_mm=1000 * 10 / (rate_hz * _JOG_S),
                    acceleration_hz_s=round(rate_hz / _RAMP_S),
                )
            )
            app = App(folder, config)
            try:
                app.await_picture()
                app.press(_WIDEST)
                time.sleep(0.3)
                yield Bench(app, host, rate_hz)
            finally:
                app.close()


def measure(rate_hz: int, key: bytes, tries: int) -> list[Latency]:
    """So many tries in one session."""
    with bench(rate_hz) as made:
        made.press_stop(key)  # the first one imports this and that
        return [made.press_stop(key) for _ in range(tries)]


def in_words(tries: list[Latency]) -> str:
    """The figures."""
    whole_ms = [each.whole_ms for each in tries]
    prompt = sum(ms <= _WANTED_MS for ms in whole_ms)
    return (
        f"median {statistics.median(whole_ms):.1f} ms, max {max(whole_ms):.1f} ms,"
        f" {prompt} within {_WANTED_MS:g} ms"
        f" (of it from the brake byte on {statistics.median(each.chip_ms for each in tries):.1f},"
        f" at most {max(each.chip_ms for each in tries):.1f} ms)"
    )
