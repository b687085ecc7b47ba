"""Curves made into straight lines, and lines into fewer."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from fraese.engrave.shapes import Points

#: So many lines a curve takes at most.
_MOST: Final = 20_000


def bezier(controls: ArrayLike, tolerance: float) -> Points:
    """(n, 2) points of a quadratic or cubic curve, its ends among them.

    The chord of a part of length h of the parameter is off by at most h * h / 8 of the greatest
    second derivative.

    Args:
        controls: (3, 2) or (4, 2) control points.
        tolerance: in the unit of the points.
    """
    at = np.asarray(controls, np.float64)
    degree = len(at) - 1
    bend = float(np.hypot(*np.diff(at, 2, axis=0).T).max()) * degree * (degree - 1)
    count = _count(math.sqrt(bend / (8 * tolerance)))
    t = np.linspace(0.0, 1.0, count + 1)[:, None]
    points = np.zeros((count + 1, 2))
    for number, control in enumerate(at):
        share = math.comb(degree, number) * t**number * (1 - t) ** (degree - number)
        points += share * control
    points[0], points[-1] = at[0], at[-1]
    return points


def sampled(
    where: Callable[[Points], Points], sweep: float, radius: float, tolerance: float
) -> Points:
    """Points of a part of an ellipse.

    Args:
        where: points for parameters from 0 to 1.
        sweep: its angle, radians.
        radius: the greater one.
        tolerance: in the unit of the radius.
    """
    count = _count(abs(sweep) * math.sqrt(radius / (8 * tolerance)))
    return where(np.linspace(0.0, 1.0, max(count, 2) + 1))


def _count(wanted: float) -> int:
    return min(_MOST, max(1, math.ceil(wanted))) if math.isfinite(wanted) else _MOST


def simplified(points: Points, tolerance: float) -> Points:
    """Fewer points: those left out are nowhere further from the lines than this.

    Ramer, Douglas and Peucker; a ring is halved at the point that is furthest from its first.

    Args:
        points: (n, 2).
        tolerance: in their unit.
    """
    if len(points) < 3:
        return points
    keep = np.zeros(len(points), np.bool_)
    keep[0] = keep[-1] = True
    waiting = [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        away = _away(points[first + 1 : last], points[first], points[last])
        number = int(away.argmax())
        if away[number] > tolerance:
            middle = first + 1 + number
            keep[middle] = True
            waiting += [(first, middle), (middle, last)]
    return points[keep]


def _away(points: Points, begin: Points, end: Points) -> Points:
    """How far points are from a line between two others."""
    way, there = end - begin, points - begin
    square = float(way @ way)
    if not square:
        return np.hypot(there[:, 0], there[:, 1])
    share = np.clip(there @ way / square, 0.0, 1.0)
    rest = there - share[:, None] * way
    return np.hypot(rest[:, 0], rest[:, 1])
