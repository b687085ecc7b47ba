"""What a sequence of blocks does, tick by tick; and machines to try it on."""

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from fraese.blocks import CYCLES_PER_S, Q8, Block
from fraese.config import Config
from fraese.machine import Axis, Machine
from fraese.planner.planner import Planner
from fraese.planner.segments import start_rate_hz

Floats = NDArray[np.float64]
Point = tuple[float, float, float]


def machine(**changes: object) -> Machine:
    """The built-in machine; what is named is different on every axis."""
    built_in = Machine.from_config(Config())
    return Machine(tuple(replace(axis, **changes) for axis in built_in.axes))  # type: ignore[arg-type]


def uneven() -> Machine:
    """Three axes that have nothing in common."""
    x, y, z = Machine.from_config(Config()).axes
    return Machine(
        (
            replace(x, steps_per_mm=Fraction(400, 3), start_rate_hz=500.0),
            replace(y, motor_sign=-1, max_rate_hz=3000.0, acceleration_hz_s=9000.0),
            replace(z, steps_per_mm=Fraction(1000), max_rate_hz=2500.0, start_rate_hz=300.0),
        )
    )


def intervals_s(block: Block) -> Floats:
    """Time before each tick, with the fraction that a player cuts off."""
    parts = [(piece.interval_q8 + np.arange(piece.ticks) * piece.add_q8) for piece in block.pieces]
    return np.concatenate(parts) / (CYCLES_PER_S * Q8)


def axis_rates_hz(block: Block) -> Floats:
    """Signed rate of every axis at every tick: a row per tick."""
    share = np.array(block.steps) / block.ticks()
    result: Floats = share[None, :] / intervals_s(block)[:, None]
    return result


def total_steps(blocks: Iterable[Block]) -> tuple[int, ...]:
    """Signed steps of all motors."""
    return tuple(map(sum, zip(*(block.steps for block in blocks), strict=True))) or (0, 0, 0)


def duration_s(blocks: Iterable[Block]) -> float:
    """Time of the plan."""
    return sum(block.duration_cycles() for block in blocks) / CYCLES_PER_S


def run(
    planner: Planner, points: Iterable[tuple[float, ...]], feed_mm_min: float | None
) -> list[Block]:
    """Straight lines through all points, to the end."""
    blocks: list[Block] = []
    for tag, point in enumerate(points):
        blocks += planner.line(point, feed_mm_min, tag)
    return blocks + list(planner.finish())


def moving(blocks: Iterable[Block]) -> list[Block]:
    """Without dwells."""
    return [block for block in blocks if any(block.steps)]


def check_limits(axes: tuple[Axis, ...], blocks: list[Block]) -> None:
    """Rates, accelerations and jumps of everything that is played, back to back.

    Rates to one cycle and 0.1 %. Acceleration between two neighbouring ticks to 10 % and what a
    cycle of rounding makes. A jump between blocks to the start/stop rate and 0.1 %, and what the
    acceleration makes, to 10 %, between the middles of the two ticks: there the rates are known.
    """
    max_hz = np.array([axis.max_rate_hz for axis in axes])
    start_hz = np.array([start_rate_hz(axis) for axis in axes])
    acceleration = np.array([axis.acceleration_hz_s for axis in axes])
    last = np.zeros(len(axes))
    last_s = 0.0
    for block in blocks:
        if not any(block.steps):
            last, last_s = np.zeros(len(axes)), 0.0
            continue
        rates, times = axis_rates_hz(block), intervals_s(block)
        cycle = 1 / (CYCLES_PER_S * times)
        assert (np.abs(rates) <= max_hz * (1.001 + cycle[:, None])).all()
        change = np.abs(np.diff(rates, axis=0))
        between_s = ((times[1:] + times[:-1]) / 2)[:, None]
        rounding = np.abs(rates[1:]) * 2 * cycle[1:, None]
        allowed = acceleration * between_s * 1.1 + rounding
        assert (change <= allowed).all(), (change / (acceleration * between_s)).max()
        gap_s = last_s + times[0]
        assert (np.abs(rates[0] - last) <= start_hz * 1.001 + acceleration * gap_s * 0.55).all()
        last, last_s = rates[-1], times[-1]
    assert (np.abs(last) <= start_hz * 1.001 + acceleration * last_s * 0.55).all()
