"""A simulated ATmega328P behind a serial port, in a process of its own.

    with SimHost(image, folder) as host:
        port = serial.Serial(host.port, 250_000, timeout=1)
        ...
        host.accesses()                  # what a parallel port would have been told since

The program is `simhost.c`; `simoptions.h` says what each option does. Simulated time follows the
wall clock, so what is asserted here is order and counts, never single cycles: for those take `Avr`.
"""

import mmap
import os
import signal
import struct
import subprocess
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from rigs.avr.binding import EVENT, Events
from rigs.avr.board import UNO, Accesses, Board, Decoder
from rigs.avr.build import RigError, host_program

#: `struct shared` of simhost.c: driven and level of B, C, D; hold; client; cycle; mark; limit.
SHARED = struct.Struct("<3s3sBBQQQQ")
_DRIVEN, _LEVEL, _HOLD, _CLIENT, _CYCLE, _MARK, _LIMIT = 0, 3, 6, 7, 8, 16, 32
START_TIMEOUT_S = 10.0
END_TIMEOUT_S = 5.0
PORTS = "BCD"


def prefer(number: int) -> None:
    """No other program delays metal: a process or thread that plays it goes first, if it may.

    Args:
        number: of the process or thread.
    """
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, number, -10)


class SimHost:
    """A running `simhost`. Start it from the main thread: it ends with the thread that started it.

    Args:
        elf: The firmware.
        folder: Where the link to the pty, the log and the shared file are put.
        options: Further options of simhost, such as ("--stall-ms", "5").
        board: The wiring.

    Raises:
        RigError: The program cannot be built, or does not start.
    """

    def __init__(
        self, elf: Path, folder: Path, options: Sequence[str] = (), board: Board = UNO
    ) -> None:
        self.port = str(folder / "ttySIM")
        self._board = board
        self._decoder = Decoder(board)
        self._log, self._log_read = folder / "simhost.log", 0
        self._report: str | None = None
        shared = folder / "simhost.shared"
        shared.write_bytes(bytes(SHARED.size))
        with shared.open("r+b") as file:
            self._shared = mmap.mmap(file.fileno(), SHARED.size)
        files = ["--link", self.port, "--log", str(self._log), "--shared", str(shared)]
        command = [str(host_program()), str(elf), *files, *options]
        self._process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        prefer(self._process.pid)
        self._wait_for(Path(self.port))

    def _wait_for(self, link: Path) -> None:
        deadline_s = time.monotonic() + START_TIMEOUT_S
        while not link.is_symlink():
            if self._process.poll() is not None or time.monotonic() > deadline_s:
                raise RigError(f"simhost did not start: {self.stop()}")
            time.sleep(0.005)

    def __enter__(self) -> "SimHost":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> str:
        """Ends it, if it still runs; gives its report, one line with all counts."""
        if self._report is None:
            self._process.terminate()
            self._report = self._last_words()
        return self._report

    def _last_words(self) -> str:
        try:
            _, report = self._process.communicate(timeout=END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            _, report = self._process.communicate()
        return report

    @property
    def pid(self) -> int:
        """Process id, for SIGSTOP and the like."""
        return self._process.pid

    # -- the serial line

    def unplug(self) -> None:
        """Pulls the USB plug: the port and its link vanish. The AVR runs on."""
        self._process.send_signal(signal.SIGUSR1)
        self._until(lambda: not Path(self.port).is_symlink(), "the port did not vanish")

    def plug_in(self) -> None:
        """Puts the plug back: a new pty under the same link."""
        self._process.send_signal(signal.SIGUSR2)
        self._until(lambda: Path(self.port).is_symlink(), "the port did not come back")

    @property
    def has_client(self) -> bool:
        """Somebody has the serial port open."""
        return self._shared[_CLIENT] != 0

    # -- time and pins

    @property
    def cycle(self) -> int:
        """Simulated cycles since power-on, to the last 100 us."""
        (cycle,) = struct.unpack_from("<Q", self._shared, _CYCLE)
        return int(cycle)

    def await_mark(self) -> None:
        """Wants to know when the byte of ``--mark`` comes next."""
        struct.pack_into("<Q", self._shared, _MARK, 0)

    @property
    def mark(self) -> tuple[int, float] | None:
        """Cycle, and `time.monotonic()`, at which it came; None: not yet."""
        cycle, wall_ns = struct.unpack_from("<QQ", self._shared, _MARK)
        return (int(cycle), wall_ns / 1e9) if cycle else None

    def hold(self, still: bool) -> None:
        """Stops simulated time, or lets it go on."""
        self._shared[_HOLD] = int(still)

    def wait_at(self, cycle: int) -> None:
        """Lets simulated time go on to that cycle and stand still there; 0: it goes on for ever."""
        struct.pack_into("<Q", self._shared, _LIMIT, cycle)

    def set_pin(self, pin: str, level: bool) -> None:
        """Drives an input pin like "C0" within the next 100 us of simulated time."""
        index, bit = PORTS.index(pin[0]), 1 << int(pin[1])
        before = self._shared[_LEVEL + index]
        self._shared[_LEVEL + index] = before | bit if level else before & ~bit
        self._shared[_DRIVEN + index] |= bit

    def set_status(self, register: int) -> None:
        """Drives the five status lines as a parallel port's register would read (bits 7 to 3)."""
        for pin, level in self._board.status_pins(register):
            self.set_pin(pin, level)

    # -- what was seen

    def events(self) -> Events:
        """The log's new records since the last call."""
        with self._log.open("rb") as file:
            file.seek(self._log_read)
            data = file.read()
        whole = len(data) - len(data) % EVENT.itemsize
        self._log_read += whole
        return np.frombuffer(data[:whole], EVENT)

    def accesses(self) -> Accesses:
        """What a parallel port would have been told since the last call.

        Complete up to `cycle` at the time of the call.
        """
        until_cycle = self.cycle
        return self._decoder.decode(self.events(), until_cycle)

    def _until(self, done: Callable[[], bool], problem: str) -> None:
        deadline_s = time.monotonic() + END_TIMEOUT_S
        while not done():
            if time.monotonic() > deadline_s:
                raise RigError(f"simhost: {problem}")
            time.sleep(0.002)
