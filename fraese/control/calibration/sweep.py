"""What a frequency test tries, and what it makes of it.

    START           no ramp: it starts and stops dead at each rate        -> start_rate_hz
    CRUISE          a ramp up to each rate, some time at it, down again   -> max_rate_hz, avoid_hz
    ACCELERATION    ramps of each steepness, up to the rate found         -> acceleration_hz_s

    good  good  LOST  LOST  good  good  good  LOST  LOST  LOST
                '--band--'                    '--stall-->

Rule 1: what is lost at the end of a sweep is the stall; what is lost before a value that went well
        is a resonance. Of accelerations the first that is lost is one too many.
Rule 2: a band reaches from the last good value below to the first one above.
Rule 3: a motor that works loses torque by load, warmth and age: what is proposed is a share of what
        it could do here, rounded down.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise
from typing import Any, Final

from fraese.control.calibration.proposal import Change, Proposal, proposal
from fraese.errors import LimitError
from fraese.machine import Axis
from fraese.phrases import joined, phrase

Band = tuple[float, float]

#: A band of rates is stayed in for so long, or as long as there is room for, but not less.
_KEEP_S: Final = (0.5, 0.1)
#: A stroke has so many steps at least: some electrical turns.
_LEAST_STEPS: Final = 64
_VALUES: Final = 40
_MOST_VALUES: Final = 1000
_MOST_BANDS: Final = 8


class Stage(Enum):
    """What is tried out, one after the other."""

    START = phrase("start/stop rate")
    CRUISE = phrase("highest rate")
    ACCELERATION = phrase("acceleration")

    @property
    def unit(self) -> str:
        """Of the values."""
        return phrase("steps/s²") if self is Stage.ACCELERATION else phrase("steps/s")


#: Share of what a motor followed that is proposed.
MARGINS: Final[Mapping[Stage, float]] = {
    Stage.START: 0.7,
    Stage.CRUISE: 0.75,
    Stage.ACCELERATION: 0.5,
}
#: From and to which share of the configured value is tried, if nothing else is wanted.
_RANGES: Final[Mapping[Stage, tuple[float, float]]] = {
    Stage.START: (0.125, 3.0),
    Stage.CRUISE: (0.0, 2.0),
    Stage.ACCELERATION: (0.5, 8.0),
}
_KEYS: Final[Mapping[Stage, str]] = {
    Stage.START: "start_rate_hz",
    Stage.CRUISE: "max_rate_hz",
    Stage.ACCELERATION: "acceleration_hz_s",
}


@dataclass(frozen=True, slots=True)
class Rates:
    """What an axis may do in a stroke, steps/s and steps/s**2."""

    start_hz: float
    rate_hz: float
    acceleration_hz_s: float

    def way_steps(self, room_steps: int) -> int:
        """A stroke that gets up to the rate and stays there for a while.

        Args:
            room_steps: the longest stroke that there is room for.

        Raises:
            LimitError: if there is no room for the shortest.
        """
        start_hz, rate_hz = min(self.start_hz, self.rate_hz), self.rate_hz
        ramps = (rate_hz**2 - start_hz**2) / self.acceleration_hz_s
        longest, shortest = (math.ceil(ramps + keep_s * rate_hz) for keep_s in _KEEP_S)
        if shortest > room_steps:
            raise LimitError(
                phrase(
                    "{rate_hz:g} steps/s with {acceleration_hz_s:g} steps/s² take a stroke"
                    " of {shortest} steps, and there is room for {room_steps}: try a lower"
                    " rate or a higher acceleration.",
                    rate_hz=rate_hz,
                    acceleration_hz_s=self.acceleration_hz_s,
                    shortest=shortest,
                    room_steps=room_steps,
                )
            )
        return min(room_steps, max(_LEAST_STEPS, longest))

    def fits(self, room_steps: int) -> bool:
        """There is room for it."""
        try:
            return self.way_steps(room_steps) > 0
        except LimitError:
            return False


@dataclass(frozen=True, slots=True)
class Sweep:
    """Values to be tried.

    Attributes:
        stage: what they are.
        values: from below to above.
        rates: of the axis; the value takes the place of one of them.
    """

    stage: Stage
    values: tuple[float, ...]
    rates: Rates

    def at(self, value: float) -> Rates:
        """What the axis may do where this value is tried."""
        rates = self.rates
        if self.stage is Stage.START:
            return Rates(value, value, rates.acceleration_hz_s)
        if self.stage is Stage.CRUISE:
            return Rates(rates.start_hz, value, rates.acceleration_hz_s)
        return Rates(rates.start_hz, rates.rate_hz, value)


@dataclass(frozen=True, slots=True)
class Wish:
    """What somebody wants tried; None: what is usual.

    Attributes:
        low: first value,
        high: last value,
        step: between two.
    """

    low: float | None = None
    high: float | None = None
    step: float | None = None


@dataclass(frozen=True, slots=True)
class Tried:
    """One value.

    Attributes:
        value: in the unit of its stage.
        lost_steps: what the switch tells of; 0: nothing, or nobody looked.
        marked: somebody heard or saw that it is bad.
        late: the computer did not keep up: it says nothing about the motor.
    """

    value: float
    lost_steps: int = 0
    marked: bool = False
    late: bool = False

    @property
    def is_bad(self) -> bool:
        """The motor did not follow, or not well."""
        return self.marked or bool(self.lost_steps)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a sweep.

    Attributes:
        sweep: what was tried.
        tried: as far as it came.
    """

    sweep: Sweep
    tried: tuple[Tried, ...] = ()

    @property
    def _limit(self) -> int:
        """How many of the values come before the stall."""
        bad = [each.is_bad for each in self.tried]
        if self.sweep.stage is Stage.ACCELERATION:
            return bad.index(True) if True in bad else len(bad)
        while bad and bad[-1]:
            bad.pop()
        return len(bad)

    @property
    def stall(self) -> float | None:
        """The first value that is too much; None: none was."""
        return self.tried[self._limit].value if self._limit < len(self.tried) else None

    @property
    def best(self) -> float | None:
        """The highest value that went well; None: none did."""
        good = [each.value for each in self.tried[: self._limit] if not each.is_bad]
        return good[-1] if good else None

    @property
    def bands(self) -> tuple[Band, ...]:
        """Where it resonates."""
        if self.sweep.stage is Stage.ACCELERATION:
            return ()
        found: list[Band] = []
        below = None
        tried = self.tried[: self._limit]
        for n, each in enumerate(tried):
            if not each.is_bad:
                below = each.value
                continue
            # The value before the first is one step below it.
            low = below if below is not None else max(1.0, 2 * each.value - tried[n + 1].value)
            high = next(other.value for other in tried[n:] if not other.is_bad)
            if not found or found[-1][1] != high:
                found.append((low, high))
        return tuple(found)

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        return {
            "stage": self.sweep.stage.name.lower(),
            "best": self.best,
            "stall": self.stall,
            "bands": [list(band) for band in self.bands],
            "tried": [
                {"value": each.value, "lost_steps": each.lost_steps, "marked": each.marked,
                 "late": each.late}
                for each in self.tried
            ],
        }  # fmt: skip

    def words(self) -> str:
        """What was found, a sentence."""
        stage, best, stall = self.sweep.stage, self.best, self.stall
        if not self.tried:
            return phrase("{stage}: nothing was tried.", stage=stage.value)
        if best is None:
            low = self.tried[0].value
            return phrase(
                "{stage}: bad at the lowest value already, {low:g}.", stage=stage.value, low=low
            )
        more = phrase(", and no more was tried")
        until = more if stall is None else phrase(", not at {stall:g}", stall=stall)
        ranges = [phrase("{low:g} to {high:g}", low=low, high=high) for low, high in self.bands]
        resonance = phrase("; resonance at {bands}", bands=joined(", ", ranges)) if ranges else ""
        return phrase(
            "{stage}: good up to {best:g} {unit}{until}{resonance}.",
            stage=stage.value,
            best=best,
            unit=stage.unit,
            until=until,
            resonance=resonance,
        )


