"""What the tool does, move by move, before it is text; and what it comes to."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from fraese.engrave.shapes import Path, chords, one, straight

#: Kinds of moves, by their word.
RAPID: Final = "G0"
FEED: Final = "G1"
CLOCKWISE: Final = "G2"
COUNTER: Final = "G3"
#: Arcs of other radii are made of lines, mm: smaller ones are refused, greater ones are none.
_RADII_MM: Final = (0.02, 10_000.0)
#: Where the ends of an arc fall together when they are written, another one would be cut.
_NEAR_MM: Final = 0.003


class Move(NamedTuple):
    """A move of the tool; None: as before.

    Attributes:
        kind: its word.
        x: where it ends, mm,
        y: likewise,
        z: and likewise.
        centre: of an arc.
        power: of a laser; 0: it is dark.
        feed: mm/min; None of a rapid.
        cuts: it cuts, or burns.
    """

    kind: str
    x: float | None = None
    y: float | None = None
    z: float | None = None
    centre: tuple[float, float] | None = None
    power: float | None = None
    feed: float | None = None
    cuts: bool = False


def follow(
    path: Path, feed: float, power: float | None, tolerance_mm: float, *, cuts: bool
) -> Iterator[Move]:
    """The moves along a path, from its beginning."""
    made = _writable(path, tolerance_mm)
    for (x, y), centre, turn in zip(
        made.points[1:].tolist(), made.centres.tolist(), made.turns.tolist(), strict=True
    ):
        if turn:
            kind = COUNTER if turn > 0 else CLOCKWISE
            yield Move(kind, x, y, None, (centre[0], centre[1]), power, feed, cuts)
        else:
            yield Move(FEED, x, y, None, None, power, feed, cuts)


def _writable(path: Path, tolerance_mm: float) -> Path:
    """The same with arcs that come out as they are when they are written."""
    if not path.turns.any():
        return path
    return one([part for n in range(len(path.turns)) for part in _pieces(path, n, tolerance_mm)])


def _pieces(path: Path, number: int, tolerance_mm: float) -> Iterator[Path]:
    piece = Path(
        path.points[number : number + 2],
        path.centres[number : number + 1],
        path.turns[number : number + 1],
    )
    if not piece.turns[0]:
        yield piece
        return
    radius, length = float(piece.radii[0]), float(piece.lengths[0])
    apart = float(math.dist(piece.points[0], piece.points[1]))
    if not _RADII_MM[0] <= radius <= _RADII_MM[1] or length <= _NEAR_MM:
        yield straight(piece.flattened(tolerance_mm))
    elif apart and apart <= _NEAR_MM:
        middle = piece.at(length / 2)
        for begin, end in ((piece.points[0], middle), (middle, piece.points[1])):
            yield Path(np.array((begin, end)), piece.centres, piece.turns)
    else:
        yield piece


@dataclass
class Figures:
    """What moves come to.

    Attributes:
        cut_mm: way with the tool in the work,
        rapid_mm: and by rapids.
        moves: how many.
    """

    cut_mm: float = 0.0
    rapid_mm: float = 0.0
    moves: int = 0

    def __post_init__(self) -> None:
        self._at = (0.0, 0.0, 0.0)

    def take(self, move: Move) -> None:
        """The next one."""
        x, y, z = self._at
        to = (x if move.x is None else move.x, y if move.y is None else move.y)
        there = (*to, z if move.z is None else move.z)
        length = arc_mm(move, (x, y), to) if move.centre else math.dist(self._at, there)
        if move.cuts:
            self.cut_mm += length
        elif move.kind == RAPID:
            self.rapid_mm += length
        self.moves += 1
        self._at = there


def sweep(move: Move, begin: tuple[float, float], end: tuple[float, float]) -> float:
    """Angle of an arc, radians, counter-clockwise positive; back at its begin: a full turn."""
    assert move.centre is not None
    cx, cy = move.centre
    sign = 1 if move.kind == COUNTER else -1
    turned = math.atan2(end[1] - cy, end[0] - cx) - math.atan2(begin[1] - cy, begin[0] - cx)
    swept = math.fmod(sign * turned, 2 * math.pi)
    if swept <= 0:
        swept += 2 * math.pi
    return sign * (2 * math.pi if begin == end else swept)


def arc_mm(move: Move, begin: tuple[float, float], end: tuple[float, float]) -> float:
    """Length of an arc."""
    assert move.centre is not None
    return math.dist(begin, move.centre) * abs(sweep(move, begin, end))


def way_of(
    move: Move, begin: tuple[float, float], end: tuple[float, float], tolerance_mm: float
) -> list[tuple[float, float]]:
    """The points of straight lines along a move, its ends among them."""
    if move.centre is None:
        return [begin, end]
    (cx, cy), angle = move.centre, sweep(move, begin, end)
    radius = math.dist(begin, move.centre)
    first = math.atan2(begin[1] - cy, begin[0] - cx)
    count = chords(radius, angle, tolerance_mm)
    return [
        (
            cx + radius * math.cos(first + angle * number / count),
            cy + radius * math.sin(first + angle * number / count),
        )
        for number in range(count + 1)
    ]
