r"""Segments: straight lines in step space with all that the time law must respect.

Speeds are those along the path here, mm/s. An axis with ``u`` steps per mm of this path makes
``u * speed`` steps/s; so every limit of an axis becomes a limit of the path:

    speed         <= rate_hz / |u|                    highest rate, start/stop rate
    acceleration  <= acceleration_hz_s / |u|
    corner        |u_after - u_before| * speed <= start_rate_hz

Rule 1: the strictest axis counts, as seen from this segment.
Rule 2: at a corner no axis changes its rate by more than its start/stop rate.
Rule 3: along many short segments the path turns all the time, and the sum of harmless corners is
        an acceleration. It is held to the axis' limit too, as in an arc: change of direction per
        length, times speed squared. Directions are those before rounding to steps, so that a
        straight line in small pieces stays straight; and a speed at which every axis is within
        its start/stop rate is always allowed.
Rule 4: the rate of a tick is that of its middle. The law begins and ends at s - a / (2 s) ticks/s,
        so that the first tick from rest and the last one have the start/stop rate s.
"""

import math
from typing import Final, NamedTuple

from fraese.blocks import Outputs, Watch
from fraese.machine import Axis, Machine

UNLIMITED: Final = math.inf
#: A change of direction below this is none.
_STRAIGHT: Final = 1e-12

_sqrt = math.sqrt
_new = tuple.__new__


class Segment(NamedTuple):
    """One straight line.

    Attributes:
        steps: signed axis steps; for a segment that takes up backlash those of the motors.
        ticks: steps of the leading axis.
        length_mm: way of the steps.
        share_x: signed steps of an axis per mm of path,
        share_y: for every axis,
        share_z: after rounding.
        course_x: the direction before rounding,
        course_y: as a unit vector,
        course_z: for all three axes.
        top_mm_s: never faster.
        feed_mm_s: wanted, before override; infinite for a rapid.
        start_mm_s: speed at which every axis is at or below its start/stop rate.
        rest_mm_s: speed before the first tick from standstill, and after the last one.
        twice_mm_s2: two times the acceleration along the path.
        outputs: change at the first tick.
        watch: condition while it plays.
        tag: for reports.
    """

    steps: tuple[int, int, int]
    ticks: int
    length_mm: float
    share_x: float
    share_y: float
    share_z: float
    course_x: float
    course_y: float
    course_z: float
    top_mm_s: float
    feed_mm_s: float
    start_mm_s: float
    rest_mm_s: float
    twice_mm_s2: float
    outputs: Outputs | None
    watch: Watch | None
    tag: int

    def shares(self) -> tuple[float, float, float]:
        """Signed steps per mm of path, of all axes."""
        return self.share_x, self.share_y, self.share_z


def start_rate_hz(axis: Axis) -> float:
    """The start/stop rate that counts.

    A motor that follows its acceleration makes the first step from rest in sqrt(2 / a) at the
    latest: a rate below that as start/stop rate would contradict it.
    """
    return max(axis.start_rate_hz, _sqrt(axis.acceleration_hz_s / 2))


