r"""Time laws: what the leading axis does along a line, as pieces of integers.

    rate  |      ________
          |     /        \        v(k)^2 = v0^2 + 2 a k after k ticks; so squared rates
          |    /          \       are what is added up here, and a root is drawn only
          |___/            \___   where an interval is needed
          +-----------------------> ticks

Rule 1: within a piece the interval changes by the same amount each tick; the true law is convex,
        so a chord lies above it: what is played is never faster than what was meant.
Rule 2: a piece ends where the squared rate has grown by ``GROWTH``. Along a chord the
        acceleration goes with the cube of the rate: it is at most 9 % too steep at its fast end
        and as much too flat at its slow end.
Rule 3: a braking ramp is the mirror image of the same ramp upwards, to the cycle.
Rule 4: a motor is not torn from acceleration into braking (X4Step): where both meet before the
        cruise rate is reached, ``CREST_TICKS`` ticks at constant rate come in between.
"""

import math
from typing import Final

from fraese.blocks import CYCLES_PER_S, Q8, Piece

#: Ticks at constant rate between acceleration and braking on a short move.
CREST_TICKS: Final = 4

#: A piece ends where the squared rate has grown by this share.
GROWTH: Final = 0.125
#: Each tick of a piece may lose 1/256 cycle to the rounding of ``add``: never more than one cycle.
_MOST_TICKS: Final = Q8 + 1
#: Units of an interval in a second.
UNITS_PER_S: Final = CYCLES_PER_S * Q8
_TWICE_UNITS: Final = 2 * UNITS_PER_S
#: An interval must fit 32 bits without sign: the slowest rate is a little under one tick a second.
_LONGEST_Q8: Final = 0xFFFF_FFFF

#: The same in ticks a second.
SLOWEST_HZ: Final = UNITS_PER_S / _LONGEST_Q8

_new = tuple.__new__
_sqrt = math.sqrt
_ceil = math.ceil


def interval_q8(rate_hz: float) -> int:
    """Interval of a rate, in 1/256 cycle, rounded up to the slower side."""
    return min(_LONGEST_Q8, math.ceil(UNITS_PER_S / rate_hz))


def ramp_up(start_hz2: float, twice_hz_s: float, ticks: int) -> list[Piece]:
    """Constant acceleration over so many ticks, upwards from a start rate.

    Args:
        start_hz2: square of the rate at the beginning, (ticks/s)**2; may be 0.
        twice_hz_s: two times the acceleration, positive, ticks/s**2.
        ticks: length of the ramp; 0 gives no piece.
    """
    pieces: list[Piece] = []
    per_tick = GROWTH / twice_hz_s
    squared, rate = start_hz2, _sqrt(start_hz2)
    done = 0
    while done < ticks:
        count = int(squared * per_tick) + 2
        if count > _MOST_TICKS:
            count = _MOST_TICKS
        if count > ticks - done:
            count = ticks - done
        # A tick takes 2 / (v0 + v1): the difference of two roots without cancellation.
        first_q8 = _ceil(_TWICE_UNITS / (rate + _sqrt(squared + twice_hz_s)))
        done += count
        squared = start_hz2 + twice_hz_s * done
        rate = _sqrt(squared)
        add_q8 = 0
        if first_q8 > _LONGEST_Q8:
            first_q8 = _LONGEST_Q8
        elif count > 1:
            last_q8 = _ceil(_TWICE_UNITS / (_sqrt(squared - twice_hz_s) + rate))
            add_q8 = (first_q8 - last_q8) // (count - 1)
        pieces.append(_new(Piece, (count, first_q8, -add_q8)))
    return pieces


def mirrored(pieces: list[Piece]) -> list[Piece]:
    """The same ramp downwards."""
    return [
        _new(Piece, (ticks, interval_q8 + (ticks - 1) * add_q8, -add_q8))
        for ticks, interval_q8, add_q8 in reversed(pieces)
    ]


