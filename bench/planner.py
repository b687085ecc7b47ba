"""How fast lines become blocks, and how many pieces these have: ``python -m bench.planner``.

First points alone, as the planner gets them; then text, through the interpreter. Wanted are 25,000
lines of text in a second on one core.
"""

import math
import time
from collections.abc import Iterator

from fraese.config import Config
from fraese.gcode.canon import Feed
from fraese.gcode.interpreter import interpret
from fraese.machine import Machine
from fraese.planner.planner import Options, Planner

Line = tuple[tuple[float, float, float], float]


def _wavy(count: int, step_mm: float) -> Iterator[Line]:
    """A smooth surface, as a CAM system writes it: short lines, three decimals."""
    for k in range(count):
        way_mm = k * step_mm
        x_mm = round(100 + 40 * math.cos(way_mm / 40), 3)
        y_mm = round(100 + 40 * math.sin(way_mm / 40), 3)
        yield (x_mm, y_mm, round(-20 + 3 * math.sin(way_mm / 7), 3)), 900.0


def _outline(count: int, step_mm: float) -> Iterator[Line]:
    """A flat contour with corners: half of it straight."""
    for k in range(count):
        side, along = divmod(k * step_mm, 10)
        x_mm = round(20 + (side // 2) % 9 * 10 + (along if side % 2 == 0 else 10), 3)
        y_mm = round(20 + (along if side % 2 else 0) + (side % 2) * 2 * math.sin(along), 3)
        yield (x_mm, y_mm, -20.0), 1200.0


def measure(name: str, lines: list[Line], repeat: int = 5) -> float:
    """Print and return lines per second, the best of some runs."""
    machine = Machine.from_config(Config())
    best = math.inf
    blocks = pieces = 0
    for _ in range(repeat):
        planner = Planner(machine, machine.to_steps(lines[0][0]), Options())
        blocks = pieces = 0
        start = time.perf_counter()
        for tag, (to_mm, feed_mm_min) in enumerate(lines):
            for block in planner.line(to_mm, feed_mm_min, tag):
                blocks += 1
                pieces += len(block.pieces)
        final = planner.finish()
        best = min(best, time.perf_counter() - start)
        blocks += len(final)
        pieces += sum(len(block.pieces) for block in final)
    print(
        f"{name:28} {len(lines) / best:9,.0f} lines/s  {best / len(lines) * 1e6:5.1f} us/line"
        f"  {pieces / blocks:5.2f} pieces/block"
    )
    return len(lines) / best


def from_text(name: str, lines: list[Line], repeat: int = 5) -> float:
    """The same beginning with G-code."""
    text = ["G21 G90 G17", "F900"]
    text += [f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f}" for (x, y, z), _ in lines]
    machine = Machine.from_config(Config())
    best = math.inf
    for _ in range(repeat):
        planner = Planner(machine, machine.to_steps(lines[0][0]), Options())
        blocks = 0
        start = time.perf_counter()
        for move in interpret(text):
            if isinstance(move, Feed):
                for _block in planner.line(move.to, move.feed_mm_min, move.line):
                    blocks += 1
        blocks += len(planner.finish())
        best = min(best, time.perf_counter() - start)
    print(f"{name:28} {len(lines) / best:9,.0f} lines/s  {best / len(lines) * 1e6:5.1f} us/line")
    return len(lines) / best


def main() -> None:
    """All cases."""
    for step_mm in (0.1, 0.3, 1.0):
        measure(f"surface, {step_mm} mm", list(_wavy(40_000, step_mm)))
    for step_mm in (0.1, 0.5):
        measure(f"outline, {step_mm} mm", list(_outline(40_000, step_mm)))
    for step_mm in (0.1, 1.0):
        from_text(f"text of a surface, {step_mm} mm", list(_wavy(40_000, step_mm)))


if __name__ == "__main__":
    main()