class Limits:
    """The machine's limits, turned round so that the hot path multiplies.

    Args:
        machine: a machine of three axes.
        rate_factor: part of the highest rates that may be used (a machine not referenced).

    Raises:
        ValueError: if the machine has not three axes.
    """

    def __init__(self, machine: Machine, rate_factor: float = 1.0) -> None:
        if len(machine.axes) != 3:
            raise ValueError("the look-ahead plans three axes")
        axes = machine.axes
        self._mm = tuple(axis.step_mm for axis in axes)
        self._per_rate = tuple(1 / (axis.max_rate_hz * rate_factor) for axis in axes)
        self._per_start = tuple(1 / start_rate_hz(axis) for axis in axes)
        self._per_acceleration = tuple(1 / axis.acceleration_hz_s for axis in axes)
        self._per_turn = tuple(float(axis.steps_per_mm) / axis.acceleration_hz_s for axis in axes)
        self._bands = tuple(axis.avoid_hz for axis in axes)
        #: Whether there is a band of rates to avoid.
        self.has_bands = any(self._bands)

    def segment(
        self,
        steps: tuple[int, int, int],
        way_mm: tuple[float, float, float] | None,
        feed_mm_s: float,
        top_mm_s: float,
        outputs: Outputs | None,
        tag: int,
        watch: Watch | None = None,
    ) -> Segment:
        """Look at a move of at least one step.

        Args:
            steps: signed axis steps.
            way_mm: the same before rounding; None: as the steps say.
            feed_mm_s: wanted speed, infinite for a rapid.
            top_mm_s: highest speed for other reasons than the axes.
            outputs: change at its first tick.
            tag: for reports.
            watch: condition while it plays.
        """
        x, y, z = steps
        mm_x, mm_y, mm_z = self._mm
        dx, dy, dz = x * mm_x, y * mm_y, z * mm_z
        length_mm = _sqrt(dx * dx + dy * dy + dz * dz)
        share_x, share_y, share_z = x / length_mm, y / length_mm, z / length_mm
        if way_mm is not None:
            dx, dy, dz = way_mm
        per_mm = 1 / (_sqrt(dx * dx + dy * dy + dz * dz) or length_mm)
        abs_x = x if x >= 0 else -x
        abs_y = y if y >= 0 else -y
        abs_z = z if z >= 0 else -z
        ticks = abs_x if abs_x >= abs_y else abs_y
        if abs_z > ticks:
            ticks = abs_z
        a, b, c = self._per_rate
        limit_mm_s = length_mm / max(abs_x * a, abs_y * b, abs_z * c)
        a, b, c = self._per_start
        start_mm_s = length_mm / max(abs_x * a, abs_y * b, abs_z * c)
        a, b, c = self._per_acceleration
        accel_mm_s2 = length_mm / max(abs_x * a, abs_y * b, abs_z * c)
        segment: Segment = _new(
            Segment,
            (
                steps,
                ticks,
                length_mm,
                share_x,
                share_y,
                share_z,
                dx * per_mm,
                dy * per_mm,
                dz * per_mm,
                limit_mm_s if limit_mm_s < top_mm_s else top_mm_s,
                feed_mm_s,
                start_mm_s,
                start_mm_s - accel_mm_s2 * length_mm / (2 * ticks * start_mm_s),
                accel_mm_s2 * 2,
                outputs,
                watch,
                tag,
            ),
        )
        return segment

    def corner_mm2_s2(self, before: Segment, after: Segment) -> float:
        """Square of the highest speed at the corner between two segments."""
        a, b, c = self._per_start
        turn = max(
            abs(after.share_x - before.share_x) * a,
            abs(after.share_y - before.share_y) * b,
            abs(after.share_z - before.share_z) * c,
        )
        limit = 1 / (turn * turn) if turn > _STRAIGHT else UNLIMITED
        a, b, c = self._per_turn
        turn = max(
            abs(after.course_x - before.course_x) * a,
            abs(after.course_y - before.course_y) * b,
            abs(after.course_z - before.course_z) * c,
        )
        if turn > _STRAIGHT:
            curve = (before.length_mm + after.length_mm) / (2 * turn)
            if curve < limit:
                slow = min(before.start_mm_s, after.start_mm_s)
                limit = min(limit, max(curve, slow * slow))
        return limit

    def restart_mm_s(self, before: Segment | None, exit_mm_s: float, after: Segment) -> float:
        """Highest speed to enter a segment when the one before ends at a speed of its own.

        That one ends within the start/stop rates. Each axis may go on from there by its start/stop
        rate; where one turns round this can mean starting from nothing.

        Args:
            before: None: from standstill.
            exit_mm_s: its last speed, at most ``before.start_mm_s``.
            after: the one that begins.
        """
        fastest = min(after.rest_mm_s, after.top_mm_s)
        if before is None:
            return fastest
        for per_start, was, now in zip(
            self._per_start, before.shares(), after.shares(), strict=True
        ):
            if now:
                left_hz = 1 / per_start + math.copysign(was * exit_mm_s, was * now)
                fastest = min(fastest, max(0.0, left_hz / abs(now)))
        return fastest

    def outside_bands_mm_s(self, segment: Segment, speed_mm_s: float) -> float:
        """The speed, or the next lower one at which no axis is within a band to avoid."""
        tried = -1.0
        while tried != speed_mm_s:
            tried = speed_mm_s
            for share, bands in zip(segment.shares(), self._bands, strict=True):
                for low_hz, high_hz in bands:
                    if low_hz < abs(share) * speed_mm_s * (1 - 1e-9) < high_hz:
                        speed_mm_s = low_hz / abs(share)
        return speed_mm_s
