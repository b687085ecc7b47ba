"""The fake parallel port from the test's side: built, wired to a process, driven and read.

    port = FakePort(folder)
    port.python("tests.rigs.lpt.play", "smc", "ppdev")     a process that has the port
    port.status = CONTACT                                  while it runs, or before
    port.writes()                                          what it did to the registers

The layout of the shared file is that of ``struct bench`` in ``fakelpt.c``.
"""

import hashlib
import mmap
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple
from uuid import uuid4

from fraese.motor.seams import CONTROL, DATA, STATUS

ROOT: Final = Path(__file__).parents[3]
SOURCE: Final = Path(__file__).with_name("fakelpt.c")
CACHE: Final = ROOT / ".rig-cache"

#: What the inputs read at rest, and with the end switch pressed.
AT_REST: Final = 0xF8
CONTACT: Final = AT_REST & ~0x80

#: Where an errno can be put so that a call is refused.
REFUSALS: Final = ("open parport", "open port", "exclusive", "claim", "access")

_HEADER: Final = struct.Struct("<4B5iIIQ")
_EVENT: Final = struct.Struct("<QIcBBx")
_HEADER_BYTES: Final = 72
_REFUSAL_AT: Final = 4
_CAPACITY_AT: Final = 24
_COUNT: Final = struct.Struct("<Q")
_COUNT_AT: Final = 32
_WIRING_AT: Final = 28
_WIRINGS: Final = {"smc": 1, "stepdir": 2}
_CARRIAGES: Final = struct.Struct("<iiiiii")
_CARRIAGES_AT: Final = 40
_SET_S: Final = struct.Struct("<q")
_SET_S_AT: Final = 64
_FAULT_AT: Final = 3

#: What may be wrong with the switch of the carriages.
FAULTS: Final = ("sound", "glitches", "bounces", "sticks", "late")


class Event(NamedTuple):
    """One thing that a process did to the port.

    ``what``: O open, E exclusive, C claim, L release, X close, R read, W write, ? other request.
    """

    at_ns: int
    pid: int
    what: str
    register: int
    value: int


def missing() -> str:
    """Why the fake port cannot be built here; empty if it can."""
    if sys.platform != "linux":
        return "the fake parallel port needs Linux"
    if shutil.which("gcc") and Path("/usr/include/linux/ppdev.h").exists():
        return ""
    return "gcc is missing: apt-get install --no-install-recommends gcc libc6-dev"


@cache
def library() -> Path:
    """The shared object, built once for each state of its source."""
    digest = hashlib.sha256(SOURCE.read_bytes()).hexdigest()[:12]
    folder = CACHE
    if " " in str(folder) or ":" in str(folder):
        # LD_PRELOAD takes both for the end of a name.
        folder = Path(tempfile.gettempdir()) / f"fraese-rig-{os.getuid()}"
    folder.mkdir(exist_ok=True)
    built = folder / f"fakelpt-{digest}.so"
    if not built.exists():
        fresh = built.with_suffix(f".{uuid4().hex}")
        command = ["gcc", "-shared", "-fPIC", "-O2", "-Wall", "-Wextra", "-Werror"]
        subprocess.run([*command, "-o", str(fresh), str(SOURCE)], check=True)
        fresh.replace(built)
    return built


