r"""A grid of heights, and the surface between them.

    y_mm[1]  *----*--------*       heights_mm[row][column]: row by row along Y, in a row along X
             | .P |        |       between four of them bilinear: a straight line along X or Y is
    y_mm[0]  *----*--------*       straight on the surface, any other one a parabola
         x_mm[0]  [1]      [2]

Rule 1: X and Y are work coordinates; a height is that above the reference point, where Z0 is
        touched off. So neither another tool nor another Z zero makes the map wrong.
Rule 2: outside the grid the height of its edge holds.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from fraese.phrases import phrase
from fraese.workframe import SYSTEMS, Kept, WorkFrame

Flat = tuple[float, float]

#: Work zeros that are no further apart are the same.
_SAME_PLACE_MM = 0.1


@dataclass(frozen=True)
class HeightMap:
    """Heights of a surface.

    Attributes:
        x_mm: where the columns are, ascending; two at least.
        y_mm: where the rows are, likewise.
        heights_mm: row by row.
        reference_mm: X and Y of the point that has height 0.
        system: number of the work offset in which it was probed, 1 is G54.
        origin_mm: where the zero of X and Y was then, machine coordinates; None: nobody knew.
    """

    x_mm: tuple[float, ...]
    y_mm: tuple[float, ...]
    heights_mm: tuple[tuple[float, ...], ...]
    reference_mm: Flat = (0.0, 0.0)
    system: int = 1
    origin_mm: Flat | None = None

    def at(self, x_mm: float, y_mm: float) -> float:
        """Height of the surface there."""
        xs, ys = self.x_mm, self.y_mm
        x_mm = min(max(x_mm, xs[0]), xs[-1])
        y_mm = min(max(y_mm, ys[0]), ys[-1])
        column = min(bisect_right(xs, x_mm), len(xs) - 1) - 1
        row = min(bisect_right(ys, y_mm), len(ys) - 1) - 1
        a = (x_mm - xs[column]) / (xs[column + 1] - xs[column])
        b = (y_mm - ys[row]) / (ys[row + 1] - ys[row])
        near, far = self.heights_mm[row], self.heights_mm[row + 1]
        low = near[column] + (near[column + 1] - near[column]) * a
        high = far[column] + (far[column + 1] - far[column]) * a
        return low + (high - low) * b

    def beyond_mm(self, x_mm: float, y_mm: float) -> float:
        """How far a point lies outside the grid; 0: it lies inside."""
        xs, ys = self.x_mm, self.y_mm
        return max(xs[0] - x_mm, x_mm - xs[-1], ys[0] - y_mm, y_mm - ys[-1], 0.0)

    @cached_property
    def lowest_mm(self) -> float:
        """The lowest height."""
        return min(map(min, self.heights_mm))

    @cached_property
    def highest_mm(self) -> float:
        """The greatest height."""
        return max(map(max, self.heights_mm))

    @property
    def system_name(self) -> str:
        """G54 to G59.3."""
        return SYSTEMS[self.system - 1]

    def frame(self, kept: Kept, axes: str) -> WorkFrame:
        """The work coordinates in which it lies.

        Args:
            kept: parameters of the language, by number.
            axes: letters of the machine's axes.
        """
        return WorkFrame.of(kept, axes, self.system)

    # --- in words --------------------------------------------------------------------------------

    def in_words(self) -> str:
        """What it is: where, how many points, how warped."""
        return phrase(
            "{reach}, {columns} × {rows} points, {low:+.3f} to {high:+.3f} mm",
            reach=self.reach(),
            columns=len(self.x_mm),
            rows=len(self.y_mm),
            low=self.lowest_mm,
            high=self.highest_mm,
        )

    def reach(self) -> str:
        """From where to where it goes."""
        return reach_in_words(self.x_mm, self.y_mm)

    def reference_in_words(self) -> str:
        """The point at which Z0 is to be touched off."""
        x_mm, y_mm = self.reference_mm
        return f"X{x_mm:g} Y{y_mm:g}"

    def moved(self, kept: Kept, axes: str) -> str:
        """That its work zero has moved since, a sentence; empty: it has not, or nobody knows."""
        if self.origin_mm is None:
            return ""
        now_mm = origin_of(self.frame(kept, axes))
        if now_mm is None or math.dist(now_mm, self.origin_mm) <= _SAME_PLACE_MM:
            return ""
        return phrase(
            "The height map was probed with the zero of {system} at machine X {x:.3f} Y {y:.3f},"
            " which is now at X {x_now:.3f} Y {y_now:.3f}: the map has moved with it.",
            system=self.system_name,
            x=self.origin_mm[0],
            y=self.origin_mm[1],
            x_now=now_mm[0],
            y_now=now_mm[1],
        )


def origin_of(frame: WorkFrame) -> Flat | None:
    """Machine X and Y of the work zero; None: there are no such axes."""
    if not {"x", "y"} <= set(frame.axes):
        return None
    origin = frame.origin
    return origin[frame.axes.index("x")], origin[frame.axes.index("y")]


def reach_in_words(x_mm: Sequence[float], y_mm: Sequence[float]) -> str:
    """From where to where a grid goes."""
    return phrase(
        "X {x_low:g} to {x_high:g}, Y {y_low:g} to {y_high:g}",
        x_low=x_mm[0],
        x_high=x_mm[-1],
        y_low=y_mm[0],
        y_high=y_mm[-1],
    )
