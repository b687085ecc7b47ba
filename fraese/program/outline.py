"""The outline of a program: where the tool goes, as far as a screen can show it.

    move, move ... --> points --> chunk --> cells --> outline
                                            the first point of each cell that the way goes through

Rule 1: memory is bounded: with too many points a cell grows to twice its edge, and what falls
        together becomes one. A program of a million lines is as large as one of ``MOST_POINTS``.
Rule 2: where a rapid begins or ends is kept, whatever the cells are.
Rule 3: a point knows the move that leads to it, so what is being made now is found by its number.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from fraese.gcode import canon
from fraese.planner.arcs import arc_shape, planes_of
from fraese.workframe import Point

#: Points of an outline at most.
MOST_POINTS: Final = 1 << 17
#: Points that wait for their turn.
_CHUNK: Final = 1 << 15
#: An arc has at least so many chords a turn: each is off by 0.3 % of the radius.
_CHORD_SHARE: Final = 0.003
#: The smallest cell there is, mm; the next has twice its edge.
_FIRST_CELL_MM: Final = 0.01
_FURTHEST_MM: Final = 1e7
#: The axes that are drawn.
AXES: Final = "xyz"


@dataclass(frozen=True)
class Outline:
    """A way in space; each point but the first is the end of a straight line.

    Attributes:
        points: (n, 3) of X, Y and Z, machine mm; an axis that the machine lacks is 0.
        moves: (n) number of the move that leads there, ascending.
        lines: (n) its line.
        rapid: (n) whether it is a rapid.
    """

    points: NDArray[np.float32]
    moves: NDArray[np.int32]
    lines: NDArray[np.int32]
    rapid: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.moves)


Motion = canon.Rapid | canon.Feed | canon.Arc | canon.Along | canon.Probe


class OutlineMaker:
    """Collects the outline of moves as they pass.

    Args:
        names: of the machine's axes.
        start: where the first move begins.
        most: points at most.
    """

    def __init__(self, names: Sequence[str], start: Point, most: int = MOST_POINTS) -> None:
        self._axes = [names.index(axis) if axis in names else None for axis in AXES]
        self._planes = planes_of(names)
        self._is_usual = tuple(names) == tuple(AXES)
        self._most = most
        self._cell_mm = 0.0
        self._kept = _thin(_outline([self._seen(start)], [0], [0], [True]), 0.0)
        self._at = start
        self._points: list[Point] = []
        self._moves: list[int] = []
        self._lines: list[int] = []
        self._rapid: list[bool] = []

    def take(self, move: Motion, number: int) -> None:
        """The next motion, and the number of its move."""
        if type(move) is canon.Arc:
            for corner in self._chords(move):
                self._add(corner, number, move.line, False)
        elif type(move) is canon.Along:
            for corner in move.points:
                self._add(corner, number, move.line, move.feed_mm_min is None)
        else:
            self._add(move.to, number, move.line, type(move) is canon.Rapid)
        self._at = move.to

    def outline(self) -> Outline:
        """What there is so far."""
        self._settle()
        return self._kept

    def _chords(self, arc: canon.Arc) -> Iterator[Point]:
        shape = arc_shape(self._at, arc.to, arc.centre, arc.plane, arc.turns, self._planes)
        return shape.corners(max(shape.radius_mm * _CHORD_SHARE, self._cell_mm / 2))

    def _add(self, point: Point, number: int, line: int, rapid: bool) -> None:
        self._points.append(point if self._is_usual else self._seen(point))
        self._moves.append(number)
        self._lines.append(line)
        self._rapid.append(rapid)
        if len(self._moves) >= _CHUNK:
            self._settle()

    def _seen(self, point: Point) -> Point:
        return tuple(0.0 if axis is None else point[axis] for axis in self._axes)

    def _settle(self) -> None:
        """Put away what waits, in cells that are large enough for all."""
        if not self._moves:
            return
        fresh = _outline(self._points, self._moves, self._lines, self._rapid)
        for waiting in (self._points, self._moves, self._lines, self._rapid):
            waiting.clear()
        fresh = _thin(fresh, self._cell_mm)
        before = self._kept
        kept = Outline(
            *(
                np.concatenate((getattr(before, name), getattr(fresh, name)))
                for name in ("points", "moves", "lines", "rapid")
            )
        )
        while len(kept) > self._most:
            self._cell_mm = max(_FIRST_CELL_MM, 2 * self._cell_mm)
            thinner = _thin(kept, self._cell_mm)
            if len(thinner) == len(kept) and self._cell_mm > _extent(kept):
                break
            kept = thinner
        self._kept = kept


def _outline(
    points: Sequence[Point], moves: Sequence[int], lines: Sequence[int], rapid: Sequence[bool]
) -> Outline:
    return Outline(
        # What lies further out is no place, and no number of so few digits.
        np.array(points, np.float64).clip(-_FURTHEST_MM, _FURTHEST_MM).astype(np.float32),
        np.array(moves, np.int32),
        np.array(lines, np.int32),
        np.array(rapid, np.bool_),
    )


def _extent(outline: Outline) -> float:
    return float(np.ptp(outline.points, axis=0).max())


def _thin(outline: Outline, cell_mm: float) -> Outline:
    """One point for each cell that the way enters."""
    if not cell_mm or len(outline) < 2:
        return outline
    cells = np.floor(outline.points / np.float32(cell_mm)).astype(np.int64)
    keep = np.ones(len(outline), np.bool_)
    keep[1:] = (cells[1:] != cells[:-1]).any(axis=1)
    changes = outline.rapid[1:] != outline.rapid[:-1]
    keep[:-1] |= changes
    keep[1:] |= changes
    keep[-1] = True
    return Outline(
        outline.points[keep], outline.moves[keep], outline.lines[keep], outline.rapid[keep]
    )
