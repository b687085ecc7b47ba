"""When a program comes to which of its moves, as planned: what progress is told by.

    move     1 ....... 40 ....... 80 ....... end
    feed_s   0         12         30         55      acted on by the feed override
    rapid_s  0          3          4          9      by that of the rapids
    fixed_s  0          2          2          4      by none: dwells, M49

Rule 1: memory is bounded: with too many entries every other one is left out.
Rule 2: between two entries the time passes evenly.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from fraese.blocks import Block
from fraese.control.jobs import move_of
from fraese.planner.lines import planned_s

#: Entries at most.
_MOST: Final = 1 << 12


@dataclass(frozen=True)
class Timetable:
    """Seconds up to the beginning of moves, at 100 %.

    Attributes:
        moves: their numbers, ascending; the last one is behind the end.
        seconds: (n, 3): feed, rapid, fixed.
    """

    moves: NDArray[np.int64]
    seconds: NDArray[np.float64]

    @property
    def total_s(self) -> float:
        """All of it at 100 %."""
        return float(self.seconds[-1].sum())

    def progress(
        self, move: int, in_move_s: float, *, feed: float, rapid: float
    ) -> tuple[float, float]:
        """The share that is done, and how long the rest takes; see ``control.jobs.Plan``."""
        here, behind = self._at(move), self._at(max(move, 0) + 1)
        whole_s = float((behind - here).sum())
        share = min(1.0, in_move_s / whole_s) if whole_s > 0 else 0.0
        left = self.seconds[-1] - (here + (behind - here) * share)
        share = 1 - float(left.sum()) / self.total_s if self.total_s > 0 else 0.0
        return share, float(left[0] / feed + left[1] / rapid + left[2])

    def _at(self, move: int) -> NDArray[np.float64]:
        return np.array([np.interp(move, self.moves, column) for column in self.seconds.T])


class TimetableMaker:
    """Makes a timetable of blocks as they pass."""

    def __init__(self) -> None:
        self._sums = [0.0, 0.0, 0.0]
        self._moves = [1]
        self._seconds = [(0.0, 0.0, 0.0)]
        self._stride = 1
        self._last = 1

    @property
    def total_s(self) -> float:
        """So far."""
        return sum(self._sums)

    def take(self, block: Block) -> None:
        """The next block."""
        move = move_of(block.tag)
        if move - self._moves[-1] >= self._stride:
            self._moves.append(move)
            self._seconds.append((self._sums[0], self._sums[1], self._sums[2]))
            if len(self._moves) > _MOST:
                self._thin()
        self._last = max(self._last, move)
        kind = 1 if block.is_rapid else 0 if block.override_q8 else 2
        self._sums[kind] += planned_s(block)

    def _thin(self) -> None:
        self._stride = max(2 * self._stride, 2 * (self._last // _MOST))
        self._moves = self._moves[::2]
        self._seconds = self._seconds[::2]

    def timetable(self) -> Timetable:
        """What there is."""
        moves = [*self._moves, max(self._last, self._moves[-1]) + 1]
        seconds = [*self._seconds, tuple(self._sums)]
        return Timetable(np.array(moves, np.int64), np.array(seconds, np.float64))
