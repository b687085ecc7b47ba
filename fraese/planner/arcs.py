r"""Arcs as chords: the fewest whose middle is not further from the true arc than a tolerance.

             ___...-+-...___         sagitta = r (1 - cos(angle / 2))
        .-''     sagitta    ''-.     so angle = 2 acos(1 - tolerance / r)
       *------------------------*    corners on the arc, chord inside

Rule 1: corners lie on the arc, the last one is the commanded end to the last bit.
Rule 2: where start and end have not quite the same radius, the radius goes evenly from one to the
        other; so does the third axis (a helix).
"""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

Point = tuple[float, float, float]

#: First, second and third axis of G17, G18 and G19: angles count from first to second.
PLANES: Final = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}

#: An end that is not further round than this is the start: the same as in LinuxCNC.
_SAME_RAD: Final = 1e-6

#: However small the circle: six chords a turn at least.
_WIDEST_RAD: Final = math.pi / 3


class ArcShape(NamedTuple):
    """An arc or helix from a start point, ready to be walked.

    Attributes:
        start_mm: where it begins,
        end_mm: and ends.
        axes: index of the first, second and third axis of its plane.
        centre_mm: in the first and second axis.
        start_radius_mm: distance of the start from the centre,
        end_radius_mm: and of the end.
        start_rad: direction of the start, seen from the centre.
        sweep_rad: signed angle of the whole arc, all turns.
    """

    start_mm: Point
    end_mm: Point
    axes: tuple[int, int, int]
    centre_mm: tuple[float, float]
    start_radius_mm: float
    end_radius_mm: float
    start_rad: float
    sweep_rad: float

    @property
    def radius_mm(self) -> float:
        """The greater of both radii."""
        return max(self.start_radius_mm, self.end_radius_mm)

    @property
    def length_mm(self) -> float:
        """Length of the path, helix included."""
        flat_mm = abs(self.sweep_rad) * (self.start_radius_mm + self.end_radius_mm) / 2
        third = self.axes[2]
        return math.hypot(flat_mm, self.end_mm[third] - self.start_mm[third])

    def chords(self, tolerance_mm: float) -> int:
        """The smallest number of chords that keeps the tolerance."""
        ratio = min(1.0, tolerance_mm / self.radius_mm) if self.radius_mm else 1.0
        widest = min(_WIDEST_RAD, 2 * math.acos(1 - ratio))
        # A full turn in exact chords should not become one more by the last bit.
        return max(1, math.ceil(abs(self.sweep_rad) / widest - 1e-9))

    def corners(self, tolerance_mm: float) -> Iterator[Point]:
        """End points of the chords, the last one exactly the end of the arc."""
        count = self.chords(tolerance_mm)
        first, second, third = self.axes
        centre_first, centre_second = self.centre_mm
        growth_mm = self.end_radius_mm - self.start_radius_mm
        height_mm, climb_mm = self.start_mm[third], self.end_mm[third] - self.start_mm[third]
        corner = [0.0, 0.0, 0.0]
        for k in range(1, count):
            part = k / count
            radius_mm = self.start_radius_mm + growth_mm * part
            angle = self.start_rad + self.sweep_rad * part
            corner[first] = centre_first + radius_mm * math.cos(angle)
            corner[second] = centre_second + radius_mm * math.sin(angle)
            corner[third] = height_mm + climb_mm * part
            yield corner[0], corner[1], corner[2]
        yield self.end_mm


def arc_shape(
    start_mm: Point, end_mm: Point, centre_mm: tuple[float, float], plane: int, turns: int
) -> ArcShape:
    """The arc between two points.

    Args:
        start_mm: where the tool is.
        end_mm: where it goes; equal to the start in the plane: whole turns.
        centre_mm: in the first and second axis of the plane.
        plane: 17 (XY), 18 (ZX) or 19 (YZ).
        turns: positive counter-clockwise seen from the positive third axis; 1: up to one turn,
            2: one more, and so on.

    Raises:
        ValueError: if the plane is none of the three, or ``turns`` is 0.
    """
    if plane not in PLANES or not turns:
        raise ValueError("an arc needs plane 17, 18 or 19 and at least one turn")
    axes = PLANES[plane]
    first, second, _ = axes
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
