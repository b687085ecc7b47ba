"""What a corpus of programs writes to the port: ``python -m tests.compiled.corpus``.

Prints one JSON object: the form that runs, and for each program a digest of every access to a
register, with its time.
"""

import hashlib
import json
import math
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from fraese import compiled
from fraese.assembly import assemble
from fraese.control.controller import Controller
from fraese.errors import FraeseError
from fraese.motor.core import MotorCore
from fraese.motor.seams import CONTROL, DATA, STATUS, Port
from tests.helpers import STEPDIR, configured, program, run_program
from tests.judge.programs import topics

ROOT: Final = Path(__file__).parents[2]
#: The machines, by name: each card, and play in the axes.
MACHINES: Final[dict[str, dict[str, Any]]] = {
    "smc": {},
    "stepdir": STEPDIR,
    "backlash": {"axes": {name: {"backlash_mm": 0.05} for name in "xyz"}},
}
#: So many slices of 0.1 s are played; of others 60.
PATIENCE: Final = {"plate": 600, "surface": 600}
#: Of the judge's small programs each so-many-th is played.
EVERY: Final = 3


class Digest:
    """A port that sums up what passes through it.

    Args:
        port: what it is passed on to.
        now_ns: the driver's time.
    """

    def __init__(self, port: Port, now_ns: Any) -> None:
        self._port = port
        self._now_ns = now_ns
        self.held = hashlib.sha256()
        self.accesses = 0

    def _note(self, register: int, value: int) -> None:
        self.accesses += 1
        self.held.update(b"%d %d %d\n" % (self._now_ns(), register, value))

    def write_data(self, value: int) -> None:
        self._note(DATA, value)
        self._port.write_data(value)

    def write_control(self, value: int) -> None:
        self._note(CONTROL, value)
        self._port.write_control(value)

    def read_status(self) -> int:
        value = self._port.read_status()
        self._note(STATUS, value)
        return value

    def close(self) -> None:
        self._port.close()


def surface(lines: int) -> str:
    """Short lines, as a CAM program writes them."""
    rows = ["G21 G90 G17 G64 P0.01", "F900", "G0 X50 Y40 Z-10"]
    for k in range(lines):
        x, y = 30 + 20 * math.cos(k / 40), 40 + 20 * math.sin(k / 40)
        rows.append(f"G1 X{x:.3f} Y{y:.3f} Z{-10 + 3 * math.sin(k / 7):.3f}")
    return "\n".join([*rows, "M2", ""])


def programs() -> Iterator[tuple[str, str]]:
    """Name and text of each."""
    yield "plate", (ROOT / "examples" / "plate.ngc").read_text("utf-8")
    yield "surface", surface(300)
    small = [
        (f"{topic} {number}", text)
        for topic, texts in topics().items()
        for number, text in enumerate(texts)
    ]
    yield from small[::EVERY]


class Operator:
    """Who answers every question, and has had enough after a while.

    Args:
        controller: asked by it after every slice of its run loop.
        slices: his patience.
    """

    def __init__(self, controller: Controller, slices: int) -> None:
        self._controller = controller
        self._left = slices
        controller.set_break_key(self.turn)

    def turn(self) -> None:
        self._left -= 1
        if self._left > 0:
            self._controller.answer()
        else:
            self._controller.cancel()


def written(machine: str, name: str, text: str, folder: Path) -> str:
    """What one program writes on one machine; a refusal is of its kind."""
    plant = assemble(configured(**MACHINES[machine]))
    driver = plant.controller._driver
    assert isinstance(driver, MotorCore)
    wires = driver.run.wires
    digest = Digest(wires.port, plant.clock.now_ns)
    wires.tap(digest)
    Operator(plant.controller, PATIENCE.get(name, 60))
    try:
        status = run_program(plant, program(folder, text)).name
    except FraeseError as error:
        status = type(error).__name__
    plant.close()
    return f"{status} {digest.accesses} {digest.held.hexdigest()}"


def main() -> None:
    """Run them all."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in programs():
            for machine in MACHINES if name in ("plate", "surface") else ("smc",):
                found[f"{name} on {machine}"] = written(machine, name, text, Path(folder))
    json.dump({"form": compiled.FORM.value, "written": found}, sys.stdout)


if __name__ == "__main__":
    main()
