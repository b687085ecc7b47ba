"""A folder in which a person types commands at a machine: on a fake port, or simulated.

    shop = Shop(folder, "ppdev", "smc")            a machine on the fake port
    answer = shop.command("home")                  a process of its own, as a person starts it
    with shop.begun("run", "long.ngc") as command: it moves now

    SimulatedShop(folder, "smc")                   the same machine and commands, simulated

Rule 1: what is typed is the same in both, and the configuration, but for ``port.kind``.
Rule 2: all of a job is in the driver's queue before it begins: a busy computer does not slow the
        motors down, and so the bytes are the same every time.
"""

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import pytest
from typer.testing import CliRunner

from fraese.assembly import drivers
from fraese.cli import app
from fraese.journal import Journal
from fraese.motor.core import MotorCore
from fraese.motor.ports.recorder import Recorder
from tests.rigs.lpt.fakeport import FakePort, after_claim, writes

#: Steps of an axis in 1 mm, as configured by default.
STEPS_PER_MM: Final = 200
#: From switch to switch, mm: short for commands that run to their end.
SHORT_MM: Final = 6
LONG_MM: Final = 400
#: A machine moves when its carriages have come so far.
UNDER_WAY_STEPS: Final = 300

_CARDS: Final = {"smc": "smc1500", "x4step": "stepdir"}
_CONFIG: Final = """
[card]
kind = "{card}"
[port]
kind = "{port}"
[axes]
x.travel_mm = {travel}
y.travel_mm = {travel}
z.travel_mm = {travel}
[homing]
pull_off_mm = 0.5
slow_mm_min = 300
[outputs]
spindle = {{ pin = 14, active_high = false }}
[run]
spin_up_s = 0.1
lead_s = {lead}
"""

#: Straight lines, an arc, a dwell, the spindle.
PART: Final = """G21 G90
M3 S1000
G1 X3 Y2 F1200
G2 X3 Y3 I0 J0.5
G4 P0.05
M5
G1 X1 Y1 Z-1
M2
"""
#: Back and forth for minutes.
LONG: Final = "G21 G91 M3\n" + "G1 X80 Y80 F900\nG1 X-80 Y-80\n" * 20 + "M2\n"


def _furnish(folder: Path, port: str, wiring: str, travel_mm: int, lead_s: float) -> None:
    """The files of a shop."""
    folder.mkdir(exist_ok=True)
    text = _CONFIG.format(card=_CARDS[wiring], port=port, travel=travel_mm, lead=lead_s)
    (folder / "fraese.toml").write_text(text)
    (folder / "part.ngc").write_text(PART)
    (folder / "long.ngc").write_text(LONG)


#: What only somebody at the machine can know: nothing on metal.
SEEN: Final = ("carriages_mm", "lost_steps", "lost_why")


@dataclass(frozen=True)
class Answer:
    """What a command left.

    Attributes:
        code: exit code.
        said: its standard output.
        noted: its standard error.
        writes: to the registers, from the time when the port was open.
    """

    code: int
    said: str
    noted: str
    writes: Sequence[tuple[int, int]] = ()

    @property
    def result(self) -> dict[str, Any]:
        """The one object of ``--json``."""
        values = json.loads(self.said.splitlines()[-1])
        assert isinstance(values, dict)
        return values

    @property
    def facts(self) -> dict[str, Any]:
        """The result without what depends on the computer, and what only a person can see."""
        left_out = ("duration_s", "late_ticks", "message", *SEEN)
        return {name: value for name, value in self.result.items() if name not in left_out}


