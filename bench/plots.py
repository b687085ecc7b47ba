"""The pictures of docs/motion.md, made by planner and core themselves: ``python bench/plots.py``.

A small chart in SVG needs no library: axes, a few lines, words.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from pathlib import Path

from fraese.blocks import CYCLES_PER_S, Block
from fraese.config import Config
from fraese.machine import Machine
from fraese.motor.cards.stepdir import StepDirCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.electronics import StepDirElectronics
from fraese.motor.mill import Mill, Slide
from fraese.motor.ports.recorder import Recorder
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import DATA
from fraese.peers import RAMPS
from fraese.planner.lines import plan_line
from fraese.planner.planner import Planner

Curve = Sequence[tuple[float, float]]

_WIDTH, _HEIGHT = 720, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 16, 34, 44
_COLOURS = ("#1f5fa8", "#c8502d", "#3c8c4a")


@dataclass(frozen=True)
class Chart:
    """Curves over one pair of axes.

    Attributes:
        title: above the chart.
        x: words under it,
        y: and at its left.
        curves: name and points of each; a name that begins with "." is drawn as dots.
    """

    title: str
    x: str
    y: str
    curves: dict[str, Curve]

    def svg(self) -> str:
        """The picture."""
        points = [point for curve in self.curves.values() for point in curve]
        right = _nice(max(x for x, _ in points))
        top = _nice(max(y for _, y in points))
        across = (_WIDTH - _LEFT - _RIGHT) / right[-1]
        up = (_HEIGHT - _TOP - _BOTTOM) / top[-1]

        def place(x: float, y: float) -> str:
            return f"{_LEFT + x * across:.1f},{_HEIGHT - _BOTTOM - y * up:.1f}"

        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {_HEIGHT}" '
            'font-family="sans-serif" font-size="12" fill="#333">',
            f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="#fff"/>',
            _text(_LEFT, 20, self.title, 'font-weight="bold"'),
            _text(_WIDTH - _RIGHT, _HEIGHT - 8, self.x, 'text-anchor="end"'),
            _text(14, _TOP, self.y, f'text-anchor="end" transform="rotate(-90 14 {_TOP})"'),
        ]
        for x in right:
            at = _LEFT + x * across
            parts.append(_line(f"{at:.1f},{_HEIGHT - _BOTTOM} {at:.1f},{_TOP}", "#e4e4e4"))
            parts.append(_text(at, _HEIGHT - _BOTTOM + 16, f"{x:g}", 'text-anchor="middle"'))
        for y in top:
            at = _HEIGHT - _BOTTOM - y * up
            parts.append(_line(f"{_LEFT},{at:.1f} {_WIDTH - _RIGHT},{at:.1f}", "#e4e4e4"))
            parts.append(_text(_LEFT - 6, at + 4, f"{y:g}", 'text-anchor="end"'))
        for k, (name, curve) in enumerate(self.curves.items()):
            colour = _COLOURS[k % len(_COLOURS)]
            if name.startswith("."):
                parts += [_dot(place(*point), colour) for point in curve]
            else:
                parts.append(_line(" ".join(place(*point) for point in curve), colour, 1.6))
            end_x = _WIDTH - _RIGHT - 6
            words = name.lstrip(".")
            parts.append(
                _text(end_x, _TOP + 16 + 16 * k, words, f'text-anchor="end" fill="{colour}"')
            )
        return "\n".join([*parts, "</svg>", ""])


def _nice(highest: float) -> list[float]:
    """Round marks from nothing to a little above the highest value."""
    rough = highest / 5
    power = 10 ** math.floor(math.log10(rough))
    step = next(power * factor for factor in (1, 2, 2.5, 5, 10) if power * factor >= rough)
    return [round(step * k, 9) for k in range(math.ceil(highest / step - 1e-9) + 1)]


def _text(x: float, y: float, words: str, more: str = "") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" {more}>{words}</text>'


def _line(points: str, colour: str, width: float = 1) -> str:
    return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="{width}"/>'


def _dot(at: str, colour: str) -> str:
    x, y = at.split(",")
    return f'<circle cx="{x}" cy="{y}" r="2.2" fill="{colour}"/>'


# --- what is shown -----------------------------------------------------------------------------


def intervals_s(block: Block) -> list[float]:
    """Time before each tick."""
    return [
        ((piece.interval_q8 + k * piece.add_q8) >> 8) / CYCLES_PER_S
        for piece in block.pieces
        for k in range(piece.ticks)
    ]


def rates(blocks: Sequence[Block], per_tick: Sequence[float] | None = None) -> Curve:
    """Rate in the middle of every tick; ticks/s, or what a tick is worth per second."""
    times = [time for block in blocks for time in intervals_s(block)]
    worth = per_tick or [1.0] * len(times)
    ends = accumulate(times)
    return [(end - t / 2, w / t) for end, t, w in zip(ends, times, worth, strict=True)]


def mm_per_tick(machine: Machine, blocks: Sequence[Block]) -> list[float]:
    """Path length of each tick of all blocks."""
    return [
        math.hypot(*machine.to_mm(block.steps)) / block.ticks()
        for block in blocks
        for _ in range(block.ticks())
    ]


def ramp(machine: Machine) -> Chart:
    """A long straight move."""
    block = plan_line(machine, (1600, 0, 0))
    assert block is not None
    played = rates([block])
    edges = [0, *accumulate(piece.ticks for piece in block.pieces)]
    joints = [played[edge] for edge in edges[:-1]]
    return Chart(
        "A straight move of 1600 steps: two ramps and a cruise rate",
        "time, s",
        "steps/s",
        {"rate played": played, f".{len(block.pieces)} pieces begin here": joints},
    )


def short_move(machine: Machine) -> Chart:
    """Moves too short for the cruise rate."""
    curves: dict[str, Curve] = {}
    for ticks in (120, 60, 24):
        block = plan_line(machine, (ticks, 0, 0))
        assert block is not None
        curves[f".{ticks} steps"] = rates([block])
    return Chart(
        "Short moves: four ticks of constant rate at the crest", "time, s", "steps/s", curves
    )


def laws(machine: Machine) -> Chart:
    """A long straight move by each law."""
    curves: dict[str, Curve] = {}
    for name in RAMPS.ours:
        block = plan_line(replace(machine, ramp=name), (1600, 0, 0))
        assert block is not None
        curves[name] = rates([block])
    return Chart(
        "1600 steps by each law: the highest acceleration is the same", "time, s", "steps/s", curves
    )


def accelerations(machine: Machine) -> Chart:
    """The acceleration of the way up."""
    curves: dict[str, Curve] = {}
    for name in RAMPS.ours:
        block = plan_line(replace(machine, ramp=name), (1600, 0, 0))
        assert block is not None
        up = [
            ((a + b) / 2, (after - before) / (b - a))
            for (a, before), (b, after) in pairwise(rates([block]))
            if a < 0.3
        ]
        means = [
            (sum(at for at, _ in up[k : k + 8]) / 8, sum(value for _, value in up[k : k + 8]) / 8)
            for k in range(0, len(up) - 8, 4)
        ]
        curves[name] = [(at, max(0.0, value)) for at, value in means]
    return Chart(
        "The same: acceleration on the way up, means of eight steps",
        "time, s",
        "steps/s per second",
        curves,
    )


def corners(machine: Machine) -> Chart:
    """The same path with and without look-ahead."""
    path = [(4.0, 0.0, 0.0), (8.0, 1.0, 0.0), (11.0, 4.0, 0.0), (11.0, 8.0, 0.0), (5.0, 8.0, 0.0)]
    ahead, single = Planner(machine, (0, 0, 0)), Planner(machine, (0, 0, 0))
    blocks: list[Block] = []
    lone: list[Block] = []
    for point in path:
        blocks += ahead.line(point, 900)
        lone += [*single.line(point, 900), *single.drain()]
    blocks += ahead.finish()
    return Chart(
        "Five lines with corners of 14, 31, 45 and 90 degrees at 900 mm/min",
        "time, s",
        "mm/s along the path",
        {
            "with look-ahead": rates(blocks, mm_per_tick(machine, blocks)),
            "each line from rest to rest": rates(lone, mm_per_tick(machine, lone)),
        },
    )


def hold(machine: Machine) -> Chart:
    """Feed hold in the middle of a path, on the simulated mill."""
    planner = Planner(machine, (0, 0, 0))
    blocks = [*planner.line((6.0, 0.0, 0.0), 900), *planner.line((12.0, 2.0, 0.0), 900)]
    blocks += planner.finish()
    clock = VirtualClock()
    mill = Mill([Slide(100_000)] * 3)
    port = Recorder(SimulatedMill(mill, StepDirElectronics(mill, clock), clock), clock)
    core = MotorCore(port, StepDirCard(motors=3), clock, settle_s=0)
    for block in blocks:
        core.push(block)
    core.poll(0.35)
    core.brake()
    core.poll(0.45)
    clock.wait_until(800_000_000)
    core.resume()
    while core.poll(0.1).running:
        pass
    # Clock of motor 0 is bit 1: the leader of both lines.
    edges_ns = [
        after.at_ns
        for before, after in pairwise(a for a in port.accesses if a.register == DATA)
        if after.value & 2 and not before.value & 2
    ]
    played = []
    for a, b in pairwise(edges_ns):
        stood = b - a > 50_000_000
        played += [(a / 1e9, 0.0), (b / 1e9, 0.0)] if stood else [((a + b) / 2e9, 1e9 / (b - a))]
    core.close()
    return Chart(
        "Hold after 0.35 s, resume at 0.8 s: later, but the same steps",
        "time, s",
        "steps/s of the leading axis",
        {"planned": rates(blocks), "played": played},
    )


def main() -> None:
    """Write all pictures next to the page that shows them."""
    machine = Machine.from_config(Config())
    folder = Path(__file__).parent.parent / "docs"
    for make in (ramp, short_move, laws, accelerations, corners, hold):
        name = folder / f"motion-{make.__name__.replace('_', '-')}.svg"
        name.write_text(make(machine).svg(), "utf-8")
        print(name)


if __name__ == "__main__":
    main()
