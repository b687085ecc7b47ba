"""When a program comes to which of its moves, as planned: what progress is told by.

    move     1 ....... 40 ....... 80 ....... end
    feed_s   0         12         30         55      acted on by the feed override
    rapid_s  0          3          4          9      by that of the rapids
    fixed_s  0          2          2          4      by none: dwells, M49

Rule 1: memory is bounded: with too many entries every other one is left out.
Rule 2: between two entries the time passes evenly.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from operator import sub
from typing import Final

from fraese.blocks import Block
from fraese.control.jobs import move_of
from fraese.planner.lines import planned_s

#: Acted on by the feed override, by that of the rapids, by none.
_Seconds = tuple[float, float, float]

#: Entries at most.
_MOST: Final = 1 << 12


@dataclass(frozen=True)
class Timetable:
    """Seconds up to the beginning of moves, at 100 %.

    Attributes:
        moves: their numbers, ascending; the last one is behind the end.
        seconds: feed, rapid, fixed for each.
    """

    moves: Sequence[int]
    seconds: Sequence[_Seconds]

    @property
    def total_s(self) -> float:
        """All of it at 100 %."""
        return sum(self.seconds[-1])

    def progress(
        self, move: int, in_move_s: float, *, feed: float, rapid: float
    ) -> tuple[float, float]:
        """The share that is done, and how long the rest takes; see ``control.jobs.Plan``."""
        here, behind = self._at(move), self._at(max(move, 0) + 1)
        whole_s = sum(behind) - sum(here)
        done = _between(here, behind, min(1.0, in_move_s / whole_s) if whole_s > 0 else 0.0)
        left_feed_s, left_rapid_s, left_fixed_s = map(sub, self.seconds[-1], done)
        left_s = left_feed_s + left_rapid_s + left_fixed_s
        share = 1 - left_s / self.total_s if self.total_s > 0 else 0.0
        return share, left_feed_s / feed + left_rapid_s / rapid + left_fixed_s

    def _at(self, move: int) -> _Seconds:
        moves, seconds = self.moves, self.seconds
        after = bisect_right(moves, move)
        if not 0 < after < len(moves):
            return seconds[min(after, len(moves) - 1)]
        before = after - 1
        share = (move - moves[before]) / (moves[after] - moves[before])
        return _between(seconds[before], seconds[after], share)


def _between(one: _Seconds, other: _Seconds, share: float) -> _Seconds:
    a, b, c = (first + (second - first) * share for first, second in zip(one, other, strict=True))
    return a, b, c


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
        sums = self._sums
        if move - self._moves[-1] >= self._stride:
            self._moves.append(move)
            self._seconds.append((sums[0], sums[1], sums[2]))
            if len(self._moves) > _MOST:
                self._thin()
        if move > self._last:
            self._last = move
        sums[1 if block.is_rapid else 0 if block.override_q8 else 2] += planned_s(block)

    def _thin(self) -> None:
        self._stride = max(2 * self._stride, 2 * (self._last // _MOST))
        self._moves = self._moves[::2]
        self._seconds = self._seconds[::2]

    def timetable(self) -> Timetable:
        """What there is."""
        feed_s, rapid_s, fixed_s = self._sums
        moves = (*self._moves, max(self._last, self._moves[-1]) + 1)
        return Timetable(moves, (*self._seconds, (feed_s, rapid_s, fixed_s)))