class Shop:
    """A machine on a fake port.

    Args:
        folder: for its files.
        port: "ppdev" or "devport".
        wiring: "smc" or "x4step".
        travel_mm: of each axis.
        lead_s: motion that is kept in the driver's queue.
        popen: what starts a process.
        capacity: accesses that can be logged.

    Attributes:
        fake: the port, with a machine on it.
    """

    def __init__(
        self,
        folder: Path,
        port: str,
        wiring: str = "smc",
        travel_mm: int = LONG_MM,
        lead_s: float = 0.3,
        popen: Any = subprocess.Popen,
        capacity: int = 500_000,
    ) -> None:
        self._popen = popen
        _furnish(folder, port, wiring, travel_mm, lead_s)
        self.folder = folder
        self.fake = FakePort(folder, capacity)
        travel_steps = travel_mm * STEPS_PER_MM
        self.fake.mount("smc" if wiring == "smc" else "stepdir", [travel_steps] * 3)
        self._middle_steps = travel_steps // 2

    @property
    def environment(self) -> dict[str, str]:
        """For a process here: nothing of the person who runs the tests."""
        return {
            **self.fake.environment(),
            "XDG_CONFIG_HOME": str(self.folder / "config"),
            "XDG_STATE_HOME": str(self.folder / "user-state"),
        }

    def start(self, *words: object) -> "subprocess.Popen[str]":
        """Type a command."""
        process: subprocess.Popen[str] = self._popen(
            [sys.executable, "-m", "fraese", *map(str, words)],
            env=self.environment,
            cwd=self.folder,
            text=True,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        return process

    def command(self, *words: object) -> Answer:
        """Type a command and wait for its end."""
        seen = self.fake.count()
        process = self.start(*words)
        try:
            return self.end(process, seen)
        finally:
            process.kill()

    @contextmanager
    def begun(self, *words: object) -> "Iterator[subprocess.Popen[str]]":
        """Type a command and wait until the machine moves."""
        process = self.start(*words)
        try:
            self.fake.wait_for(lambda: self.is_under_way() or process.poll() is not None)
            assert process.poll() is None, process.communicate()
            yield process
        finally:
            process.kill()
            process.communicate()

    def end(self, process: "subprocess.Popen[str]", seen: int = 0) -> Answer:
        """Wait for the end of a command.

        Args:
            process: the command.
            seen: what had happened at the port before it.
        """
        said, noted = process.communicate(timeout=30)
        assert "Traceback" not in noted, noted
        return Answer(process.returncode, said, noted, writes(after_claim(self.fake.events(seen))))

    def travelled_steps(self) -> tuple[int, ...]:
        """Where the carriages are, from where they stood at first."""
        return tuple(at - self._middle_steps for at in self.fake.carriages_steps())

    def is_under_way(self) -> bool:
        """It has moved a good deal."""
        return max(map(abs, self.travelled_steps())) > UNDER_WAY_STEPS

    def kept(self) -> dict[str, Any]:
        """The record in force; nothing else lies in the folder."""
        (path,) = (self.folder / "user-state/fraese").glob("*.journal")
        found = Journal(path).read()
        assert found is not None
        values = json.loads(found.payload)
        assert isinstance(values, dict)
        return values


class SimulatedShop:
    """The same machine, simulated; commands run in this process."""

    def __init__(self, folder: Path, wiring: str, travel_mm: int, lead_s: float) -> None:
        _furnish(folder, "simulation", wiring, travel_mm, lead_s)
        self._folder = folder

    def command(self, *words: object) -> Answer:
        """Type a command and wait for its end."""
        recorders: list[Recorder] = []
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(drivers, "MotorCore", partial(_recorded_core, recorders))
            for name in ("config", "state"):
                patch.setenv(f"XDG_{name.upper()}_HOME", str(self._folder / f"user-{name}"))
            patch.chdir(self._folder)
            result = CliRunner().invoke(app, [*map(str, words)])
        written = [write for recorder in recorders for write in recorder.writes()]
        return Answer(result.exit_code, result.stdout, result.stderr, written)


def _recorded_core(
    recorders: list[Recorder], port: Any, card: Any, clock: Any, **options: Any
) -> MotorCore:
    recorder = Recorder(port, clock)
    recorders.append(recorder)
    return MotorCore(recorder, card, clock, **options)


def children_of(pid: int) -> list[int]:
    """What a process has started; whichever of its threads it was."""
    threads = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for thread in threads for child in thread.read_text().split()]


def child_of(pid: int) -> int:
    """The step process of a command."""
    children = children_of(pid)
    assert len(children) == 1, children
    return children[0]


def is_alive(pid: int) -> bool:
    """A process still runs."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True
