"""Makes a timetable of blocks as they pass; what it is says ``timetable.py``.

Memory is bounded: with too many entries every other one is left out.
"""

from typing import Final

from fraese.blocks import Block
from fraese.control.jobs import move_of
from fraese.planner.lines import planned_s
from fraese.program.timetable import Timetable

#: Entries at most.
_MOST: Final = 1 << 12


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
