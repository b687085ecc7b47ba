r"""Segments: straight lines in step space with all that the time law must respect.

Speeds are those along the path here, mm/s. An axis with ``u`` steps per mm of this path makes
``u * speed`` steps/s; so every limit of an axis becomes a limit of the path:

    speed         <= rate_hz / |u|                    highest rate, start/stop rate
    acceleration  <= acceleration_hz_s / |u|
    corner        |u_after - u_before| * speed <= start_rate_hz

Rule 1: the strictest axis counts, as seen from this segment. The rate of an axis that follows
        is that of its closest steps, see ``paced_as``.
Rule 2: at a corner no axis changes its rate by more than its start/stop rate.
Rule 3: along many short segments the path turns all the time, and the sum of harmless corners is
        an acceleration. It is held to the axis' limit too, as in an arc: change of direction per
        length, times speed squared. Directions are those before rounding to steps, so that a
        straight line in small pieces stays straight; and a speed at which every axis is within
        its start/stop rate is always allowed.
Rule 4: where the meaning of the path changes, from mm to degrees, the speed at the corner is one
        number on both sides all the same: so rule 2 holds for the rates that are really played,
        and energies of neighbouring blocks still compare. It costs time at such corners only.
Rule 5: the rate of a tick is that of its middle. The law begins and ends at s - a / (2 s) ticks/s,
        so that the first tick from rest and the last one have the start/stop rate s.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from fraese.blocks import Outputs, Watch
from fraese.feedway import groups_of
from fraese.machine import Axis, Machine, Steps
from fraese.planner.arcs import Point
from fraese.planner.measure import path_length_mm

UNLIMITED: Final = math.inf
#: A feed that no override acts on; what it is stands in ``top_mm_s``. Its square is unlimited.
KEPT: Final = -math.inf
#: A change of direction below this is none.
_STRAIGHT: Final = 1e-12

_sqrt = math.sqrt
_new = tuple.__new__


class Light(NamedTuple):
    """Power of a lamp along a segment.

    Attributes:
        share: of its full power, 0 to ``FULL_POWER``.
        at_mm_s: speed at which it has that share, less in proportion below it; 0: it is constant.
    """

    share: int = 0
    at_mm_s: float = 0.0


NO_LIGHT: Final = Light()


class Segment(NamedTuple):
    """One straight line.

    Attributes:
        steps: signed axis steps; for a segment that takes up backlash those of the motors.
        ticks: steps of the leading axis.
        length_mm: way of the steps, along the axes that a feed counts along, see ``measure``.
        shares: signed steps of every axis per mm of path, after rounding.
        course: way of every axis per mm of path, before rounding; mostly a unit vector.
        top_mm_s: never faster.
        feed_mm_s: wanted, before override; infinite for a rapid, see ``KEPT``.
        start_mm_s: speed at which every axis is at or below its start/stop rate.
        rest_mm_s: speed before the first tick from standstill, and after the last one.
        twice_mm_s2: two times the acceleration along the path.
        outputs: change at the first tick.
        watch: condition while it plays.
        tag: for reports.
        light: of a lamp, see ``Light``.
    """

    steps: Steps
    ticks: int
    length_mm: float
    shares: tuple[float, ...]
    course: tuple[float, ...]
    top_mm_s: float
    feed_mm_s: float
    start_mm_s: float
    rest_mm_s: float
    twice_mm_s2: float
    outputs: Outputs | None
    watch: Watch | None
    tag: int
    light: Light = NO_LIGHT


def start_rate_hz(axis: Axis) -> float:
    """The start/stop rate that counts.

    A motor that follows its acceleration makes the first step from rest in sqrt(2 / a) at the
    latest: a rate below that as start/stop rate would contradict it.
    """
    return max(axis.start_rate_hz, _sqrt(axis.acceleration_hz_s / 2))


class Limits:
    """The machine's limits, turned round so that the hot path multiplies.

    For any number of axes. ``limits_of`` gives the same, written out, for three linear ones.

    Args:
        machine: limits per axis.
        rate_factor: part of the highest rates that may be used (a machine not referenced).
    """

    def __init__(self, machine: Machine, rate_factor: float = 1.0) -> None:
        axes = machine.axes
        self._groups = groups_of(machine.names)
        self._mm = tuple(axis.step_mm for axis in axes)
        self._per_rate = tuple(1 / (axis.max_rate_hz * rate_factor) for axis in axes)
        self._per_start = tuple(1 / start_rate_hz(axis) for axis in axes)
        self._per_acceleration = tuple(1 / axis.acceleration_hz_s for axis in axes)
        self._per_turn = tuple(float(axis.steps_per_mm) / axis.acceleration_hz_s for axis in axes)
        # Like axes follow no faster than the leader goes, which is as fast as each of them may.
        self._are_alike = len(set(self._per_rate)) == 1
        self._bands = tuple(axis.avoid_hz for axis in axes)
        #: Whether there is a band of rates to avoid.
        self.has_bands = any(self._bands)

    def segment(
        self,
        steps: Steps,
        way_mm: Point | None,
        feed_mm_s: float,
        top_mm_s: float,
        outputs: Outputs | None,
        tag: int,
        watch: Watch | None = None,
        light: Light = NO_LIGHT,
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
            light: of a lamp.
        """
        counts = [abs(n) for n in steps]
        ticks = max(counts)
        steps_mm = [n * mm for n, mm in zip(steps, self._mm, strict=True)]
        wanted_mm = steps_mm if way_mm is None else way_mm
        length_mm = path_length_mm(self._groups, steps, steps_mm, way_mm)
        per_mm = 1 / (path_length_mm(self._groups, steps, wanted_mm) or length_mm)
        paced = counts if self._are_alike else [paced_as(n, ticks) for n in counts]
        limit_mm_s = length_mm / _most(paced, self._per_rate)
        start_mm_s = length_mm / _most(counts, self._per_start)
        accel_mm_s2 = length_mm / _most(counts, self._per_acceleration)
        return Segment(
            steps=steps,
            ticks=ticks,
            length_mm=length_mm,
            shares=tuple([n / length_mm for n in steps]),
            course=tuple([mm * per_mm for mm in wanted_mm]),
            top_mm_s=min(limit_mm_s, top_mm_s),
            feed_mm_s=feed_mm_s,
            start_mm_s=start_mm_s,
            rest_mm_s=start_mm_s - accel_mm_s2 * length_mm / (2 * ticks * start_mm_s),
            twice_mm_s2=accel_mm_s2 * 2,
            outputs=outputs,
            watch=watch,
            tag=tag,
            light=light,
        )

    def corner_mm2_s2(self, before: Segment, after: Segment) -> float:
        """Square of the highest speed at the corner between two segments."""
        jump = _turn(before.shares, after.shares, self._per_start)
        bend = _turn(before.course, after.course, self._per_turn)
        return _corner_mm2_s2(jump, bend, before, after)

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
        for per_start, was, now in zip(self._per_start, before.shares, after.shares, strict=True):
            if now:
                left_hz = 1 / per_start + math.copysign(was * exit_mm_s, was * now)
                fastest = min(fastest, max(0.0, left_hz / abs(now)))
        return fastest

    def outside_bands_mm_s(self, segment: Segment, speed_mm_s: float) -> float:
        """The speed, or the next lower one at which no axis is within a band to avoid."""
        tried = -1.0
        while tried != speed_mm_s:
            tried = speed_mm_s
            for share, bands in zip(segment.shares, self._bands, strict=True):
                for low_hz, high_hz in bands:
                    if low_hz < abs(share) * speed_mm_s * (1 - 1e-9) < high_hz:
                        speed_mm_s = low_hz / abs(share)
        return speed_mm_s


