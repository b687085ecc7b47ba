"""How many lines of plain G1 the interpreter takes in a second, beside its peers.

Run ``python -m bench.gcode [lines]``. Peers from the package index are measured where they
are installed (``pip install '.[bench]'`` in an environment of its own), rs274 where LinuxCNC
is.
"""

import importlib
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path

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


def rate(run: Callable[[list[str]], None], lines: list[str], rounds: int) -> float:
    """Lines a second, best of several rounds."""
    best_s = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        run(lines)
        best_s = min(best_s, time.perf_counter() - start)
    return len(lines) / best_s


def main() -> int:
    """Print the rates; fails where ours is below the promised one."""
    lines = program(int(sys.argv[1]) if len(sys.argv) > 1 else 200_000)
    own = rate(ours, lines, ROUNDS)
    print(f"fraese       {own:10,.0f} lines/s")
    peers = (("pygcode", pygcode, 5_000), ("gcodeparser", gcodeparser, 100_000))
    for name, run, count in (*peers, ("rs274 (C++)", rs274, len(lines))):
        try:
            peer = rate(run, lines[:count], 1)
        except ImportError:
            print(f"{name:12} not installed")
            continue
        print(f"{name:12} {peer:10,.0f} lines/s   fraese is {own / peer:.1f} times as fast")
    return int(own < WANTED_LINES_S)


if __name__ == "__main__":
    sys.exit(main())
