"""In which order paths are cut: what lies inside first, and then what is nearest.

Rule 1: a closed path is cut when all is cut that lies in it: what it cuts out may move then. Not
        among more than ``MOST_NESTED``.
Rule 2: among those that may be cut the nearest comes next. An open one may begin at either end, a
        closed one at several of its points.
"""

import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np

from fraese.engrave.shapes import Path, Points

#: More than this are outlines of specks: which lies in which takes long to find, and is of no use.
MOST_NESTED: Final = 5000
#: Points of a closed path at which it may begin.
_BEGINNINGS: Final = 8
#: Chords of arcs are off by this share of their path's size where it is asked what is inside.
_COARSE: Final = 0.002


class _Place(NamedTuple):
    """A point at which a path may begin."""

    x: float
    y: float
    path: int
    point: int


def ordered(paths: Sequence[Path], tell: Callable[[int], None] = lambda done: None) -> list[Path]:
    """The paths in the order in which they are cut, begun where they begin then.

    Args:
        paths: closed, open, and dots.
        tell: is told how many have their place.
    """
    outside = nesting(paths) if len(paths) <= MOST_NESTED else [[] for _ in paths]
    inside = np.bincount(
        np.array([n for holders in outside for n in holders], int), minlength=len(paths)
    )
    near = _Near([place for n in np.flatnonzero(inside == 0) for place in _places(paths, int(n))])
    at, made = (0.0, 0.0), list[Path]()
    while (place := near.nearest(*at)) is not None:
        near.remove(place.path)
        path = _begun(paths[place.path], place.point)
        made.append(path)
        tell(len(made))
        at = (float(path.points[-1, 0]), float(path.points[-1, 1]))
        for holder in outside[place.path]:
            inside[holder] -= 1
            if not inside[holder]:
                near.add(_places(paths, holder))
    return made


def _places(paths: Sequence[Path], number: int) -> list[_Place]:
    path = paths[number]
    last = len(path.points) - 1
    if path.is_closed:
        points = np.unique(np.linspace(0, last, min(last, _BEGINNINGS), endpoint=False).astype(int))
    else:
        points = np.unique((0, last))
    found = []
    for point in points.tolist():
        x, y = path.points[point].tolist()
        found.append(_Place(x, y, number, point))
    return found


def _begun(path: Path, point: int) -> Path:
    if path.is_closed:
        return path.begun_at(point)
    return path.reversed() if point else path


# --- what lies inside --------------------------------------------------------------------------


def nesting(paths: Sequence[Path]) -> list[list[int]]:
    """For each path the smallest closed one that it lies in; all of them, if some are the same."""
    if not paths:
        return []
    corners = np.array([np.concatenate(path.bounds) for path in paths])
    areas = np.prod(corners[:, 2:] - corners[:, :2], axis=1)
    closed = np.array([path.is_closed for path in paths])
    rings: dict[int, Points] = {}
    outside: list[list[int]] = []
    for number, path in enumerate(paths):
        x0, y0, x1, y1 = corners[number]
        around = (
            closed
            & (corners[:, 0] <= x0)
            & (corners[:, 1] <= y0)
            & (corners[:, 2] >= x1)
            & (corners[:, 3] >= y1)
            & (areas > areas[number])
        )
        fitting = np.flatnonzero(around)
        found: list[int] = []
        for candidate in fitting[np.argsort(areas[fitting])].tolist():
            if found and areas[candidate] > areas[found[0]]:
                break
            if holds(_ring_of(candidate, paths, rings), path.points[0]):
                found.append(candidate)
        outside.append(found)
    return outside


def _ring_of(number: int, paths: Sequence[Path], rings: dict[int, Points]) -> Points:
    """A closed path as straight lines, made once."""
    if number not in rings:
        low, high = paths[number].bounds
        rings[number] = paths[number].flattened(float((high - low).max()) * _COARSE)
    return rings[number]


def holds(ring: Points, point: Points) -> bool:
    """Whether a point lies in a closed line: a ray to the right meets it an odd number of times."""
    (x, y), begin, end = point, ring[:-1], ring[1:]
    crosses = (begin[:, 1] <= y) != (end[:, 1] <= y)
    begin, way = begin[crosses], (end - begin)[crosses]
    meets = begin[:, 0] + way[:, 0] * (y - begin[:, 1]) / way[:, 1] > x
    return bool(np.count_nonzero(meets) % 2)


# --- what is nearest ---------------------------------------------------------------------------


class _Near:
    """Places in square cells; the cells grow as places become few."""

    def __init__(self, places: list[_Place]) -> None:
        self._of: dict[int, list[_Place]] = {}
        self._lay(places)

    def _lay(self, places: list[_Place]) -> None:
        self._of.clear()
        self._cells: dict[tuple[int, int], list[_Place]] = {}
        self._least = len(places) // 4
        xs, ys = [p.x for p in places] or [0.0], [p.y for p in places] or [0.0]
        self._low = (min(xs), min(ys))
        wide = max(max(xs) - min(xs), max(ys) - min(ys), 1e-6)
        self._cell = wide / max(1.0, math.sqrt(len(places) / 2))
        self._count = 0
        self._first = self._last = (0, 0)
        self.add(places)

    def add(self, places: list[_Place]) -> None:
        for place in places:
            cell = self._at(place.x, place.y)
            self._cells.setdefault(cell, []).append(place)
            self._of.setdefault(place.path, []).append(place)
            self._first = (min(self._first[0], cell[0]), min(self._first[1], cell[1]))
            self._last = (max(self._last[0], cell[0]), max(self._last[1], cell[1]))
        self._count += len(places)

    def remove(self, path: int) -> None:
        """All places of a path."""
        gone = self._of.pop(path)
        for place in gone:
            cell = self._at(place.x, place.y)
            self._cells[cell].remove(place)
            if not self._cells[cell]:
                del self._cells[cell]
        self._count -= len(gone)
        if self._count < self._least:
            self._lay([place for places in self._of.values() for place in places])

    def nearest(self, x: float, y: float) -> _Place | None:
        """The nearest place; of several the one that came first in the drawing."""
        if not self._count:
            return None
        column, row = self._at(x, y)
        # Nothing lies nearer than the edge of what there is.
        ring = max(
            self._first[0] - column, column - self._last[0],
            self._first[1] - row, row - self._last[1], 0,
        )  # fmt: skip
        best: tuple[float, int, _Place] | None = None
        while best is None or ring <= best[0] / self._cell + 1:
            # Far from everything all cells are fewer than those of a ring.
            far_out = 8 * ring > len(self._cells)
            for cell in self._cells if far_out else _ring(column, row, ring):
                for place in self._cells.get(cell, ()):
                    far = math.hypot(place.x - x, place.y - y)
                    if best is None or (far, place.path) < best[:2]:
                        best = far, place.path, place
            if far_out:
                break
            ring += 1
        return best[2] if best else None

    def _at(self, x: float, y: float) -> tuple[int, int]:
        return (
            math.floor((x - self._low[0]) / self._cell),
            math.floor((y - self._low[1]) / self._cell),
        )


def _ring(column: int, row: int, ring: int) -> list[tuple[int, int]]:
    """Cells so far from one, all round."""
    if not ring:
        return [(column, row)]
    side = range(-ring, ring + 1)
    across = [(column + n, row + end) for n in side for end in (-ring, ring)]
    return across + [(column + end, row + n) for n in side[1:-1] for end in (-ring, ring)]
