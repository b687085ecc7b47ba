"""A stretch of a waveform: looked through once, for figures and for a picture of any width.

Rule 1: a picture is columns. In each one there is how many edges a line has, and what it is at the
        end; that is all that can be seen, however many edges there are.
Rule 2: directions and clocks belong together by their names, or because somebody says so.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from fraese.errors import UsageError
from fraese.phrases import phrase
from fraese.waves.figures import NO_EDGES, Edges, LineFigures, QuantityFigures, SetUp
from fraese.waves.header import Line
from fraese.waves.vcdfile import Changes, Piece, VcdFile

_DIRECTION: Final = re.compile(r"direction|dir", re.IGNORECASE)
_CLOCK: Final = re.compile(r"clock|clk|step|pulse|pul", re.IGNORECASE)
_PIN: Final = re.compile(r"^.*?pin[0-9]+_|^.*\.")


@dataclass
class Columns:
    """A line as it can be seen.

    Attributes:
        level: at the left.
        edges: changes in each column.
        ends: value at the end of each column; nan: not known.
    """

    level: float
    edges: NDArray[np.int64]
    ends: NDArray[np.float64]

    def see(self, changes: Changes, places: NDArray[np.int64]) -> None:
        """Changes of a piece, and their columns."""
        self.edges += np.bincount(places, minlength=len(self.edges))
        # Of several in a column the last one stays.
        self.ends[places] = changes.values

    def finish(self) -> None:
        """A column without changes ends as the one before."""
        places = np.where(self.edges > 0, np.arange(len(self.edges)), -1)
        last = np.maximum.accumulate(places)
        self.ends = np.where(last < 0, self.level, self.ends[np.maximum(last, 0)])


@dataclass(frozen=True)
class Seen:
    """One line over the stretch."""

    line: Line
    figures: LineFigures | QuantityFigures
    columns: Columns

    @property
    def is_still(self) -> bool:
        """It never changes."""
        return not self.columns.edges.any()


class Stretch:
    """What there is to see and to measure between two moments.

    Args:
        file: of the waveform.
        start: first moment, in units of the file.
        end: last moment.
        width: columns of the picture.
        pairs: names of directions and their clocks, where their names do not tell.

    Attributes:
        seen: every line.
        set_ups: every direction that has a clock.

    Raises:
        UsageError: if a pair names a line that is none.
        TraceError: where the file is wrong.
    """

    def __init__(
        self,
        file: VcdFile,
        start: int,
        end: int,
        width: int,
        pairs: Sequence[tuple[str, str]] = (),
    ) -> None:
        self.file, self.start, self.end, self.width = file, start, end, width
        levels = file.levels(start)
        self.seen = tuple(
            Seen(line, _figures(line, level), _columns(level, width))
            for line, level in zip(file.lines, levels, strict=True)
        )
        # A clock rests as it does where the file begins.
        rest = file.levels(file.begin)
        self.set_ups = tuple(
            SetUp(direction, clock, rests_high=rest[clock] == 1)
            for direction, clock in (_named(file, pairs) or paired(file.lines))
        )
        for piece in file.pieces(start, end, levels):
            self._see(piece)
        for seen in self.seen:
            seen.columns.finish()

    @property
    def span_s(self) -> float:
        """How long it is."""
        return max(1, self.end - self.start) * self.file.unit_s

    def _see(self, piece: Piece) -> None:
        span = max(1, self.end - self.start)
        edges: dict[int, Edges] = {}
        for number, changes in piece.items():
            seen = self.seen[number]
            # Floats: the product of a long file's moments and the width needs more than 63 bits.
            places = ((changes.at - self.start) * (self.width / span)).astype(np.int64)
            seen.columns.see(changes, np.minimum(places, self.width - 1))
            edges[number] = seen.figures.see(changes)
        for set_up in self.set_ups:
            set_up.see(edges.get(set_up.direction, NO_EDGES), edges.get(set_up.clock, NO_EDGES))


def paired(lines: Sequence[Line]) -> list[tuple[int, int]]:
    """Directions and their clocks: names that differ in that word and the pin only."""
    clocks = {
        _CLOCK.sub("*", _bare(line.name), count=1): number
        for number, line in enumerate(lines)
        if line.is_bit and _CLOCK.search(_bare(line.name))
    }
    return [
        (number, clocks[key])
        for number, line in enumerate(lines)
        if line.is_bit
        and _DIRECTION.search(_bare(line.name))
        and (key := _DIRECTION.sub("*", _bare(line.name), count=1)) in clocks
    ]


def _bare(name: str) -> str:
    return _PIN.sub("", name).lower()


def number_of(file: VcdFile, name: str) -> int:
    """The line of that name, or the only one in whose name it is.

    Raises:
        UsageError: if there is none, or are several.
    """
    exact = [number for number, line in enumerate(file.lines) if line.name == name]
    found = exact or [n for n, line in enumerate(file.lines) if name.lower() in line.name.lower()]
    if len(found) == 1:
        return found[0]
    if found:
        several = ", ".join(file.lines[number].name for number in found)
        raise UsageError(
            phrase(
                '"{name}" may be one of several lines: {several}; say more of its name.',
                name=name,
                several=several,
            )
        )
    there = ", ".join(line.name for line in file.lines)
    raise UsageError(
        phrase(
            '{path} has no line "{name}"; there is {there}.', path=file.path, name=name, there=there
        )
    )


def _named(file: VcdFile, pairs: Sequence[tuple[str, str]]) -> list[tuple[int, int]]:
    return [(number_of(file, direction), number_of(file, clock)) for direction, clock in pairs]


def _figures(line: Line, level: float) -> LineFigures | QuantityFigures:
    return LineFigures(level) if line.is_bit else QuantityFigures(level)


def _columns(level: float, width: int) -> Columns:
    return Columns(level, np.zeros(width, np.int64), np.full(width, np.nan))
