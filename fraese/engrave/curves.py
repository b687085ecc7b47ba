"""Curves made into straight lines, and lines into fewer."""

import math
from collections.abc import Callable, Sequence
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


def simplified(lines: Sequence[Points], tolerance: float) -> list[Points]:
    """Fewer points: those left out are nowhere further from the lines than this.

    Ramer, Douglas and Peucker, for all lines at once: in each turn every part that is off by too
    much is divided where it is off most.

    Args:
        lines: (n, 2) each, n at least 2.
        tolerance: in their unit.
    """
    if not lines:
        return []
    points = np.concatenate(lines)
    ends = np.cumsum([len(line) for line in lines])
    keep = np.zeros(len(points), np.bool_)
    keep[ends - 1] = keep[ends[:-1]] = keep[0] = True
    open_ = np.flatnonzero(~keep)
    while len(open_):
        kept = np.flatnonzero(keep)
        part = (np.cumsum(keep) - 1)[open_]
        away = _away(points[open_], points[kept[part]], points[kept[part + 1]])
        first = np.flatnonzero(np.diff(part, prepend=-1))
        most = np.repeat(np.maximum.reduceat(away, first), np.diff(first, append=len(part)))
        off = most > tolerance
        tops = np.flatnonzero(off & (away == most))
        # Of several that are off as much, the first of each part.
        tops = tops[np.flatnonzero(np.diff(part[tops], prepend=-1))]
        keep[open_[tops]] = True
        off[tops] = False
        open_ = open_[off]
    return [
        points[b - len(line) : b][keep[b - len(line) : b]]
        for line, b in zip(lines, ends.tolist(), strict=True)
    ]


def _away(points: Points, begin: Points, end: Points) -> Points:
    """How far each point is from the line between two others."""
    way, there = end - begin, points - begin
    square = (way * way).sum(axis=1)
    share = np.clip((there * way).sum(axis=1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    rest = there - share[:, None] * way
    return np.asarray(np.hypot(rest[:, 0], rest[:, 1]))
