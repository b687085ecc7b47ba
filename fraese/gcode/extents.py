"""How far an arc reaches, and how long it is."""

import math

from fraese.gcode.canon import PLANE_AXES, Arc
from fraese.workframe import Point

_QUARTER = math.pi / 2


def arc_extent(start: Point, arc: Arc) -> tuple[Point, Point, float]:
    """Lowest and highest corner of an arc's bounding box, and its length, in mm.

    Args:
        start: where it begins, machine mm.
        arc: the rest of it; a slight spiral counts with its larger radius.
    """
    first, second, third = PLANE_AXES[arc.plane]
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
    length_mm = math.hypot(radius_mm * sweep, arc.to[third] - start[third])
    return (low[0], low[1], low[2]), (high[0], high[1], high[2]), length_mm