class ThreeLinear(Limits):
    """The same, written out for three axes that are measured together: what most machines are.

    It gives the very numbers of ``Limits``, in a third of the time.
    """

    def segment(
        self,
        steps: Steps,
        way_mm: Point | None,
        feed_mm_s: float,
        top_mm_s: float,
        outputs: Outputs | None,
        tag: int,
        watch: Watch | None = None,
        light: Light = NO_LIGHT,
    ) -> Segment:
        """See ``Limits.segment``."""
        x, y, z = steps
        mm_x, mm_y, mm_z = self._mm
        dx, dy, dz = x * mm_x, y * mm_y, z * mm_z
        length_mm = _sqrt(dx * dx + dy * dy + dz * dz)
        shares = x / length_mm, y / length_mm, z / length_mm
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
        if self._are_alike:
            limit_mm_s = length_mm / (ticks * a)
        else:
            most_x, most_y, most_z = (
                paced_as(abs_x, ticks), paced_as(abs_y, ticks), paced_as(abs_z, ticks),
            )  # fmt: skip
            limit_mm_s = length_mm / max(most_x * a, most_y * b, most_z * c)
        a, b, c = self._per_start
        start_mm_s = length_mm / max(abs_x * a, abs_y * b, abs_z * c)
        a, b, c = self._per_acceleration
        accel_mm_s2 = length_mm / max(abs_x * a, abs_y * b, abs_z * c)
        course = dx * per_mm, dy * per_mm, dz * per_mm
        if limit_mm_s < top_mm_s:
            top_mm_s = limit_mm_s
        rest_mm_s = start_mm_s - accel_mm_s2 * length_mm / (2 * ticks * start_mm_s)
        twice_mm_s2 = accel_mm_s2 * 2
        # Keywords cost three times as much: every value has the name of its field, see the tests.
        segment: Segment = _new(
            Segment,
            (
                steps, ticks, length_mm, shares, course, top_mm_s, feed_mm_s, start_mm_s, rest_mm_s,
                twice_mm_s2, outputs, watch, tag, light,
            ),
        )  # fmt: skip
        return segment

    def corner_mm2_s2(self, before: Segment, after: Segment) -> float:
        """See ``Limits.corner_mm2_s2``."""
        x, y, z = before.shares
        u, v, w = after.shares
        a, b, c = self._per_start
        jump = max(abs(u - x) * a, abs(v - y) * b, abs(w - z) * c)
        x, y, z = before.course
        u, v, w = after.course
        a, b, c = self._per_turn
        bend = max(abs(u - x) * a, abs(v - y) * b, abs(w - z) * c)
        return _corner_mm2_s2(jump, bend, before, after)


