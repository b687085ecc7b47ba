"""Closed paths filled with parallel lines: what lies inside an odd number of them."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from fraese.engrave.shapes import Path, Points
from fraese.engrave.strokes import Row, Run
from fraese.errors import UsageError
from fraese.phrases import phrase

#: So many ends of lines fit in the memory that this may take.
_MOST: Final = 8_000_000
#: A shorter run is nothing that a tool could do, mm.
_LEAST_MM: Final = 1e-3


def hatched(
    rings: Sequence[Path],
    angle_deg: float,
    distance_mm: float,
    tolerance_mm: float,
    *,
    both_ways: bool,
) -> list[Row]:
    """Rows that fill what closed paths enclose.

    Args:
        rings: closed paths; what lies in two of them is outside, as the inside of a letter O.
        angle_deg: of the rows, counter-clockwise from X.
        distance_mm: from row to row.
        tolerance_mm: of the arcs.
        both_ways: every other row is cut backwards.

    Raises:
        UsageError: if they are too many.
    """
    if not rings:
        return []
    turn = math.radians(angle_deg)
    along, up = (math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))
    axes = np.array((along, up)).T
    edges = [(flat[:-1], flat[1:]) for flat in (p.flattened(tolerance_mm) @ axes for p in rings)]
    begin, end = (np.concatenate(points) for points in zip(*edges, strict=True))
    rows, places = crossings(begin, end, distance_mm)
    made = []
    for number, (row, at) in enumerate(_each(rows, places)):
        height = (row + 0.5) * distance_mm
        pairs = at[: len(at) // 2 * 2].reshape(-1, 2)
        runs = [Run(a, b, 1.0) for a, b in pairs.tolist() if b - a >= _LEAST_MM]
        if not runs:
            continue
        here = (up[0] * height, up[1] * height)
        made.append(
            _backwards(here, along, runs) if both_ways and number % 2 else Row(here, along, runs)
        )
    return made


def crossings(begin: Points, end: Points, distance: float) -> tuple[Points, Points]:
    """Which rows cross edges, and where along; both sorted by row and place.

    Args:
        begin: (n, 2) where edges begin,
        end: (n, 2) and end; along X, and up.
        distance: from row to row.

    Raises:
        UsageError: if they are too many.

    Row k is at (k + 0.5) distances. An edge has its lower end, and not its upper one: so a row
    through a corner meets two edges, or none.
    """
    low = np.minimum(begin[:, 1], end[:, 1])
    high = np.maximum(begin[:, 1], end[:, 1])
    first = np.ceil(low / distance - 0.5)
    counts = np.maximum(np.ceil(high / distance - 0.5) - first, 0).astype(np.int64)
    if counts.sum() > _MOST:
        raise UsageError(
            phrase(
                "That makes more than {most:g} lines; a greater --distance makes fewer.",
                most=_MOST // 2,
            )
        )
    which = np.repeat(np.arange(len(counts)), counts)
    starts = np.cumsum(counts) - counts
    rows = first[which] + np.arange(len(which)) - starts[which]
    share = ((rows + 0.5) * distance - begin[which, 1]) / (end[which, 1] - begin[which, 1])
    places = begin[which, 0] + (end[which, 0] - begin[which, 0]) * share
    order = np.lexsort((places, rows))
    return rows[order], places[order]


def _each(rows: Points, places: Points) -> Iterator[tuple[float, Points]]:
    """Row by row, where it crosses."""
    ends = np.flatnonzero(np.diff(rows)) + 1
    for part in np.split(np.arange(len(rows)), ends):
        if len(part):
            yield float(rows[part[0]]), places[part]


def _backwards(here: tuple[float, float], along: tuple[float, float], runs: Sequence[Run]) -> Row:
    """The same row from its far end."""
    turned = [Run(-run.end_mm, -run.begin_mm, run.strength) for run in reversed(runs)]
    return Row(here, (-along[0], -along[1]), turned)
