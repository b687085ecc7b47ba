"""Look-ahead for ramps that are no straight lines: how far each reaches, its law says.

The rules are those of ``lookahead.py``. With constant acceleration squared speeds add up, and that
is written out there, since every line of every program comes by. Here the law is asked.
"""

from typing import Final

from fraese.planner.laws import Law
from fraese.planner.lookahead import Window
from fraese.planner.options import Options
from fraese.planner.segments import Limits, Segment
from fraese.planner.timing import BlockMaker

_SAME: Final = 1 + 1e-9
_TURNS: Final = 40
#: Rates from which ramps are tried, and what may lie between them.
_LOWS: Final = 8
_MORE: Final = 1.02


class ShapedWindow(Window):
    """See ``Window``.

    Args:
        law: of all ramps.
    """

    def __init__(
        self,
        limits: Limits,
        maker: BlockMaker,
        most: int,
        min_block_s: float,
        batch_s: float,
        law: Law,
    ) -> None:
        super().__init__(limits, maker, most, min_block_s, batch_s)
        self._law = law

    def ramp_mm(self, segment: Segment) -> float:
        """Length of the longest ramp to the speed that is wanted there.

        Not that from standstill: at a higher rate the acceleration takes more way to come and go.
        """
        wanted = self._wanted(segment, segment.top_mm_s**2)
        lows = [wanted * (k / _LOWS) ** 2 for k in range(_LOWS)]
        return _MORE * max(self._law.way(low, wanted, segment.twice_mm_s2) for low in lows)

    def _speeds(self) -> tuple[list[float], list[float], int]:
        segments, limits, law = self._segments, self._entry, self._law
        last = len(segments) - 1
        speed = min(segments[last].rest_mm_s ** 2, self._cruise[last])
        braking = [speed] * (last + 1)
        for k in range(last, 0, -1):
            segment = segments[k]
            speed = min(limits[k], law.reached2(speed, segment.twice_mm_s2, segment.length_mm))
            braking[k - 1] = speed
        entries, exits = [], []
        settled = 0
        speed = self._first_entry
        for k in range(last + 1):
            entries.append(speed)
            segment, bound = segments[k], braking[k]
            reached = law.reached2(speed, segment.twice_mm_s2, segment.length_mm)
            if k < last:
                reached = min(reached, limits[k + 1])
                if reached <= bound:
                    settled = k + 1
            speed = self._at_least(segment, speed, min(reached, bound))
            exits.append(speed)
            if k < last and speed > self._corner[k + 1] * _SAME:
                speed = self._restart(k, speed)
        return entries, exits, settled

    def _at_least(self, segment: Segment, entry: float, wanted: float) -> float:
        """The wanted exit, or the lowest to which a segment can brake (rule 4)."""
        law, twice, way = self._law, segment.twice_mm_s2, segment.length_mm
        if wanted >= entry or law.reached2(wanted, twice, way) * _SAME >= entry:
            return wanted
        low, high = wanted, entry
        for _ in range(_TURNS):
            middle = (low + high) / 2
            enough = law.reached2(middle, twice, way) >= entry
            low, high = (low, middle) if enough else (middle, high)
        return high


def window_for(law: Law | None, limits: Limits, maker: BlockMaker, options: Options) -> Window:
    """The window for ramps of a law; None: of constant acceleration."""
    sizes = options.window, options.min_block_s, options.batch_s
    if law is None:
        return Window(limits, maker, *sizes)
    return ShapedWindow(limits, maker, *sizes, law)
