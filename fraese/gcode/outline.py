r"""The path of a cutter beside a path: courses, and where two of them cross. Flat geometry.

A course is what the cutter's centre goes along: a straight or a circle, both without ends, at a
distance from the path as programmed; positive distances lie to the left of it::

          course      .--------------.
                     /                \        left
    path            /  .----------.    \       <---- heading
                       |          |

Corners, seen from the cutter: on the outside it goes round the corner of the path, on the inside
its courses cross before the corner is reached. LinuxCNC takes what bends by less than 0.05 rad
for neither.
"""

import math
from collections.abc import Iterator
from enum import Enum
from typing import Final, NamedTuple

Flat = tuple[float, float]

#: A bend below this is none, rad: found on rs274.
NO_CORNER: Final = 0.05
#: Points closer than this differ by rounding only, mm.
SAME_MM: Final = 1e-9


class Corner(Enum):
    """What a corner is to the cutter."""

    NONE = 0
    INSIDE = 1
    OUTSIDE = 2


class Course(NamedTuple):
    """A straight through a point, or a circle about it; ``radius_mm`` is 0 for a straight.

    ``left``: a circle is gone round counter-clockwise.
    """

    at: Flat
    direction: Flat = (1.0, 0.0)
    radius_mm: float = 0.0
    left: bool = True

    def heading(self, point: Flat) -> Flat:
        """Unit vector along it at a point."""
        if not self.radius_mm:
            return self.direction
        x, y = unit(self.at, point)
        return (-y, x) if self.left else (y, -x)

    @property
    def bend(self) -> float:
        """Its curvature per mm, positive to the left."""
        if not self.radius_mm:
            return 0.0
        return (1.0 if self.left else -1.0) / self.radius_mm

    def beside(self, distance_mm: float) -> "Course":
        """The one at a distance; a circle that would vanish has no radius above 0."""
        if not self.radius_mm:
            return self._replace(at=beside(self.at, self.direction, distance_mm))
        inward = distance_mm if self.left else -distance_mm
        return self._replace(radius_mm=self.radius_mm - inward)

    def sweep(self, start: Flat, end: Flat) -> float:
        """Angle from point to point on a circle, the way it is gone round, 0 to 2 pi."""
        angle = _angle(self.at, end) - _angle(self.at, start)
        sweep = (angle if self.left else -angle) % math.tau
        return 0.0 if math.tau - sweep < SAME_MM else sweep


def line(start: Flat, end: Flat) -> Course:
    """The straight from point to point."""
    return Course(start, unit(start, end))


def unit(start: Flat, end: Flat) -> Flat:
    """Unit vector from point to point."""
    length_mm = math.dist(start, end)
    return (end[0] - start[0]) / length_mm, (end[1] - start[1]) / length_mm


def beside(point: Flat, heading: Flat, distance_mm: float) -> Flat:
    """The point to the left of one."""
    return point[0] - heading[1] * distance_mm, point[1] + heading[0] * distance_mm


def corner(before: Flat, after: Flat, bends: float, distance_mm: float) -> Corner:
    """What the corner between two headings is to a cutter on that side.

    Args:
        before: heading into it.
        after: heading out of it.
        bends: curvature of both courses together: where the way turns all the way back, it says
            on which side of the first the second one lies.
        distance_mm: of the cutter, positive to the left.
    """
    side = math.copysign(1.0, distance_mm)
    away = -side * math.atan2(_cross(before, after), _dot(before, after))
    if away < -math.pi / 2:
        away += math.tau
    if abs(away - math.pi) <= NO_CORNER:
        return Corner.INSIDE if side * bends < 0 else Corner.OUTSIDE
    if away < -NO_CORNER or away > math.pi:
        return Corner.INSIDE
    return Corner.OUTSIDE if away > NO_CORNER else Corner.NONE


def inside(before: Course, after: Course, distance_mm: float) -> Flat | None:
    """Where a cutter leaves a course for the next one in an inside corner; None: they never meet.

    Of two crossings it is the one at which the way bends to the cutter's side.
    """
    side = math.copysign(1.0, distance_mm)
    for point in _crossings(before, after):
        if side * _cross(before.heading(point), after.heading(point)) > 0:
            return point
    return None


def entry_centre(start: Flat, end: Flat, centre: Flat) -> Flat | None:
    """Centre of the arc from a point that ends where and as one about ``centre`` does.

    None: there is none on that side.
    """
    normal = unit(end, centre)
    way = start[0] - end[0], start[1] - end[1]
    inward = _dot(way, normal)
    if inward <= SAME_MM:
        return None
    radius_mm = _dot(way, way) / (2 * inward)
    return end[0] + normal[0] * radius_mm, end[1] + normal[1] * radius_mm


def _crossings(one: Course, other: Course) -> Iterator[Flat]:
    if not one.radius_mm and not other.radius_mm:
        way = other.at[0] - one.at[0], other.at[1] - one.at[1]
        along = _cross(way, other.direction) / _cross(one.direction, other.direction)
        yield _moved(one.at, one.direction, along)
    elif not one.radius_mm:
        yield from _on_circle(one.at, one.direction, other)
    elif not other.radius_mm:
        yield from _on_circle(other.at, other.direction, one)
    else:
        apart_mm = math.dist(one.at, other.at)
        if apart_mm > SAME_MM:
            # Both lie on the straight across the line of the centres.
            along = (one.radius_mm**2 - other.radius_mm**2 + apart_mm**2) / (2 * apart_mm)
            x, y = unit(one.at, other.at)
            yield from _on_circle(_moved(one.at, (x, y), along), (-y, x), one)


def _on_circle(at: Flat, direction: Flat, circle: Course) -> Iterator[Flat]:
    """Where a straight crosses a circle."""
    along = _dot((circle.at[0] - at[0], circle.at[1] - at[1]), direction)
    foot = _moved(at, direction, along)
    square = circle.radius_mm**2 - math.dist(foot, circle.at) ** 2
    if square >= 0:
        yield _moved(foot, direction, math.sqrt(square))
        yield _moved(foot, direction, -math.sqrt(square))


def _moved(point: Flat, direction: Flat, by_mm: float) -> Flat:
    return point[0] + direction[0] * by_mm, point[1] + direction[1] * by_mm


def _dot(a: Flat, b: Flat) -> float:
    return a[0] * b[0] + a[1] * b[1]


def _cross(a: Flat, b: Flat) -> float:
    return a[0] * b[1] - a[1] * b[0]


def _angle(centre: Flat, point: Flat) -> float:
    return math.atan2(point[1] - centre[1], point[0] - centre[0])