class FakePort:
    """A parallel port in a file.

    Args:
        folder: where the file is made.
        capacity: accesses that can be logged.
    """

    def __init__(self, folder: Path, capacity: int = 500_000) -> None:
        self.path = folder / "fakelpt.bin"
        self._capacity = capacity
        with self.path.open("w+b") as file:
            file.truncate(_HEADER_BYTES + _EVENT.size * capacity)
            # As the kernel's drivers leave control: DB25 pins 1, 14 and 16 high, 17 low.
            file.write(_HEADER.pack(0, AT_REST, 0x0C, 0, *[0] * len(REFUSALS), capacity, 0, 0))
            file.flush()
            self._map = mmap.mmap(file.fileno(), 0)

    # --- the lines -------------------------------------------------------------------------------

    @property
    def status(self) -> int:
        """The status register, as the machine drives it."""
        return self._map[STATUS]

    @status.setter
    def status(self, value: int) -> None:
        self._map[STATUS] = value

    @property
    def data(self) -> int:
        """What stands on DB25 pins 2 to 9."""
        return self._map[DATA]

    @property
    def control(self) -> int:
        """The control register as it stands, with the kernel's bits."""
        return self._map[CONTROL]

    @control.setter
    def control(self, value: int) -> None:
        self._map[CONTROL] = value

    def press(self) -> None:
        """The end switch makes contact."""
        self.status = CONTACT

    def let_go(self) -> None:
        """The end switch opens."""
        self.status = AT_REST

    def spoil_switch(self, fault: str) -> None:
        """From now on the switch of the carriages is a bad one, or a sound one (see ``FAULTS``)."""
        self._map[_FAULT_AT] = FAULTS.index(fault)

    def set_clock(self, seconds: int) -> None:
        """The clock of the day is set, for the processes that have this port."""
        _SET_S.pack_into(self._map, _SET_S_AT, seconds)

    def refuse(self, what: str, errno: int) -> None:
        """From now on, refuse a kind of call (see ``REFUSALS``); 0: no more."""
        at = _REFUSAL_AT + 4 * REFUSALS.index(what)
        self._map[at : at + 4] = struct.pack("<i", errno)

    def mount(self, wiring: str, travel_steps: Sequence[int]) -> None:
        """Put a machine on the port: three carriages in the middle, a switch at each end.

        Args:
            wiring: "smc" or "stepdir".
            travel_steps: from switch to switch, per motor.
        """
        self._map[_WIRING_AT] = _WIRINGS[wiring]
        values = [value for travel in travel_steps for value in (travel // 2, travel)]
        _CARRIAGES.pack_into(self._map, _CARRIAGES_AT, *values)

    def carriages_steps(self) -> tuple[int, ...]:
        """Where they stand, from the switch at the lower end."""
        return _CARRIAGES.unpack_from(self._map, _CARRIAGES_AT)[::2]

    # --- the log ---------------------------------------------------------------------------------

    def count(self) -> int:
        """How much has happened so far."""
        return int(_COUNT.unpack_from(self._map, _COUNT_AT)[0])

    def events(self, since: int = 0) -> list[Event]:
        """What happened, from the given count on."""
        count = self.count()
        assert count <= self._capacity, f"{count} events, room for {self._capacity}"
        start, end = (_HEADER_BYTES + _EVENT.size * n for n in (since, count))
        return [
            Event(at_ns, pid, what.decode(), register, value)
            for at_ns, pid, what, register, value in _EVENT.iter_unpack(self._map[start:end])
        ]

    def writes(self, since: int = 0) -> list[tuple[int, int]]:
        """Registers and values written, control without the kernel's bits."""
        return writes(self.events(since))

    # --- processes -------------------------------------------------------------------------------

    def environment(self) -> dict[str, str]:
        """For a process that is to have this port."""
        return {**os.environ, "LD_PRELOAD": str(library()), "FAKELPT": str(self.path)}

    def start(self, *arguments: str, popen: Any = subprocess.Popen) -> subprocess.Popen[str]:
        """Start a Python module that has the port; its output can be read as text."""
        process: subprocess.Popen[str] = popen(
            [sys.executable, "-m", *arguments],
            env=self.environment(),
            cwd=ROOT,
            text=True,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        return process

    def python(self, *arguments: str, timeout_s: float = 60.0) -> str:
        """Run a Python module that has the port, to its end; what it printed."""
        process = self.start(*arguments)
        try:
            printed, _ = process.communicate(timeout=timeout_s)
        finally:
            process.kill()
        assert process.returncode == 0, f"{arguments} ended with {process.returncode}"
        return printed

    def wait_for(self, what: Callable[[], bool], timeout_s: float = 20.0) -> None:
        """Wait until something can be seen at the port."""
        end_s = time.monotonic() + timeout_s
        while not what():
            assert time.monotonic() < end_s, "it did not happen in time"
            time.sleep(0.001)


def writes(events: Iterable[Event]) -> list[tuple[int, int]]:
    """Registers and values written, control without the kernel's bits."""
    return [
        (e.register, e.value & 0x0F if e.register == CONTROL else e.value)
        for e in events
        if e.what == "W"
    ]


def after_claim(events: list[Event]) -> list[Event]:
    """What follows the opening: for ppdev the claim, for /dev/port the look at its registers."""
    claims = [i for i, event in enumerate(events) if event.what == "C"]
    return events[claims[0] + 1 if claims else 4 :]
