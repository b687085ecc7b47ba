"""A single straight move from rest to rest, as one block.

What a jog, a reference run and a move by hand need; a program's moves go through the look-ahead.
"""

import math
from dataclasses import dataclass

from fraese.blocks import (
    CYCLES_PER_S,
    Q8,
    Block,
    Outputs,
    Watch,
    accel_q_from_hz_s,
    rate_q8_from_hz,
)
from fraese.feedway import groups_of
from fraese.machine import Machine, Steps
from fraese.planner.laws import law_of
from fraese.planner.measure import path_length_mm
from fraese.planner.ramps import trapezoid
from fraese.planner.segments import start_rate_hz
from fraese.planner.shaped import shaped_law
from fraese.planner.timing import WEIGHT_PER_MM2


@dataclass(frozen=True, slots=True)
class LineLimits:
    """What the leading axis may do along a straight line, in steps/s and steps/s**2.

    Bands to avoid are those of every axis, as rates of the leader.
    """

    ticks: int
    length_mm: float
    start_hz: float
    max_hz: float
    acceleration_hz_s: float
    bands_hz: tuple[tuple[float, float], ...] = ()

    def outside_bands_hz(self, rate_hz: float) -> float:
        """The rate, or the next lower one at which no axis is within a band to avoid."""
        tried_hz = -1.0
        while tried_hz != rate_hz:
            tried_hz = rate_hz
            for low_hz, high_hz in self.bands_hz:
                if low_hz < rate_hz * (1 - 1e-9) < high_hz:
                    rate_hz = low_hz
        return rate_hz

    def edge_hz(self, cruise_hz: float) -> float:
        """Rate before the first tick and after the last one: their own is the start/stop rate."""
        if cruise_hz <= self.start_hz:
            return cruise_hz
        return self.start_hz - self.acceleration_hz_s / (2 * self.start_hz)

    @property
    def weight(self) -> int:
        """Path energy of one (tick/s)**2, see ``Block.weight``."""
        return max(1, round((self.length_mm / self.ticks) ** 2 * WEIGHT_PER_MM2))


def mm_per_tick(weight: int) -> float:
    """Path length of one tick, from a block's weight."""
    return math.sqrt(weight / WEIGHT_PER_MM2)


def planned_s(block: Block) -> float:
    """Duration of a block as planned, to a cycle per tick."""
    cycles_q8 = 0
    for piece in block.pieces:
        cycles_q8 += piece.ticks * (piece.interval_q8 + piece.last_interval_q8())
    return cycles_q8 / (2 * Q8 * CYCLES_PER_S)


def line_limits(machine: Machine, delta_steps: Steps) -> LineLimits:
    """The strictest limits of all axes that take part, as seen by the leader.

    Args:
        machine: limits per axis.
        delta_steps: signed steps of every axis, not all zero.
    """
    ticks = max(abs(n) for n in delta_steps)
    parts = [(axis, abs(n) / ticks) for axis, n in zip(machine.axes, delta_steps, strict=True) if n]
    return LineLimits(
        ticks=ticks,
        length_mm=path_length_mm(groups_of(machine.names), delta_steps, machine.to_mm(delta_steps)),
        start_hz=min(start_rate_hz(axis) / part for axis, part in parts),
        max_hz=min(axis.max_rate_hz / part for axis, part in parts),
        acceleration_hz_s=min(axis.acceleration_hz_s / part for axis, part in parts),
        bands_hz=tuple(
            (low_hz / part, high_hz / part)
            for axis, part in parts
            for low_hz, high_hz in axis.avoid_hz
        ),
    )


def plan_line(
    machine: Machine,
    delta_steps: Steps,
    feed_mm_min: float | None = None,
    *,
    watch: Watch | None = None,
    outputs: Outputs | None = None,
    tag: int = 0,
    most: float = 0.0,
) -> Block | None:
    """A block from rest to rest; None when there is nothing to move.

    Args:
        machine: limits and conversions.
        delta_steps: signed steps of every axis, in axis directions.
        feed_mm_min: along the path, see ``measure``; None: as fast as the axes can.
        watch: condition while it plays.
        outputs: change of free outputs at the first tick.
        tag: seen in reports.
        most: the highest feed override that may act on it, a factor; 0: none acts. The block is
            planned for that one, and played slower by what is wanted: so a raised override acts
            on it, too. Where there are bands to avoid it is planned for 100 % at most: what is
            played slower than planned knows no bands.
    """
    if not any(delta_steps):
        return None
    limits = line_limits(machine, delta_steps)
    cruise_hz = limits.max_hz
    override_q8 = Q8 if most else 0
    if feed_mm_min is not None:
        wanted_hz = min(cruise_hz, feed_mm_min / 60 * limits.ticks / limits.length_mm)
        factor = 1.0 if limits.bands_hz else max(1.0, most)
        cruise_hz = min(cruise_hz, wanted_hz * factor)
        override_q8 = round(override_q8 * cruise_hz / wanted_hz)
    cruise_hz = limits.outside_bands_hz(cruise_hz)
    edge_hz = limits.edge_hz(cruise_hz)
    law, accel_hz_s = law_of(machine), limits.acceleration_hz_s
    if law is None:
        pieces = trapezoid(limits.ticks, edge_hz, cruise_hz, edge_hz, accel_hz_s)
    else:
        rates2 = edge_hz**2, cruise_hz**2, edge_hz**2
        pieces = shaped_law(law, limits.ticks, *rates2, 2 * accel_hz_s)
    return Block(
        steps=tuple(n * axis.motor_sign for n, axis in zip(delta_steps, machine.axes, strict=True)),
        pieces=tuple(pieces),
        accel_q=accel_q_from_hz_s(accel_hz_s),
        jump_rate_q8=rate_q8_from_hz(limits.start_hz),
        weight=limits.weight,
        ends_at_rest=True,
        watch=watch,
        outputs=outputs,
        tag=tag,
        override_q8=override_q8,
    )
