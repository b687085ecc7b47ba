"""Paths put together where their ends meet, and without what nobody could cut.

Drawings are made of loose lines and arcs: a rectangle is four of them. Cut one by one, the tool
would rise at every corner, and nothing would be closed.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from fraese.engrave.shapes import Path, Points, one

#: Ends that are no further apart than this meet, mm.
MEETING_MM: Final = 0.005
#: Edges whose lengths differ by a smaller share are as long.
_ALIKE: Final = 0.01

End = tuple[int, bool]


def chained(paths: Sequence[Path], meeting_mm: float = MEETING_MM) -> list[Path]:
    """The same ways in as few paths as there can be; what is closed stays as it is.

    Args:
        paths: in the order of the drawing, which is kept as far as it can be.
        meeting_mm: ends that are no further apart than this meet.
    """
    ends = _Ends(paths, meeting_mm)
    made = []
    for number, path in enumerate(paths):
        if number not in ends.open:
            if path.is_closed or len(path.points) == 1:
                made.append(path)
            continue
        ends.open.discard(number)
        made.append(_chain(number, paths, ends, meeting_mm))
    return made


class _Ends:
    """Where open paths end, by cells that are as wide as ends may be apart."""

    def __init__(self, paths: Sequence[Path], meeting_mm: float) -> None:
        self._paths = paths
        self._meeting_mm = meeting_mm
        self._cells: dict[tuple[int, int], list[End]] = {}
        self.open = {
            n for n, path in enumerate(paths) if len(path.points) > 1 and not path.is_closed
        }
        for number in sorted(self.open):
            for last in (False, True):
                cell = self._cell(paths[number].points[-1 if last else 0])
                self._cells.setdefault(cell, []).append((number, last))

    def meeting(self, point: Points) -> End | None:
        """An end of a path that is still open, at this point."""
        x, y = self._cell(point)
        for cell in ((x + dx, y + dy) for dx in (0, -1, 1) for dy in (0, -1, 1)):
            for number, last in self._cells.get(cell, ()):
                if number not in self.open:
                    continue
                end = self._paths[number].points[-1 if last else 0]
                if np.hypot(*(end - point)) <= self._meeting_mm:
                    return number, last
        return None

    def _cell(self, point: Points) -> tuple[int, int]:
        x, y = np.floor(point / self._meeting_mm)
        return int(x), int(y)


def _chain(number: int, paths: Sequence[Path], ends: _Ends, meeting_mm: float) -> Path:
    links = deque([paths[number]])
    while (met := ends.meeting(links[-1].points[-1])) is not None:
        ends.open.discard(met[0])
        links.append(paths[met[0]].reversed() if met[1] else paths[met[0]])
    while (met := ends.meeting(links[0].points[0])) is not None:
        ends.open.discard(met[0])
        links.appendleft(paths[met[0]] if met[1] else paths[met[0]].reversed())
    path = one(list(links))
    begin, end = path.points[0], path.points[-1]
    if len(path.points) > 2 and np.hypot(*(end - begin)) <= meeting_mm:
        points = path.points.copy()
        points[-1] = begin
        return Path(points, path.centres, path.turns)
    return path


def unlike(rings: Sequence[Path], known: Sequence[Path], apart_mm: float) -> list[Path]:
    """Closed paths that are not drawn already, each once.

    The edge of a fill is often drawn as a line, too: cut twice it would be too deep, and a sweep
    would take what lies in both for outside.

    Args:
        rings: what is asked about.
        known: what is drawn.
        apart_mm: boxes that differ by no more, and whose edges are as long, are of the same path.
    """
    there = [path for path in known if path.is_closed]
    made: list[Path] = []
    extents = np.array([_extent(path) for path in there + list(rings)]).reshape(-1, 5)
    is_there = np.arange(len(extents)) < len(there)
    for number, ring in enumerate(rings, len(there)):
        away = np.abs(extents[is_there] - extents[number])
        same = (away[:, :4] <= apart_mm).all(axis=1)
        if not (same & (away[:, 4] <= _ALIKE * extents[number, 4])).any():
            made.append(ring)
            is_there[number] = True
    return made


def _extent(path: Path) -> list[float]:
    low, high = path.bounds
    return [*low, *high, path.length_mm]


def cleaned(paths: Sequence[Path], least_mm: float) -> Iterator[Path]:
    """Without pieces that are shorter than this, and without what is left with no length.

    A dot stays a dot; an arc whose ends fall together stays, if it is a turn.
    """
    for path in paths:
        lengths = path.lengths
        if not len(lengths):
            yield path
            continue
        short = lengths < least_mm
        if not short.any():
            yield path
        elif not short.all():
            yield _without(path, short)


def _without(path: Path, short: np.ndarray) -> Path:
    """Pieces left out: those that follow begin where they would have ended."""
    kept = np.flatnonzero(~short)
    points = np.concatenate((path.points[:1], path.points[kept + 1]))
    points[-1] = path.points[-1]
    return Path(points, path.centres[kept], path.turns[kept])
