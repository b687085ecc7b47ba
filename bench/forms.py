"""Compiled and plain beside each other, and rs274 where LinuxCNC is: ``python -m bench.forms``.

Every figure is by the processor's time, the best of some rounds: others may be at work beside it.
"""

import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Final

from bench.core import _core, _line
from bench.gcode import ours, program, rs274, took
from bench.planner import _wavy
from fraese.compiled import FORM, Form
from fraese.config import Config
from fraese.gcode.canon import Feed
from fraese.gcode.interpreter import interpret
from fraese.machine import Machine
from fraese.planner.planner import Planner
from fraese.planner.ramps import trapezoid

LINES: Final = 40_000
FILE_LINES: Final = 178_000
ROUNDS: Final = 3
#: The forms, and what the environment says to have them.
FORMS: Final = {"plain": "1", "compiled": "0"}


def _best_s(run: Callable[[], object]) -> float:
    rounds = []
    for _ in range(ROUNDS):
        began_s = time.process_time()
        run()
        rounds.append(time.process_time() - began_s)
    return min(rounds)


def _text(step_mm: float, count: int) -> list[str]:
    lines = [f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f}" for (x, y, z), _ in _wavy(count, step_mm)]
    return ["G21 G90 G17", "F900", *lines, "M2"]


def _planned(lines: list[str]) -> None:
    machine = Machine.from_config(Config())
    planner = Planner(machine, machine.to_steps((140.0, 100.0, -20.0)))
    for move in interpret(lines):
        if isinstance(move, Feed):
            deque(planner.line(move.to, move.feed_mm_min, move.line), 0)
    planner.finish()


def _played(steps: tuple[int, ...]) -> None:
    core = _core()
    core.push(_line(steps, tuple(trapezoid(max(steps), 1000, 5000, 1000, 40_000))))
    while core.poll(0.05).running:
        pass


def _checked_s() -> float:
    """``fraese check`` of a long file, the whole process."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.ngc"
        path.write_text("\n".join(_text(0.3, FILE_LINES)) + "\n", "utf-8")
        command = [sys.executable, "-m", "fraese", "check", str(path), "--state", folder]
        rounds = []
        for _ in range(ROUNDS):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run(command, check=True, capture_output=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            rounds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(rounds)


def measured() -> dict[str, float]:
    """All figures, in the form that runs."""
    g1, steps = program(LINES), (150_000, 100_000, 50_000)
    short, long = _text(0.1, LINES), _text(1.0, LINES)
    return {
        "plain G1, lines/s": LINES / _best_s(lambda: ours(g1)),
        "text to blocks, 0.1 mm, lines/s": LINES / _best_s(lambda: _planned(short)),
        "text to blocks, 1 mm, lines/s": LINES / _best_s(lambda: _planned(long)),
        "simulated mill, 3:2:1, half-steps/s": sum(steps) / _best_s(lambda: _played(steps)),
        f"check of {FILE_LINES:,} lines, s": _checked_s(),
    }


def main() -> None:
    """Each form in a process of its own."""
    if "--this" in sys.argv:
        print(json.dumps({"form": FORM.value, "figures": measured()}))
        return
    found: dict[str, dict[str, float]] = {}
    for form, plain in FORMS.items():
        if form == Form.COMPILED.value and FORM is not Form.COMPILED:
            print(f"fraese is {FORM.in_words()}: only that is measured.")
            continue
        done = subprocess.run(
            [sys.executable, "-m", "bench.forms", "--this"],
            env={**os.environ, "FRAESE_PLAIN": plain}, check=True, capture_output=True, text=True,
        )  # fmt: skip
        found[form] = json.loads(done.stdout)["figures"]
    print(f"{'':38}" + "".join(f"{form:>14}" for form in found))
    for name in next(iter(found.values())):
        digits = 2 if name.endswith(", s") else 0
        values = "".join(f"{figures[name]:14,.{digits}f}" for figures in found.values())
        print(f"{name:38}{values}")
    try:
        peer = took(rs274, program(LINES)).cpu_s
    except ImportError:
        peer = math.inf
    if peer < math.inf:
        print(f"{'plain G1, rs274 (C++), lines/s':38}{LINES / peer:14,.0f}")


if __name__ == "__main__":
    main()
