r"""Time laws of ramps that are no straight lines, as pieces of integers.

    rate  |          ______
          |        .'      '.       pieces end where a share of the ramp's time is over: within one
          |      .'          '.     the acceleration is as good as constant
          |___.-'              '-.__
          +--------------------------> ticks

Rule 1: as in ``ramps.py``, all players play pieces: a ramp of another law is some pieces more, and
        nothing else knows of it.
Rule 2: the peak of the acceleration is that of the law, and not above that of the axes.
Rule 3: braking is the mirror image of the same ramp upwards, to the cycle.
"""

import math
from typing import Final

from fraese.blocks import Piece
from fraese.planner.laws import Law, Shape
from fraese.planner.ramps import CREST_TICKS, GROWTH, UNITS_PER_S, interval_q8, mirrored, ramp_up

#: Pieces of a ramp: so its acceleration is told to a tenth or so.
PIECES: Final = 16
#: With fewer ticks a ramp has no shape.
_FEWEST_TICKS: Final = 2 * PIECES
_MOST_TICKS: Final = 257
_MOST_PIECES: Final = 70
#: Ticks of a piece where the rate grows fast.
_FEWEST: Final = 2
_LONGEST_Q8: Final = 0xFFFF_FFFF
_TURNS: Final = 40


def shaped_law(
    law: Law, ticks: int, entry_hz2: float, cruise_hz2: float, exit_hz2: float, twice_hz_s: float
) -> list[Piece]:
    """Accelerate, cruise, brake, over exactly so many ticks.

    Args:
        law: of both ramps.
        ticks: length, at least 1.
        entry_hz2: square of the rate at the beginning, (ticks/s)**2,
        cruise_hz2: of the highest rate wanted,
        exit_hz2: of the rate at the end; reachable from the first within ``ticks``.
        twice_hz_s: two times the highest acceleration, ticks/s**2.
    """
    if entry_hz2 > cruise_hz2:
        return _brake_first(law, ticks, entry_hz2, cruise_hz2, exit_hz2, twice_hz_s)
    exit_hz2 = min(exit_hz2, cruise_hz2)
    up = law.way(entry_hz2, cruise_hz2, twice_hz_s)
    down = law.way(exit_hz2, cruise_hz2, twice_hz_s)
    if up + down > ticks:
        cruise_hz2 = _crest_hz2(law, ticks, entry_hz2, cruise_hz2, exit_hz2, twice_hz_s)
        up = law.way(entry_hz2, cruise_hz2, twice_hz_s)
        down = law.way(exit_hz2, cruise_hz2, twice_hz_s)
    ticks_up = min(ticks, math.ceil(up))
    ticks_down = min(ticks - ticks_up, math.ceil(down))
    flat = ticks - ticks_up - ticks_down
    pieces = _ramp(law, entry_hz2, cruise_hz2, twice_hz_s, ticks_up)
    if flat:
        slowest_hz = math.sqrt(twice_hz_s / 8)
        pieces.append(Piece(flat, interval_q8(max(math.sqrt(cruise_hz2), slowest_hz))))
    return pieces + mirrored(_ramp(law, exit_hz2, cruise_hz2, twice_hz_s, ticks_down))


def _crest_hz2(
    law: Law, ticks: int, entry_hz2: float, cruise_hz2: float, exit_hz2: float, twice_hz_s: float
) -> float:
    """Squared rate at which both ramps meet, with room for the crest where there is any."""
    low = max(entry_hz2, exit_hz2)
    high = max(low, cruise_hz2)
    room = max(ticks - CREST_TICKS, law.way(min(entry_hz2, exit_hz2), low, twice_hz_s))
    for _ in range(_TURNS):
        middle = (low + high) / 2
        needed = law.way(entry_hz2, middle, twice_hz_s) + law.way(exit_hz2, middle, twice_hz_s)
        low, high = (middle, high) if needed <= room else (low, middle)
    return low


