"""When a program comes to which of its moves, as planned: what progress is told by.

    move     1 ....... 40 ....... 80 ....... end
    feed_s   0         12         30         55      acted on by the feed override
    rapid_s  0          3          4          9      by that of the rapids
    fixed_s  0          2          2          4      by none: dwells, M49

Between two entries the time passes evenly. Who makes one is ``timetablemaker.py``.
"""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from operator import sub

#: Acted on by the feed override, by that of the rapids, by none.
_Seconds = tuple[float, float, float]


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
