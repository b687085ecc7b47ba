"""How far an arc or another course reaches, and how long it is."""

import math
from collections.abc import Iterable

from fraese.gcode.axes import Axes
from fraese.gcode.canon import Arc
from fraese.phrases import phrase
from fraese.workframe import Point

_QUARTER = math.pi / 2


def course_extent(start: Point, points: Iterable[Point], axes: Axes) -> tuple[Point, Point, float]:
    """The same of a way along many points; its start is not in the box.

    Args:
        start: where it begins, machine mm.
        points: in their order.
        axes: of the machine.
    """
    before, length_mm = start, 0.0
    low: Point = (math.inf,) * len(start)
    high: Point = (-math.inf,) * len(start)
    for point in points:
        low, high = tuple(map(min, low, point)), tuple(map(max, high, point))
        way = axes.way(before, point)
        length_mm += 0.0 if way.is_angle else way.length
        before = point
    return low, high, length_mm


def arc_extent(start: Point, arc: Arc, axes: Axes) -> tuple[Point, Point, float]:
    """Lowest and highest corner of an arc's bounding box, and its length, in mm.

    Args:
        start: where it begins, machine mm.
        arc: the rest of it; a slight spiral counts with its larger radius.
        axes: of the machine.
    """
    first, second, third = axes.plane(arc.plane, phrase("an arc"))
    from_a, from_b = start[first] - arc.centre[0], start[second] - arc.centre[1]
    to_a, to_b = arc.to[first] - arc.centre[0], arc.to[second] - arc.centre[1]
    radius_mm = max(math.hypot(from_a, from_b), math.hypot(to_a, to_b))
    begin, end = math.atan2(from_b, from_a), math.atan2(to_b, to_a)
    if arc.turns < 0:
        begin, end = end, begin
    sweep = (end - begin) % math.tau or math.tau
    low, high = list(map(min, start, arc.to)), list(map(max, start, arc.to))
    whole = abs(arc.turns) > 1
    quarter = math.ceil(begin / _QUARTER)
    while whole or quarter * _QUARTER <= begin + sweep:
        angle = quarter * _QUARTER
        for axis, centre_mm, reach in (
            (first, arc.centre[0], math.cos(angle)),
            (second, arc.centre[1], math.sin(angle)),
        ):
            value_mm = centre_mm + radius_mm * round(reach)
            if round(reach):
                low[axis], high[axis] = min(low[axis], value_mm), max(high[axis], value_mm)
        quarter += 1
        whole = whole and angle < begin + math.tau
    sweep += math.tau * (abs(arc.turns) - 1)
    rise_mm = 0.0 if third is None else arc.to[third] - start[third]
    return tuple(low), tuple(high), math.hypot(radius_mm * sweep, rise_mm)