def limits_of(machine: Machine, rate_factor: float = 1.0) -> Limits:
    """The limits of a machine, in the form that is quickest for it."""
    groups = groups_of(machine.names)
    is_usual = len(machine.axes) == 3 and len(groups) == 1
    return (ThreeLinear if is_usual else Limits)(machine, rate_factor)


def paced_as(steps: int, ticks: int) -> float:
    """So many steps in the same time would be as close together as a follower's closest ones.

    A follower steps on the leader's beat: of 51 steps in 100 ticks some follow each other in
    neighbouring ticks. Its closest steps are ``ticks // steps`` ticks apart, on every player:
    one that divides ticks into beats only comes nearer to the mean.
    """
    return ticks / (ticks // steps) if steps else 0.0


def _most(counts: Sequence[float], per_limit: Sequence[float]) -> float:
    return max([n * each for n, each in zip(counts, per_limit, strict=True)])


def _turn(before: Sequence[float], after: Sequence[float], weights: Sequence[float]) -> float:
    """The greatest change of any axis, in its own measure."""
    changes = [abs(b - a) * each for a, b, each in zip(before, after, weights, strict=True)]
    return max(changes)


def _corner_mm2_s2(jump: float, bend: float, before: Segment, after: Segment) -> float:
    """Rules 2 and 3: what the sudden and the steady change of direction allow."""
    limit = 1 / (jump * jump) if jump > _STRAIGHT else UNLIMITED
    if bend > _STRAIGHT:
        curve = (before.length_mm + after.length_mm) / (2 * bend)
        if curve < limit:
            slow = min(before.start_mm_s, after.start_mm_s)
            limit = min(limit, max(curve, slow * slow))
    return limit
