"""A whole machine to try things on, and what a person would do at it.

Tests speak physics: jog, home, press a switch, look where the carriage is.
"""

import contextlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.config.file import from_table
from fraese.control.controller import Controller
from fraese.control.state import Status
from fraese.journal import Journal, machine_file
from fraese.motor.ports.recorder import Recorder
from fraese.motor.ports.sim import Sight, SimulatedMill
from fraese.motor.seams import End
from fraese.program.program import Program, open_program

AXES = "xyz"
NOBODY = 65534
#: Built-in travel in steps, from switch to switch.
TRAVEL_STEPS = (60_000, 40_000, 12_000)
#: Built-in machine zero, as the carriages see it.
ZERO_STEPS = (400, 400, 11_600)

STEPDIR: dict[str, Any] = {"card": {"kind": "stepdir"}}


def configured(**sections: Any) -> Config:
    """A configuration as it would be read from a file with these tables."""
    return from_table(sections, "test")


def axes(**keys: Any) -> dict[str, Any]:
    """The same keys for every axis."""
    return {name: dict(keys) for name in AXES}


def merged(*tables: dict[str, Any]) -> dict[str, Any]:
    """Tables of sections put together, key by key."""
    result: dict[str, Any] = {}
    for table in tables:
        for section, keys in table.items():
            old = result.get(section)
            both = isinstance(old, dict) and isinstance(keys, dict)
            result[section] = merged(old, keys) if both and old is not None else keys
    return result


def plant(**sections: Any) -> Plant:
    """A machine in the middle of its travel, on a virtual clock."""
    return assemble(configured(**sections))


def mill(plant: Plant) -> SimulatedMill:
    port = plant.port
    assert isinstance(port, SimulatedMill)
    return port


def look(plant: Plant) -> Sight:
    """What a person at the machine sees."""
    return mill(plant).look()


def carriages(plant: Plant) -> tuple[float, ...]:
    return look(plant).carriages_steps


def put(plant: Plant, axis: str, steps_from_low_switch: float) -> None:
    """Move a carriage by hand, and wait until the switches have noticed."""
    mill(plant).mill.place(AXES.index(axis), steps_from_low_switch, plant.clock.now_ns())
    plant.controller.idle(2.0)
    for _ in range(plant.config.switches.readings):
        plant.controller.idle()


def end(name: str) -> End:
    """``end("xmin")``."""
    return End(AXES.index(name[0]), 1 if name[1:] == "max" else -1)


#: What a machine kept after its reference run, by configuration: one run is enough for all tests.
_REFERENCED: dict[str, bytes] = {}


def homed(**sections: Any) -> Plant:
    """A machine after its reference run; what it does is not kept."""
    config, key = configured(**sections), repr(sections)
    with tempfile.TemporaryDirectory() as folder:
        journal = machine_file(Path(folder), "simulation", "")
        if key not in _REFERENCED:
            made = assemble(config, state=Path(folder))
            made.controller.home()
            assert made.controller.run() is Status.OK, made.controller.state().message
            made.close()
            _REFERENCED[key] = journal.read_bytes()
        journal.write_bytes(_REFERENCED[key])
        return assemble(config, state=Path(folder), at_desk=True)


def crash(plant: Plant) -> None:
    """The program ends without another word; what it wrote is on the disk."""
    keeping = plant.keeping
    assert keeping is not None
    keeping.close()


def kept(folder: Path) -> dict[str, Any]:
    """The record in force of the simulated mill; empty: there is none."""
    found = Journal(machine_file(folder, "simulation", "")).read()
    return json.loads(found.payload) if found else {}


def keep(folder: Path, values: dict[str, Any]) -> None:
    """Put another record down."""
    journal = Journal(machine_file(folder, "simulation", ""))
    journal.read()
    journal.write(json.dumps(values).encode())


@contextlib.contextmanager
def as_nobody(folder: Path) -> Iterator[None]:
    """Root may do everything: meanwhile this is somebody else, and the folder his.

    What lies above it he may not look into: stand in it.
    """
    if os.geteuid():
        yield
        return
    for each in (folder, *folder.rglob("*")):
        os.chown(each, NOBODY, NOBODY)
    os.setegid(NOBODY)
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)
        os.setegid(0)


def after_slices(controller: Controller, number: int, *actions: Callable[[], object]) -> list[int]:
    """Do something after so many slices of the run loop; returns the list that counts them."""
    slices: list[int] = []

    def break_key() -> None:
        slices.append(1)
        if len(slices) == number:
            for action in actions:
                action()

    controller.set_break_key(break_key)
    return slices


def program(folder: Path, text: str, name: str = "part.ngc") -> Program:
    path = folder / name
    path.write_text(text, "utf-8")
    return open_program(path)


def run_program(plant: Plant, program: Program, *, from_line: int = 0) -> Status:
    """Look it through, then run it."""
    facts = program.check(plant.controller)
    program.start(plant.controller, facts, from_line=from_line)
    return plant.controller.run()


def record(plant: Plant) -> Recorder:
    """Write down everything that the card does to the port from now on."""
    recorder = Recorder(mill(plant), plant.clock)
    driver: Any = plant.controller._driver
    wires = driver._run.wires
    wires._port = recorder
    wires.access = (recorder.write_data, wires._sample, recorder.write_control)
    return recorder


def touching_at(plant: Plant, steps: float) -> set[str]:
    """A plate under the probe: the shared switch closes while Z is at or below it.

    Returns:
        What lies there; empty it to take the plate away.
    """
    port, there = mill(plant), {"plate"}
    read = port.read_status

    def read_status() -> int:
        status = read()
        return status & ~0x80 if there and carriages(plant)[2] <= steps else status

    port.read_status = read_status  # type: ignore[method-assign]
    return there
