r"""Figures of a line over a stretch: edges, rate, duty, pulses, set-up.

         shortest high            shortest low
          |<---->|             |<------------->|
        __/~~~~~~\_____________/~~~~~~~~~\____/~~~
          |<--- period ------->|
    direction ==X====
                |<-->| set-up: to the next edge of the clock away from where it rests

Rule 1: only whole pulses are measured: both their edges lie within the stretch.
Rule 2: everything is added up piece by piece; no edge is kept.
Rule 3: moments and lengths are in units of the file here.
"""

from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fraese.waves.vcdfile import Changes


class Edges(NamedTuple):
    """Edges of a line: when, and whether they rose."""

    at: NDArray[np.int64]
    rose: NDArray[np.bool_]


NO_EDGES: Final = Edges(np.empty(0, np.int64), np.empty(0, np.bool_))


@dataclass
class Shortest:
    """The shortest of some lengths, and when it began.

    Attributes:
        length: None: there was none.
        at: its begin.
        count: of how many.
    """

    length: int | None = None
    at: int = 0
    count: int = 0

    def see(self, lengths: NDArray[np.int64], begins: NDArray[np.int64]) -> None:
        """Some more."""
        self.count += len(lengths)
        if not len(lengths):
            return
        place = int(lengths.argmin())
        if self.length is None or lengths[place] < self.length:
            self.length, self.at = int(lengths[place]), int(begins[place])


@dataclass
class LineFigures:
    """Of a line that is high or low.

    Attributes:
        level: at the begin of the stretch, later at its end; nan: not known.
        edges: how many, and ``rising`` of them.
        first_edge: when; None: there is none.
        high: the shortest pulse; ``low``: the shortest pause; ``period``: from rise to rise.
    """

    level: float
    edges: int = 0
    rising: int = 0
    first_edge: int | None = None
    last_edge: int | None = None
    first_rise: int | None = None
    last_rise: int | None = None
    high: Shortest = field(default_factory=Shortest)
    low: Shortest = field(default_factory=Shortest)
    period: Shortest = field(default_factory=Shortest)
    _last_rose: bool = False
    _high_length: int = 0
    _last_high: tuple[int, int] = (-1, 0)

    def see(self, changes: Changes) -> Edges:
        """Changes of a piece; its edges."""
        at, values = changes
        before = np.concatenate(([self.level], values[:-1]))
        self.level = float(values[-1])
        # From or to what is not known is no edge.
        is_edge = (before + values == 1) & (before != values)
        edges = Edges(at[is_edge], values[is_edge] == 1)
        if len(edges.at):
            self._see_edges(*edges)
        return edges

    def _see_edges(self, edges: NDArray[np.int64], rises: NDArray[np.bool_]) -> None:
        moments, kinds = edges, rises
        if self.last_edge is not None:
            moments = np.concatenate(([self.last_edge], edges))
            kinds = np.concatenate(([self._last_rose], rises))
        # Where a line was not known in between, there is no whole pulse.
        whole = kinds[1:] != kinds[:-1]
        lengths, begins = np.diff(moments), moments[:-1]
        lows, highs = whole & kinds[1:], whole & ~kinds[1:]
        self.low.see(lengths[lows], begins[lows])
        self.high.see(lengths[highs], begins[highs])
        self._high_length += int(lengths[highs].sum())
        if highs.any():
            self._last_high = int(begins[highs][-1]), int(lengths[highs][-1])
        self._see_rises(edges[rises])
        self.edges += len(edges)
        self.rising += int(rises.sum())
        if self.first_edge is None:
            self.first_edge = int(edges[0])
        self.last_edge, self._last_rose = int(edges[-1]), bool(rises[-1])

    def _see_rises(self, rises: NDArray[np.int64]) -> None:
        if not len(rises):
            return
        known = [] if self.last_rise is None else [self.last_rise]
        moments = np.concatenate((np.array(known, np.int64), rises))
        self.period.see(np.diff(moments), moments[:-1])
        if self.first_rise is None:
            self.first_rise = int(rises[0])
        self.last_rise = int(rises[-1])

    @property
    def duty(self) -> float | None:
        """How much of its periods it was high; None: there is no period."""
        if self.first_rise is None or self.last_rise is None or self.last_rise <= self.first_rise:
            return None
        begun, length = self._last_high
        whole = self._high_length - (length if begun == self.last_rise else 0)
        return whole / (self.last_rise - self.first_rise)

    @property
    def rate(self) -> float | None:
        """Rises a unit of time, on average from the first to the last."""
        if self.first_rise is None or self.last_rise is None or self.last_rise <= self.first_rise:
            return None
        return (self.rising - 1) / (self.last_rise - self.first_rise)


@dataclass
class QuantityFigures:
    """Of a number.

    Attributes:
        level: at the begin of the stretch, later at its end; nan: not known.
        changes: how many.
        least: and ``most``: the values that it had; nan: none is known.
    """

    level: float
    changes: int = 0
    least: float = float("nan")
    most: float = float("nan")

    def __post_init__(self) -> None:
        self.least = self.most = self.level

    def see(self, changes: Changes) -> Edges:
        """Changes of a piece; it has no edges."""
        self.changes += len(changes.at)
        known = changes.values[np.isfinite(changes.values)]
        if len(known):
            self.least = float(np.fmin(self.least, known.min()))
            self.most = float(np.fmax(self.most, known.max()))
        self.level = float(changes.values[-1])
        return NO_EDGES


@dataclass
class SetUp:
    """From a change of direction to the next edge of its clock that makes a step.

    Attributes:
        direction: number of the line.
        clock: likewise.
        rests_high: the clock does; then a falling edge makes a step.
        shortest: of all.
    """

    direction: int
    clock: int
    rests_high: bool = False
    shortest: Shortest = field(default_factory=Shortest)
    _waiting: NDArray[np.int64] = field(default_factory=lambda: NO_EDGES.at)

    def see(self, directions: Edges, clock: Edges) -> None:
        """Edges of both in a piece."""
        clocks = clock.at[clock.rose != self.rests_high]
        waiting = np.concatenate((self._waiting, directions.at))
        places = np.searchsorted(clocks, waiting, side="left")
        met = places < len(clocks)
        # Of several changes before an edge the last one counts.
        last = np.concatenate((places[1:] != places[:-1], [True])) if len(places) else met
        counts = met & last
        self.shortest.see(clocks[places[counts]] - waiting[counts], waiting[counts])
        self._waiting = waiting[~met][-1:]
