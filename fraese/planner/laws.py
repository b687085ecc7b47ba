r"""Laws of a ramp: how acceleration comes and goes on the way from one rate to another.

    acceleration   linear  +--------+      sine   _.-""-._      s-curve    +----+
                           |        |           .'        '.              /      \
                         --+        +--      --'            '--        --/        \--

Rule 1: no law goes above the acceleration of the axes, at its peak either. Where it takes its time
        to come there, the ramp is longer.
Rule 2: a law is symmetric in time: so the way of a ramp is its time at the mean of both rates,
        braking is the mirror image of the way up, and all that the look-ahead must know is how far
        a ramp reaches: ``reached2`` and its inverse ``way``.
Rule 3: what a law says holds for a ramp within one block. On a curve of many short lines a ramp has
        no room to come and go in each of them: there the acceleration is constant within a line,
        and not above that of the law in the mean.
Rule 4: rates, ways and accelerations are in whatever unit goes together: mm, or ticks; times in s.
        Rates are squared where the look-ahead adds them up.

Another law is a class like these, and a row in ``peers.py: RAMPS`` (or an entry point).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple, Protocol

from fraese.machine import Machine
from fraese.peers import RAMPS

#: A ramp that is over sooner is played with constant acceleration.
SHORTEST_S: Final = 0.02


class Shape(NamedTuple):
    """A ramp over its time, both from 0 to 1.

    Attributes:
        gained: share of the change of rate after a share of the time.
        way: its integral.
    """

    gained: Callable[[float], float]
    way: Callable[[float], float]


class Law(Protocol):
    """How a ramp goes."""

    def reached2(self, rate2: float, twice: float, way: float) -> float:
        """Square of the highest rate behind a ramp of that length.

        Args:
            rate2: square of the rate before it.
            twice: two times the acceleration that must not be exceeded.
            way: its length.
        """

    def way(self, low2: float, high2: float, twice: float) -> float:
        """Length of the shortest ramp between two squared rates; nothing if they are equal."""

    def shape(self, low: float, high: float, twice: float, time_s: float) -> Shape | None:
        """How a ramp between two rates goes in that time; None: with constant acceleration."""


@dataclass(frozen=True)
class RampKind:
    """A law that can be chosen.

    Attributes:
        make: the law, by the shortest time in which the acceleration comes to its full value, s;
            None: constant acceleration, which has code of its own.
    """

    make: Callable[[float], Law] | None


class Sine:
    """The acceleration is half a period of a sine: its mean is 2/pi of its peak."""

    mean = 2 / math.pi

    def reached2(self, rate2: float, twice: float, way: float) -> float:
        """See ``Law``."""
        return rate2 + self.mean * twice * way

    def way(self, low2: float, high2: float, twice: float) -> float:
        """See ``Law``."""
        return max(0.0, high2 - low2) / (self.mean * twice)

    def shape(self, low: float, high: float, twice: float, time_s: float) -> Shape | None:
        """See ``Law``."""
        return HALF_SINE if time_s >= SHORTEST_S else None


def _sine_gained(share: float) -> float:
    return (1 - math.cos(math.pi * share)) / 2


def _sine_way(share: float) -> float:
    return share / 2 - math.sin(math.pi * share) / (2 * math.pi)


HALF_SINE: Final = Shape(_sine_gained, _sine_way)


class SCurve:
    """The acceleration rises steadily, stays, and falls: the jerk is limited.

    From nothing to the full acceleration it takes ``jerk_s``, so the jerk is never more than the
    acceleration of the axes divided by that. A ramp too short for that does not come to the full
    acceleration. Where even half of it, constant, would reach further, that is played: see rule 3.

    Args:
        jerk_s: the shortest time from nothing to the full acceleration.
    """

    #: Share of the full acceleration on ways that are too short for any shape.
    constant = 0.5

    def __init__(self, jerk_s: float) -> None:
        self._jerk_s = jerk_s

    def reached2(self, rate2: float, twice: float, way: float) -> float:
        """See ``Law``."""
        low = math.sqrt(rate2)
        high = low + self._gain(low, twice / 2, way)
        return max(high * high, rate2 + self.constant * twice * way)

    def _gain(self, low: float, accel: float, way: float) -> float:
        """By how much the rate grows in a ramp of that length, with limited jerk."""
        jerk_s = self._jerk_s
        # With a stretch at full acceleration: way = (2 low + gain) / 2 * (gain / accel + jerk_s).
        half = low / accel + jerk_s / 2
        gain = accel * (math.sqrt(half * half + 2 * (way - low * jerk_s) / accel) - half) if (
            way > low * jerk_s
        ) else 0.0  # fmt: skip
        if gain >= accel * jerk_s:
            return gain
        # Without: way = (2 low + gain) * sqrt(gain * jerk_s / accel), a cubic in sqrt(gain).
        part, whole = 2 * low, way * math.sqrt(accel / jerk_s)
        if part <= 1e-9 * whole:
            return math.cbrt(whole) ** 2
        third = math.sqrt(part / 3)
        root = 2 * third * math.sinh(math.asinh(1.5 * whole / (part * third)) / 3)
        return root * root

    def way(self, low2: float, high2: float, twice: float) -> float:
        """See ``Law``."""
        if high2 <= low2:
            return 0.0
        low, high, accel = math.sqrt(low2), math.sqrt(high2), twice / 2
        gain, jerk_s = high - low, self._jerk_s
        full = gain >= accel * jerk_s
        time_s = gain / accel + jerk_s if full else 2 * math.sqrt(gain * jerk_s / accel)
        return min((low + high) / 2 * time_s, (high2 - low2) / (self.constant * twice))

    def shape(self, low: float, high: float, twice: float, time_s: float) -> Shape | None:
        """See ``Law``: the one with the least jerk that keeps to the acceleration."""
        gain, accel = high - low, twice / 2
        rise = min(0.5, 1 - gain / (accel * time_s))
        jerk = gain / (rise * (1 - rise) * time_s * time_s) if rise > 0 else math.inf
        if time_s < SHORTEST_S or jerk > accel / self._jerk_s * _SAME:
            return None
        return trapezoid_shape(rise)


#: Jerks this close are the same: ramps are whole ticks long.
_SAME: Final = 1.1


def trapezoid_shape(rise: float) -> Shape:
    """A ramp whose acceleration rises in a share of its time, up to a half, and falls likewise."""
    peak = 1 / (1 - rise)

    def gained(share: float) -> float:
        if share < rise:
            return peak * share * share / (2 * rise)
        if share > 1 - rise:
            return 1 - gained(1 - share)
        return peak * (share - rise / 2)

    def way(share: float) -> float:
        if share < rise:
            return peak * share**3 / (6 * rise)
        if share > 1 - rise:
            return share - 0.5 + way(1 - share)
        return peak * (rise * rise / 6 + share * (share - rise) / 2)

    return Shape(gained, way)


def law_of(machine: Machine) -> Law | None:
    """The law of a machine's ramps; None: constant acceleration.

    Raises:
        ConfigError: if it lives in a package that cannot be used.
    """
    kind = RAMPS.record(machine.ramp)
    assert isinstance(kind, RampKind)
    return None if kind.make is None else kind.make(machine.jerk_s)


LINEAR: Final = RampKind(None)
SINE: Final = RampKind(lambda jerk_s: Sine())
S_CURVE: Final = RampKind(SCurve)