def _ramp_ticks(length: float, edge_hz2: float, cruise_hz2: float, twice_hz_s: float) -> int:
    """Whole ticks of a ramp that is ``length`` ticks long.

    To the nearest tick: the interval of a tick is that of its middle, so neither is the cruise
    rate exceeded nor is there more than one tick's acceleration between two ticks. The tick next
    to the edge is one of the ramp whenever it is slower than cruising, even a little: at a
    standstill it is what keeps to the start/stop rate.
    """
    ticks = int(length + 0.5)
    if not ticks and length > 0:
        mean_hz = (_sqrt(edge_hz2) + _sqrt(edge_hz2 + twice_hz_s)) / 2
        return int(mean_hz * mean_hz < cruise_hz2)
    return ticks


def time_law(
    ticks: int, entry_hz2: float, cruise_hz2: float, exit_hz2: float, twice_hz_s: float
) -> list[Piece]:
    """Accelerate, cruise, brake, over exactly so many ticks.

    Args:
        ticks: length, at least 1.
        entry_hz2: square of the rate at the beginning, (ticks/s)**2; if it is above the cruise
            rate (a feed that was lowered on the way), braking comes first,
        cruise_hz2: of the highest rate wanted,
        exit_hz2: of the rate at the end; reachable from the first within ``ticks``.
        twice_hz_s: two times the acceleration of both ramps, ticks/s**2.
    """
    if entry_hz2 > cruise_hz2:
        return _brake_first(ticks, entry_hz2, cruise_hz2, exit_hz2, twice_hz_s)
    up = (cruise_hz2 - entry_hz2) / twice_hz_s
    down = max(0.0, (cruise_hz2 - exit_hz2) / twice_hz_s)
    crest = 0.0
    if up + down > ticks:
        # No room to reach the cruise rate: the ramps meet where they have the same rate.
        up = min(float(ticks), max(0.0, (ticks + (exit_hz2 - entry_hz2) / twice_hz_s) / 2))
        down = ticks - up
        crest = min(CREST_TICKS / 2, up, down)
        up, down = up - crest, down - crest
        # From rest to rest within a tick the mean rate squared is an eighth of ``twice_hz_s``.
        cruise_hz2 = min(cruise_hz2, max(entry_hz2 + twice_hz_s * up, twice_hz_s / 8))
    ticks_up = _ramp_ticks(up, entry_hz2, cruise_hz2, twice_hz_s)
    ticks_down = min(
        ticks - ticks_up - int(2 * crest), _ramp_ticks(down, exit_hz2, cruise_hz2, twice_hz_s)
    )
    flat = ticks - ticks_up - ticks_down
    pieces = ramp_up(entry_hz2, twice_hz_s, ticks_up) if ticks_up else []
    if flat:
        pieces.append(_new(Piece, (flat, interval_q8(_sqrt(cruise_hz2)), 0)))
    if ticks_down:
        pieces += mirrored(ramp_up(exit_hz2, twice_hz_s, ticks_down))
    return pieces


def trapezoid(
    ticks: int, entry_hz: float, cruise_hz: float, exit_hz: float, acceleration_hz_s: float
) -> list[Piece]:
    """The same with plain rates, for a line of its own."""
    return time_law(ticks, entry_hz**2, cruise_hz**2, exit_hz**2, 2 * acceleration_hz_s)


def _brake_first(
    ticks: int, entry_hz2: float, cruise_hz2: float, exit_hz2: float, twice_hz_s: float
) -> list[Piece]:
    """The law of a block that is entered faster than it should go."""
    needed = math.ceil((entry_hz2 - cruise_hz2) / twice_hz_s)
    if needed >= ticks:
        return mirrored(ramp_up(max(0.0, entry_hz2 - twice_hz_s * ticks), twice_hz_s, ticks))
    reached_hz2 = max(0.0, entry_hz2 - twice_hz_s * needed)
    braking = mirrored(ramp_up(reached_hz2, twice_hz_s, needed))
    rest = time_law(ticks - needed, reached_hz2, cruise_hz2, exit_hz2, twice_hz_s)
    return braking + rest
