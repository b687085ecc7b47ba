r"""Time laws: what the leading axis does along a line, as pieces of integers.

    rate  |      ________
          |     /        \        v(k) = sqrt(v0^2 + 2 a k) after k ticks;
          |    /          \       tick k comes at (v(k) - v0) / a
          |___/            \___
          +-----------------------> ticks

Rule 1: within a piece the interval changes by the same amount each tick; the true law is convex,
        so a chord lies above it: what is played is never faster than what was meant.
Rule 2: a piece ends where the squared rate has grown by ``_GROWTH``. The chord is then at most
        0.4 % slower than the law, and its slope, the acceleration, at most 15 % steeper at one end.
Rule 3: a braking ramp is the mirror image of the same ramp upwards, to the cycle.
"""

import math
from typing import Final

from fraese.blocks import CYCLES_PER_S, Q8, Piece

_GROWTH: Final = 0.2


def interval_q8(rate_hz: float) -> int:
    """Interval of a rate, in 1/256 cycle, rounded up to the slower side."""
    return math.ceil(CYCLES_PER_S * Q8 / rate_hz)


def ramp_up(start_hz: float, acceleration_hz_s: float, ticks: int) -> list[Piece]:
    """Constant acceleration over so many ticks, upwards from a start rate.

    Args:
        start_hz: rate at the beginning, steps/s; may be 0.
        acceleration_hz_s: positive, steps/s**2.
        ticks: length of the ramp.
    """
    squared, twice = start_hz * start_hz, 2 * acceleration_hz_s

    def interval_to(tick: int) -> int:
        # Difference of two square roots without cancellation.
        after, before = math.sqrt(squared + twice * tick), math.sqrt(squared + twice * (tick - 1))
        return math.ceil(2 * CYCLES_PER_S * Q8 / (after + before))

    pieces = []
    done = 0
    while done < ticks:
        span = max(1, int((squared / twice + done) * _GROWTH))
        last = min(ticks, done + span + 1)
        count = last - done
        first_q8, last_q8 = interval_to(done + 1), interval_to(last)
        add_q8 = -((first_q8 - last_q8) // (count - 1)) if count > 1 else 0
        pieces.append(Piece(count, first_q8, add_q8))
        done = last
    return pieces


def mirrored(pieces: list[Piece]) -> list[Piece]:
    """The same ramp downwards."""
    return [piece.mirrored() for piece in reversed(pieces)]


def trapezoid(
    ticks: int, entry_hz: float, cruise_hz: float, exit_hz: float, acceleration_hz_s: float
) -> list[Piece]:
    """Accelerate, cruise, brake, over exactly so many ticks.

    Args:
        ticks: length, at least 1.
        entry_hz: rate at the beginning, at most ``cruise_hz``,
        cruise_hz: highest rate,
        exit_hz: rate at the end, likewise; both reachable from each other within ``ticks``.
        acceleration_hz_s: of both ramps.
    """
    twice = 2 * acceleration_hz_s
    up = int((cruise_hz**2 - entry_hz**2) / twice)
    down = int((cruise_hz**2 - exit_hz**2) / twice)
    if up + down > ticks:
        # No room to reach the cruise rate: the ramps meet where they have the same rate.
        up = min(ticks, max(0, int((ticks + (exit_hz**2 - entry_hz**2) / twice) / 2)))
        down = min(ticks - up, max(0, ticks - up))
        cruise_hz = min(cruise_hz, math.sqrt(entry_hz**2 + twice * up))
    flat = ticks - up - down
    pieces = ramp_up(entry_hz, acceleration_hz_s, up)
    if flat:
        pieces.append(Piece(flat, interval_q8(cruise_hz)))
    return pieces + mirrored(ramp_up(exit_hz, acceleration_hz_s, down))
