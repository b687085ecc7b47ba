"""How many lines of plain G1 the interpreter takes in a second, beside its peers.

Run ``python -m bench.gcode [lines]``. Peers from the package index are measured where they
are installed (``pip install '.[bench]'`` in an environment of its own), rs274 where LinuxCNC
is. Each is run as often, on the same lines, and its best round counts; processor time beside
time by the clock, children included.
"""

import importlib
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from fraese.gcode.interpreter import interpret

WANTED_LINES_S = 60_000
ROUNDS = 3


def program(count: int) -> list[str]:
    """Plain moves as a CAM program writes them; the same ones every time."""
    rng = random.Random(20)
    lines = ["G21 G90 G17", "F500"]
    for index in range(count):
        x, y, z = rng.uniform(0, 100), rng.uniform(0, 100), rng.uniform(-5, 0)
        feed = " F300" if index % 10 == 0 else ""
        lines.append(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f}{feed}")
    lines.append("M2")
    return lines


def ours(lines: list[str]) -> None:
    """Interpret everything and keep nothing."""
    deque(interpret(lines), 0)


def pygcode(lines: list[str]) -> None:
    """The virtual machine of pygcode."""
    module = importlib.import_module("pygcode")
    machine = module.Machine()
    for text in lines:
        machine.process_block(module.Line(text).block)


def gcodeparser(lines: list[str]) -> None:
    """Tokens only: no modes, no positions."""
    module = importlib.import_module("gcodeparser")
    deque(module.GcodeParser("\n".join(lines)).lines, 0)


def rs274(lines: list[str]) -> None:
    """LinuxCNC's interpreter, writing its canonical calls to a file."""
    binary = shutil.which("rs274")
    if binary is None:
        raise ImportError("rs274 is not installed")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bench.ngc"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        with (Path(folder) / "out").open("wb") as out:
            subprocess.run(
                [binary, "-g", path.name],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.DEVNULL,
                check=True,
            )


class Took(NamedTuple):
    """Seconds by the clock, and of the processor with that of children; of the best round."""

    wall_s: float
    cpu_s: float


def took(run: Callable[[list[str]], None], lines: list[str]) -> Took:
    """The quickest of ``ROUNDS`` rounds, by the processor: others may be at work beside it."""
    rounds = []
    for _ in range(ROUNDS):
        wall_s, cpu_s = time.perf_counter(), _cpu_s()
        run(lines)
        rounds.append(Took(time.perf_counter() - wall_s, _cpu_s() - cpu_s))
    return min(rounds, key=lambda each: each.cpu_s)


def _cpu_s() -> float:
    both = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(used.ru_utime + used.ru_stime for used in both)


def said(name: str, count: int, each: Took) -> str:
    """One line of the report."""
    return (
        f"{name:12} {count / each.cpu_s:10,.0f} lines/s of the processor,"
        f" {count / each.wall_s:10,.0f} by the clock"
    )


def main() -> int:
    """Print the rates, each of as many rounds; fails where ours is below the promised one.

    Every peer stands beside ours on the same lines.
    """
    lines = program(int(sys.argv[1]) if len(sys.argv) > 1 else 200_000)
    own = took(ours, lines)
    print(said("fraese", len(lines), own))
    peers = (("pygcode", pygcode, 5_000), ("gcodeparser", gcodeparser, 100_000))
    for name, run, most in (*peers, ("rs274 (C++)", rs274, len(lines))):
        part = lines[:most]
        try:
            peer = took(run, part)
        except ImportError:
            print(f"{name:12} not installed")
            continue
        same = own if len(part) == len(lines) else took(ours, part)
        print(
            f"{said(name, len(part), peer)}; fraese is {peer.cpu_s / same.cpu_s:.2f} times as fast"
        )
    return int(len(lines) / own.cpu_s < WANTED_LINES_S)


if __name__ == "__main__":
    sys.exit(main())
