"""Paths: straight pieces and arcs, one behind the other.

    points   p0 ---- p1 ~~~~ p2 ---- p3        n points
    turns        0       1       0             n - 1 pieces: 0 straight, 1 counter-clockwise, -1
    centres      -       c       -             where it turns round; NaN of a straight piece

Rule 1: a path is closed if its last point is its first one, exactly.
Rule 2: an arc that ends exactly where it begins is a full turn.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]

_TURN: Final = 2 * math.pi
#: An arc of a smaller share of its radius than this is told from a full turn by its points only.
_QUARTERS: Final = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Path:
    """A way without a gap, mm.

    Attributes:
        points: (n, 2), n at least 1: one point alone is a dot.
        centres: (n - 1, 2).
        turns: (n - 1).
    """

    points: Points
    centres: Points
    turns: NDArray[np.int8]

    @property
    def is_closed(self) -> bool:
        """It ends where it begins."""
        return len(self.points) > 1 and bool((self.points[0] == self.points[-1]).all())

    @cached_property
    def sweeps(self) -> Points:
        """(n - 1) angles of the arcs, radians, counter-clockwise positive; 0 of straight pieces."""
        begin = self.points[:-1] - self.centres
        end = self.points[1:] - self.centres
        angles = np.arctan2(end[:, 1], end[:, 0]) - np.arctan2(begin[:, 1], begin[:, 0])
        swept = np.mod(angles * self.turns, _TURN)
        swept[(self.points[:-1] == self.points[1:]).all(axis=1)] = _TURN
        return np.where(self.turns == 0, 0.0, swept * self.turns)

    @cached_property
    def radii(self) -> Points:
        """(n - 1) radii of the arcs, mm; 0 of a straight piece."""
        away = self.points[:-1] - self.centres
        return np.where(self.turns == 0, 0.0, np.hypot(away[:, 0], away[:, 1]))

    @cached_property
    def lengths(self) -> Points:
        """(n - 1) lengths of the pieces, mm."""
        way = np.diff(self.points, axis=0)
        if not self.turns.any():
            return np.hypot(way[:, 0], way[:, 1])
        return np.where(
            self.turns == 0, np.hypot(way[:, 0], way[:, 1]), self.radii * abs(self.sweeps)
        )

    @property
    def length_mm(self) -> float:
        """From end to end."""
        return float(self.lengths.sum())

    @cached_property
    def bounds(self) -> tuple[Points, Points]:
        """Lower left and upper right corner of what it covers."""
        covered = [self.points]
        for number in np.flatnonzero(self.turns):
            covered.append(self._extremes(int(number)))
        every = np.concatenate(covered)
        return every.min(axis=0), every.max(axis=0)

    def _extremes(self, number: int) -> Points:
        """Where an arc is furthest out, as far as it comes there."""
        begin = self.points[number] - self.centres[number]
        first, sweep = math.atan2(begin[1], begin[0]), float(self.sweeps[number])
        turn = int(self.turns[number])
        come = np.mod((np.arange(4) * _TURN / 4 - first) * turn, _TURN) <= abs(sweep)
        return np.asarray(self.centres[number] + self.radii[number] * _QUARTERS[come])

    def placed(self, scale: float, shift: ArrayLike) -> "Path":
        """Scaled about zero, and then moved."""
        by = np.asarray(shift, np.float64)
        return Path(self.points * scale + by, self.centres * scale + by, self.turns)

    def reversed(self) -> "Path":
        """The same way back."""
        return Path(self.points[::-1], self.centres[::-1], -self.turns[::-1])

    def begun_at(self, number: int) -> "Path":
        """A closed path, begun at another of its points."""
        if not number:
            return self
        points = np.concatenate((self.points[number:], self.points[1 : number + 1]))
        return Path(points, np.roll(self.centres, -number, axis=0), np.roll(self.turns, -number))

    def flattened(self, tolerance_mm: float) -> Points:
        """(m, 2) points of straight lines that are nowhere further off than this."""
        if not self.turns.any():
            return self.points
        parts = [self.points[:1]]
        for number, turn in enumerate(self.turns):
            if turn:
                parts.append(self._chords(number, tolerance_mm))
            parts.append(self.points[number + 1 : number + 2])
        return np.concatenate(parts)

    def _chords(self, number: int, tolerance_mm: float) -> Points:
        """The points between the ends of an arc."""
        radius, sweep = float(self.radii[number]), float(self.sweeps[number])
        count = chords(radius, sweep, tolerance_mm)
        begin = self.points[number] - self.centres[number]
        angles = math.atan2(begin[1], begin[0]) + sweep * np.arange(1, count) / count
        around: Points = np.column_stack((np.cos(angles), np.sin(angles)))
        return np.asarray(self.centres[number] + radius * around)

    def part(self, begin_mm: float, end_mm: float) -> "Path":
        """What lies between these lengths from its start."""
        after = np.cumsum(self.lengths)
        before = after - self.lengths
        kept = np.flatnonzero((after > begin_mm) & (before < end_mm))
        if not len(kept):
            return dot(self.at(begin_mm))
        points = [self.at(begin_mm), *self.points[kept[1:]], self.at(end_mm)]
        return Path(np.array(points), self.centres[kept], self.turns[kept])

    def at(self, way_mm: float) -> Points:
        """The point so far from its start; its ends further out."""
        after = np.cumsum(self.lengths)
        there: Points = self.points[0 if way_mm <= 0 else -1]
        if way_mm <= 0 or not len(after) or way_mm >= after[-1]:
            return there
        number = int(np.searchsorted(after, way_mm, side="right"))
        length = float(self.lengths[number])
        share = (way_mm - float(after[number]) + length) / length
        begin, end = self.points[number], self.points[number + 1]
        if not self.turns[number]:
            return np.asarray(begin + (end - begin) * share)
        angle = float(self.sweeps[number]) * share
        c, s = math.cos(angle), math.sin(angle)
        x, y = begin - self.centres[number]
        return np.asarray(self.centres[number] + np.array((c * x - s * y, s * x + c * y)))


def chords(radius: float, sweep: float, tolerance: float) -> int:
    """So many straight lines an arc takes."""
    if radius <= tolerance:
        return max(1, math.ceil(abs(sweep) / (_TURN / 4)))
    return max(1, math.ceil(abs(sweep) / (2 * math.acos(1 - tolerance / radius))))


def dot(point: ArrayLike) -> Path:
    """One point."""
    return straight(np.asarray(point, np.float64).reshape(1, 2))


def straight(points: ArrayLike, *, close: bool = False) -> Path:
    """Straight lines from point to point."""
    at = np.asarray(points, np.float64).reshape(-1, 2)
    if close and len(at) > 1 and (at[0] != at[-1]).any():
        at = np.concatenate((at, at[:1]))
    pieces = max(0, len(at) - 1)
    return Path(at, np.full((pieces, 2), np.nan), np.zeros(pieces, np.int8))


def arc(begin: ArrayLike, end: ArrayLike, centre: ArrayLike, turn: int) -> Path:
    """One arc; a full turn if it ends exactly where it begins."""
    points = np.array((begin, end), np.float64)
    return Path(points, np.array((centre,), np.float64), np.array((turn,), np.int8))


def circle(centre: Sequence[float], radius: float) -> Path:
    """A full turn, counter-clockwise, from its rightmost point."""
    begin = (centre[0] + radius, centre[1])
    return arc(begin, begin, centre, 1)


def one(paths: Sequence[Path]) -> Path:
    """Paths that go on where the one before ends, as one; the ends before count."""
    if len(paths) == 1:
        return paths[0]
    points = [paths[0].points, *(path.points[1:] for path in paths[1:])]
    return Path(
        np.concatenate(points),
        np.concatenate([path.centres for path in paths]),
        np.concatenate([path.turns for path in paths]),
    )


def bounds(paths: Iterable[Path]) -> tuple[Points, Points]:
    """Lower left and upper right corner of them all; of none, zero."""
    corners = [path.bounds for path in paths]
    if not corners:
        return np.zeros(2), np.zeros(2)
    low, high = zip(*corners, strict=True)
    return np.min(low, axis=0), np.max(high, axis=0)
