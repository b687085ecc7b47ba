r"""Merging of nearly collinear points (G64 P), before anything is rounded to steps.

          * . *                 points between anchor and candidate stay within the tolerance
     *--´-------`-----*         of the straight line that replaces them; a point beyond either
    anchor        candidate     end of the line is as far away as from that end

A chain has a bounded number of points, so that a long circle of short lines costs no more for
each of them than any other program.
"""

from typing import Final

from fraese.planner.arcs import Point

#: Points that one line can replace.
_LONGEST_CHAIN: Final = 32


def distance2_mm2(point: Point, start: Point, end: Point) -> float:
    """Square of the distance of a point from a stretch of straight line."""
    if len(point) == 3:
        return _in_space(point, start, end)
    way = [b - a for a, b in zip(start, end, strict=True)]
    off = [b - a for a, b in zip(start, point, strict=True)]
    length2 = sum([mm * mm for mm in way])
    if length2:
        along = sum([a * b for a, b in zip(off, way, strict=True)]) / length2
        along = 0.0 if along < 0 else min(along, 1.0)
        off = [a - along * b for a, b in zip(off, way, strict=True)]
    return sum([mm * mm for mm in off])


def _in_space(point: Point, start: Point, end: Point) -> float:
    """The same written out for three axes, what most machines have."""
    x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    px, py, pz = point[0] - start[0], point[1] - start[1], point[2] - start[2]
    length2 = x * x + y * y + z * z
    if length2:
        along = (px * x + py * y + pz * z) / length2
        along = 0.0 if along < 0 else min(along, 1.0)
        px, py, pz = px - along * x, py - along * y, pz - along * z
    return px * px + py * py + pz * pz


class Chain:
    """Points that wait to be replaced by one line.

    Attributes:
        end: the last of them, where the line would go; None: nothing waits.
        feed_mm_s: their common feed.
        tag: of the first one.
    """

    def __init__(self) -> None:
        self._anchor: Point = ()
        self._between: list[Point] = []
        self.end: Point | None = None
        self.feed_mm_s = 0.0
        self.tag = 0

    def begin(self, anchor: Point, end: Point, feed_mm_s: float, tag: int) -> None:
        """Start a chain with its first line."""
        self._anchor, self.end, self.feed_mm_s, self.tag = anchor, end, feed_mm_s, tag
        self._between = []

    def take(self, end: Point, feed_mm_s: float, tolerance_mm: float) -> bool:
        """Go on to another point; False: it does not fit, the chain is as it was."""
        if self.end is None or feed_mm_s != self.feed_mm_s:
            return False
        if len(self._between) >= _LONGEST_CHAIN:
            return False
        limit2 = tolerance_mm * tolerance_mm
        points = [*self._between, self.end]
        if any(distance2_mm2(point, self._anchor, end) > limit2 for point in points):
            return False
        self._between, self.end = points, end
        return True
