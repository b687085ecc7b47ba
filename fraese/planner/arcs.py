r"""Arcs as chords: the fewest whose middle is not further from the true arc than a tolerance.

             ___...-+-...___         sagitta = r (1 - cos(angle / 2))
        .-''     sagitta    ''-.     so angle = 2 acos(1 - tolerance / r)
       *------------------------*    corners on the arc, chord inside

Rule 1: corners lie on the arc, the last one is the commanded end to the last bit.
Rule 2: where start and end have not quite the same radius, the radius goes evenly from one to the
        other; so do all other axes (a helix, a rotary axis).
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from fraese.machine import Axis

#: A value for every axis of the machine.
Point = tuple[float, ...]
#: Numbers of the first and the second axis of a plane: angles count from first to second.
Plane = tuple[int, int]

#: G17, G18 and G19 by their axes.
_PLANES: Final = {17: "xy", 18: "zx", 19: "yz"}

#: An end that is not further round than this is the start: the same as in LinuxCNC.
_SAME_RAD: Final = 1e-6

#: However small the circle: six chords a turn at least.
_WIDEST_RAD: Final = math.pi / 3


def curve_mm_s(axes: Sequence[Axis], radius_mm: float) -> float:
    """How fast an arc may be: what its axes can turn round by, or start with.

    Args:
        axes: of its plane.
        radius_mm: of the arc.
    """
    inward_mm_s2 = min(axis.acceleration_hz_s / float(axis.steps_per_mm) for axis in axes)
    rest_mm_s = min(axis.start_rate_hz / float(axis.steps_per_mm) for axis in axes)
    return max(rest_mm_s, math.sqrt(inward_mm_s2 * radius_mm))


class ArcShape(NamedTuple):
    """An arc or helix from a start point, ready to be walked.

    Attributes:
        start_mm: where it begins,
        end_mm: and ends.
        axes: numbers of the first and second axis of its plane.
        centre_mm: in the first and second axis.
        start_radius_mm: distance of the start from the centre,
        end_radius_mm: and of the end.
        start_rad: direction of the start, seen from the centre.
        sweep_rad: signed angle of the whole arc, all turns.
    """

    start_mm: Point
    end_mm: Point
    axes: Plane
    centre_mm: tuple[float, float]
    start_radius_mm: float
    end_radius_mm: float
    start_rad: float
    sweep_rad: float

    @property
    def radius_mm(self) -> float:
        """The greater of both radii."""
        return max(self.start_radius_mm, self.end_radius_mm)

    def chords(self, tolerance_mm: float) -> int:
        """The smallest number of chords that keeps the tolerance."""
        ratio = min(1.0, tolerance_mm / self.radius_mm) if self.radius_mm else 1.0
        widest = min(_WIDEST_RAD, 2 * math.acos(1 - ratio))
        # A full turn in exact chords should not become one more by the last bit.
        return max(1, math.ceil(abs(self.sweep_rad) / widest - 1e-9))

    def corners(self, tolerance_mm: float) -> Iterator[Point]:
        """End points of the chords, the last one exactly the end of the arc."""
        count = self.chords(tolerance_mm)
        first, second = self.axes
        centre_first, centre_second = self.centre_mm
        growth_mm = self.end_radius_mm - self.start_radius_mm
        followers = [
            (axis, start, end - start)
            for axis, (start, end) in enumerate(zip(self.start_mm, self.end_mm, strict=True))
            if axis not in self.axes
        ]
        corner = list(self.start_mm)
        for k in range(1, count):
            part = k / count
            radius_mm = self.start_radius_mm + growth_mm * part
            angle = self.start_rad + self.sweep_rad * part
            corner[first] = centre_first + radius_mm * math.cos(angle)
            corner[second] = centre_second + radius_mm * math.sin(angle)
            for axis, start, way in followers:
                corner[axis] = start + way * part
            yield tuple(corner)
        yield self.end_mm


def planes_of(names: Sequence[str]) -> dict[int, Plane]:
    """The planes in which a machine with these axes can make arcs."""
    return {
        code: (names.index(axes[0]), names.index(axes[1]))
        for code, axes in _PLANES.items()
        if axes[0] in names and axes[1] in names
    }


#: On a machine of X, Y and Z, in this order.
PLANES: Final = planes_of("xyz")


def arc_shape(
    start_mm: Point,
    end_mm: Point,
    centre_mm: tuple[float, float],
    plane: int,
    turns: int,
    planes: Mapping[int, Plane] = PLANES,
) -> ArcShape:
    """The arc between two points.

    Args:
        start_mm: where the tool is.
        end_mm: where it goes; equal to the start in the plane: whole turns.
        centre_mm: in the first and second axis of the plane.
        plane: 17 (XY), 18 (ZX) or 19 (YZ).
        turns: positive counter-clockwise seen from the positive third axis; 1: up to one turn,
            2: one more, and so on.
        planes: those of the machine.

    Raises:
        ValueError: if the machine has no such plane, or ``turns`` is 0.
    """
    if plane not in planes or not turns:
        raise ValueError("an arc needs plane 17, 18 or 19, both its axes, and at least one turn")
    axes = first, second = planes[plane]
    from_first, from_second = start_mm[first] - centre_mm[0], start_mm[second] - centre_mm[1]
    to_first, to_second = end_mm[first] - centre_mm[0], end_mm[second] - centre_mm[1]
    start_rad = math.atan2(from_second, from_first)
    sweep_rad = math.atan2(to_second, to_first) - start_rad
    full = 2 * math.pi
    sign = 1 if turns > 0 else -1
    ahead_rad = sign * sweep_rad % full
    if ahead_rad <= _SAME_RAD:
        ahead_rad += full
    sweep_rad = sign * ahead_rad + full * (turns - sign)
    return ArcShape(
        start_mm,
        end_mm,
        axes,
        centre_mm,
        math.hypot(from_first, from_second),
        math.hypot(to_first, to_second),
        start_rad,
        sweep_rad,
    )
