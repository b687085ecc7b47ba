"""Which points of a height map are wanted."""

import math
from dataclasses import dataclass

from fraese.errors import UsageError
from fraese.heightmap.heights import Flat
from fraese.heightmap.mapfile import MOST_POINTS, PartMap
from fraese.phrases import phrase


@dataclass(frozen=True, slots=True)
class Grid:
    """Which points are wanted, work coordinates.

    Attributes:
        from_mm: one corner, X and Y.
        to_mm: the opposite one.
        every_mm: points are no further apart than this.
        reference_mm: where the height is 0; None: at X0 Y0 if that lies inside, else at the corner
            that is nearest to it.
    """

    from_mm: Flat
    to_mm: Flat
    every_mm: float
    reference_mm: Flat | None = None

    def lines(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Where the columns and the rows are.

        Raises:
            UsageError: it has no width, or too many points.
        """
        if not self.every_mm > 0:
            raise UsageError(
                phrase("{every:g} mm from point to point: that is above 0.", every=self.every_mm)
            )
        corners = zip(self.from_mm, self.to_mm, strict=True)
        spans = [(min(places), max(places)) for places in corners]
        counts = []
        for name, (low, high) in zip("XY", spans, strict=True):
            if high - low < 1e-3:
                raise UsageError(
                    phrase(
                        "A height map goes from {name}{low:g} to {name}{low:g}: give two corners"
                        " that lie apart in X and in Y.",
                        name=name,
                        low=low,
                    )
                )
            counts.append(math.ceil((high - low) / self.every_mm - 1e-9))
        if (counts[0] + 1) * (counts[1] + 1) > MOST_POINTS:
            raise UsageError(
                phrase(
                    "A point every {every:g} mm makes more than {most} points: take fewer.",
                    every=self.every_mm,
                    most=MOST_POINTS,
                )
            )
        x_mm, y_mm = (
            tuple(round(low + (high - low) * n / count, 6) for n in range(count + 1))
            for (low, high), count in zip(spans, counts, strict=True)
        )
        return x_mm, y_mm

    def empty(self, system: int, origin_mm: Flat | None) -> PartMap:
        """A map of which nothing is probed yet.

        Args:
            system: number of the work offset in force.
            origin_mm: where their zero is; None: nobody knows.
        """
        x_mm, y_mm = self.lines()
        reference_mm = self.reference_mm or (_nearest(x_mm), _nearest(y_mm))
        nothing = ((None,) * len(x_mm),) * len(y_mm)
        return PartMap(x_mm, y_mm, nothing, reference_mm, system, origin_mm)


def _nearest(lines: tuple[float, ...]) -> float:
    return min(max(0.0, lines[0]), lines[-1])
