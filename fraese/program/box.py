"""A box that grows round moves."""

import math
from operator import ge, le

from fraese.workframe import Point


class Box:
    """Holds every move that it is told of.

    Args:
        axes: how many there are.
    """

    def __init__(self, axes: int) -> None:
        self._low: Point = (math.inf,) * axes
        self._high: Point = (-math.inf,) * axes
        # Where the last move ended: most begin there.
        self._end: Point = ()

    def take(self, start: Point, low: Point, high: Point, end: Point) -> None:
        """A move.

        Args:
            start: where it begins.
            low: corners of the rest of it.
            high: likewise.
            end: where it ends.
        """
        if start is not self._end:
            self._grow(start, start)
        self._end = end
        if not (all(map(le, self._low, low)) and all(map(ge, self._high, high))):
            self._grow(low, high)

    def _grow(self, low: Point, high: Point) -> None:
        self._low = tuple(map(min, self._low, low))
        self._high = tuple(map(max, self._high, high))

    @property
    def low_mm(self) -> Point | None:
        """Its lower corner; None: it holds nothing."""
        return self._low if self._end else None

    @property
    def high_mm(self) -> Point | None:
        """Its upper corner."""
        return self._high if self._end else None