def _brake_first(
    law: Law, ticks: int, entry_hz2: float, cruise_hz2: float, exit_hz2: float, twice_hz_s: float
) -> list[Piece]:
    """The law of a block that is entered faster than it should go."""
    needed = math.ceil(law.way(cruise_hz2, entry_hz2, twice_hz_s))
    if needed >= ticks:
        return mirrored(_ramp(law, min(exit_hz2, entry_hz2), entry_hz2, twice_hz_s, ticks))
    braking = mirrored(_ramp(law, cruise_hz2, entry_hz2, twice_hz_s, needed))
    return braking + shaped_law(
        law, ticks - needed, cruise_hz2, cruise_hz2, min(exit_hz2, cruise_hz2), twice_hz_s
    )


def _ramp(law: Law, low_hz2: float, high_hz2: float, twice_hz_s: float, ticks: int) -> list[Piece]:
    """One ramp upwards over exactly so many ticks."""
    if not ticks:
        return []
    low, high = math.sqrt(low_hz2), math.sqrt(high_hz2)
    time_s = 2 * ticks / (low + high)
    shape = None
    if high > low and ticks >= _FEWEST_TICKS:
        shape = law.shape(low, high, twice_hz_s, time_s)
    if shape is None:
        return ramp_up(low_hz2, max((high_hz2 - low_hz2) / ticks, 1e-9), ticks)
    return Ramp(low, high, ticks, shape).pieces()


class Ramp:
    """One ramp upwards.

    Args:
        low_hz: rate before it.
        high_hz: rate behind it.
        ticks: its length.
        shape: how it goes.
    """

    def __init__(self, low_hz: float, high_hz: float, ticks: int, shape: Shape) -> None:
        self._low, self._gain = low_hz, high_hz - low_hz
        self._ticks = ticks
        self._shape = shape
        self._time_s = 2 * ticks / (low_hz + high_hz)

    def done(self, share: float) -> float:
        """Ticks that are done after a share of the time."""
        return self._time_s * (self._low * share + self._gain * self._shape.way(share))

    def share_at(self, done: float) -> float:
        """The share of the time after which so many ticks are done."""
        low, high = 0.0, 1.0
        share = done / self._ticks
        for _ in range(_TURNS):
            over = self.done(share) - done
            low, high = (low, share) if over > 0 else (share, high)
            rate = self._low + self._gain * self._shape.gained(share)
            # Newton, and halves where that leads out: the first tick from rest has no rate.
            share -= over / (rate * self._time_s) if rate > 0 else 0.0
            if abs(over) < 1e-9 * self._ticks:
                break
            if not low < share < high:
                share = (low + high) / 2
        return share

    def pieces(self) -> list[Piece]:
        """Its ticks, none earlier by more than the chord of a piece."""
        ends = sorted({round(self.done(number / PIECES)) for number in range(1, PIECES)})
        # A block of two ramps fits a small bridge, whatever the rates.
        widest = math.log(self._rate2(self._ticks) / max(1.0, self._rate2(0))) / _MOST_PIECES
        growth = max(GROWTH, math.expm1(widest))
        pieces: list[Piece] = []
        begin = 0
        for end in (*(end for end in ends if 0 < end < self._ticks), self._ticks):
            while begin < end:
                count = self._count(begin, min(_MOST_TICKS, end - begin), growth)
                pieces.append(self._piece(begin, count))
                begin += count
        return pieces

    def _count(self, begin: int, most: int, growth: float) -> int:
        """Ticks of a piece: along a chord the acceleration goes with the cube of the rate."""
        here2 = self._rate2(begin)
        grown2 = self._rate2(begin + most) - here2
        while most > _FEWEST and grown2 > here2 * growth:
            most = max(_FEWEST, min(most - 1, int(most * here2 * growth / grown2) + 1))
            grown2 = self._rate2(begin + most) - here2
        return most

    def _rate2(self, done: int) -> float:
        """Squared rate after so many ticks."""
        rate = self._low + self._gain * self._shape.gained(self.share_at(done))
        return rate * rate

    def _piece(self, begin: int, count: int) -> Piece:
        first_q8 = self._interval_q8(begin)
        if count == 1:
            return Piece(1, first_q8)
        last_q8 = self._interval_q8(begin + count - 1)
        return Piece(count, first_q8, -(max(0, first_q8 - last_q8) // (count - 1)))

    def _interval_q8(self, tick: int) -> int:
        """Of the tick after so many."""
        passed_s = (self.share_at(tick + 1) - self.share_at(tick)) * self._time_s
        return min(_LONGEST_Q8, math.ceil(passed_s * UNITS_PER_S))