def usual_sweep(
    stage: Stage, axis: Axis, found: Mapping[Stage, Outcome], wish: Wish, room_steps: int
) -> Sweep:
    """What is tried of an axis.

    Args:
        stage: what is wanted to be known.
        axis: as configured.
        found: in earlier stages.
        wish: what somebody wants otherwise.
        room_steps: the longest stroke that there is room for.

    Raises:
        LimitError: if the values are none, too many, or there is no room for them.
    """
    start_hz = _outside(_proposed(Stage.START, axis, found), _bands(axis, found))
    rates = Rates(start_hz, _proposed(Stage.CRUISE, axis, found), axis.acceleration_hz_s)
    configured = _configured(stage, axis)
    low_share, high_share = _RANGES[stage]
    lowest = start_hz if stage is Stage.CRUISE else low_share * configured
    low = wish.low if wish.low is not None else _down(lowest)
    high = wish.high if wish.high is not None else high_share * configured
    if not 0 < low <= high < math.inf:
        raise LimitError(
            phrase(
                "A sweep goes from a value above 0 to one that is not below it, not from"
                " {low:g} to {high:g}.",
                low=low,
                high=high,
            )
        )
    step = wish.step if wish.step is not None else _down((high - low) / _VALUES) or 1.0
    if not step > 0:
        raise LimitError(
            phrase("From one value to the next it goes up, not by {step:g}.", step=step)
        )
    count = math.floor((high - low) / step + 1e-9) + 1
    if count > _MOST_VALUES:
        raise LimitError(
            phrase(
                "From {low:g} to {high:g} by {step:g} there are {count} values; at most"
                " {most_values} are tried.",
                low=low,
                high=high,
                step=step,
                count=count,
                most_values=_MOST_VALUES,
            )
        )
    sweep = Sweep(stage, tuple(round(low + n * step, 6) for n in range(count)), rates)
    if wish.high is None:
        fitting = tuple(v for v in sweep.values if sweep.at(v).fits(room_steps))
        sweep = Sweep(stage, fitting or sweep.values, rates)
    for value in (sweep.values[0], sweep.values[-1]):
        sweep.at(value).way_steps(room_steps)
    return sweep


