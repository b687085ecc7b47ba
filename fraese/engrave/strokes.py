"""What is to be cut, before it is known with what: paths, and straight rows with gaps in them.

row   begin o------######----########---->  along
                   run 0     run 1             from, to in mm from begin; how strongly, 0 to 1
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fraese.engrave.shapes import Path


class Run(NamedTuple):
    """A part of a row.

    Attributes:
        begin_mm: where it begins,
        end_mm: and ends, from the beginning of the row; later.
        strength: how deep, or how strongly, above 0 to 1.
    """

    begin_mm: float
    end_mm: float
    strength: float


@dataclass(frozen=True)
class Row:
    """A straight line with runs on it.

    Attributes:
        begin: where it begins, mm.
        along: one mm of its direction.
        runs: in the order in which they come, at least one.
        pitch_mm: its runs are dots, so far apart; 0: they are lines.
    """

    begin: tuple[float, float]
    along: tuple[float, float]
    runs: Sequence[Run]
    pitch_mm: float = 0.0

    def at(self, way_mm: float) -> tuple[float, float]:
        """The point so far from its beginning."""
        return self.begin[0] + self.along[0] * way_mm, self.begin[1] + self.along[1] * way_mm


Stroke = Path | Row


class Strokes(NamedTuple):
    """All that is to be cut.

    Attributes:
        each: in the order in which it is cut.
        total: how many there are.
    """

    each: Iterable[Stroke]
    total: int