def proposed(
    name: str, axis: Axis, keys: Mapping[Stage, float], outcomes: Mapping[Stage, Outcome]
) -> Proposal:
    """What the configuration should say after a frequency test.

    Args:
        name: of the axis.
        axis: as configured.
        keys: the values in force, as they are written.
        outcomes: what was found.
    """
    bands = _bands(axis, outcomes)
    values = {stage: _proposed(stage, axis, outcomes) for stage in Stage}
    values[Stage.START] = _outside(min(values[Stage.START], values[Stage.CRUISE]), bands)
    values[Stage.CRUISE] = _outside(values[Stage.CRUISE], bands)
    bands = tuple(band for band in bands if band[0] < values[Stage.CRUISE])
    changes = [Change(f"axes.{name}.{_KEYS[stage]}", keys[stage], values[stage]) for stage in Stage]
    changes.append(Change(f"axes.{name}.avoid_hz", axis.avoid_hz, bands))
    return proposal(joined(" ", (outcome.words() for outcome in outcomes.values())), *changes)


def _configured(stage: Stage, axis: Axis) -> float:
    return float(getattr(axis, _KEYS[stage]))


def _proposed(stage: Stage, axis: Axis, outcomes: Mapping[Stage, Outcome]) -> float:
    """A share of what it followed; what is configured, where nothing speaks against it."""
    configured, outcome = _configured(stage, axis), outcomes.get(stage)
    best = outcome.best if outcome else None
    if outcome is None or best is None:
        return configured
    share = _down(MARGINS[stage] * best)
    if outcome.stall is None and configured <= best:
        return max(configured, share)
    return share


def _bands(axis: Axis, outcomes: Mapping[Stage, Outcome]) -> tuple[Band, ...]:
    """Those that were found, and those in force at rates that nobody tried."""
    tried = [
        (outcome.tried[0].value, outcome.tried[-1].value)
        for stage, outcome in outcomes.items()
        if outcome.tried and stage is not Stage.ACCELERATION
    ]
    kept = [
        band for band in axis.avoid_hz
        if not any(low <= band[1] and band[0] <= high for low, high in tried)
    ]  # fmt: skip
    found = [band for outcome in outcomes.values() for band in outcome.bands]
    return _merged(sorted([*kept, *found]))


def _merged(bands: Sequence[Band]) -> tuple[Band, ...]:
    """Those that touch as one; where there are too many, the nearest."""
    merged: list[Band] = []
    for low, high in bands:
        if merged and low <= merged[-1][1]:
            merged[-1] = merged[-1][0], max(high, merged[-1][1])
        else:
            merged.append((low, high))
    while len(merged) > _MOST_BANDS:
        gaps = [after[0] - before[1] for before, after in pairwise(merged)]
        at = gaps.index(min(gaps))
        merged[at : at + 2] = [(merged[at][0], merged[at + 1][1])]
    return tuple(merged)


def _outside(rate_hz: float, bands: Sequence[Band]) -> float:
    """The rate, or the lower end of the band that it is in."""
    return next((low for low, high in bands if low < rate_hz < high), rate_hz)


def _down(value: float) -> float:
    """With two digits that count, not above the value."""
    if value <= 0:
        return 0.0
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(math.floor(value / digit + 1e-9) * digit, 6)
