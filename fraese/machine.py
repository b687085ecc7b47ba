"""The machine in both worlds: millimetres and degrees above, steps below, exact in between.

Rule 1: steps per millimetre are a fraction. A target is rounded once and absolutely,
        floor(x * k + 1/2); a move's steps are the difference of two targets.
Rule 2: machine zero lies at the pull-off distance from the switch to which an axis is referenced.
        An axis referenced at its lower end reaches from 0 upwards, one referenced at its upper
        end from 0 downwards.
Rule 3: a rotary axis counts in degrees. Everywhere above the steps a value of its own is in
        degrees, also where a name says ``_mm``, as in every tuple with a value for each axis.
Rule 4: an endless axis has no limits but what the counters hold; in degrees they are infinite.
"""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, Literal

from fraese.config import Config
from fraese.config.axes import VERTICAL
from fraese.config.axis import AxisConfig
from fraese.feedway import groups_of

Steps = tuple[int, ...]
Millimetres = tuple[float, ...]

#: How far an endless axis may get from its zero: counters of 32 bits hold it with room to spare.
_MOST_STEPS: Final = 1_000_000_000


def three_decimals(value: float) -> str:
    """A position as it is shown everywhere; never minus nil."""
    return f"{round(value, 3) + 0.0:.3f}"


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis.

    Attributes:
        name: a letter, such as "x".
        steps_per_mm: exact, positive; per degree on a rotary axis.
        motor_sign: -1 where the motor turns the other way round for positive moves.
        low_mm: the soft limits, in machine coordinates,
        high_mm: valid when the axis is referenced.
        travel_mm: from end to end; infinite if there is none.
        home_sign: -1 referenced at the lower end, +1 at the upper.
        max_rate_hz: what the motor can follow, steps/s,
        start_rate_hz: start/stop rate, steps/s,
        acceleration_hz_s: and change of rate, steps/s**2.
        backlash_steps: motor steps without effect after a reversal.
        avoid_hz: bands of step rates in which the motor resonates, from below to above.
        kind: "linear" or "rotary".
        unit: "mm" or "°".
        has_switches: an end switch at both ends.
    """

    name: str
    steps_per_mm: Fraction
    motor_sign: int
    low_mm: float
    high_mm: float
    travel_mm: float
    home_sign: int
    max_rate_hz: float
    start_rate_hz: float
    acceleration_hz_s: float
    backlash_steps: int = 0
    avoid_hz: tuple[tuple[float, float], ...] = ()
    kind: Literal["linear", "rotary"] = "linear"
    unit: str = "mm"
    has_switches: bool = True

    def with_unit(self, number: float | str) -> str:
        """A number as people write it: 12.5 mm, 90°."""
        text = number if isinstance(number, str) else f"{number:g}"
        return text + (self.unit if self.unit == "°" else f" {self.unit}")

    @property
    def travel_key(self) -> str:
        """The key of its travel in the configuration."""
        return "travel_deg" if self.kind == "rotary" else "travel_mm"

    @property
    def is_endless(self) -> bool:
        """There are no ends, and no soft limits."""
        return math.isinf(self.travel_mm)

    @property
    def travel_steps(self) -> float:
        """From end to end; infinite if there is none."""
        return self.travel_mm if self.is_endless else self.to_steps(self.travel_mm)

    @property
    def low_steps(self) -> int:
        """The lower soft limit, in steps."""
        return -_MOST_STEPS if self.is_endless else self.to_steps(self.low_mm)

    @property
    def high_steps(self) -> int:
        """The upper soft limit, in steps."""
        return _MOST_STEPS if self.is_endless else self.to_steps(self.high_mm)

    def to_steps(self, position_mm: float | Fraction) -> int:
        """Nearest step, halves upwards. A float is taken as the exact number that it is."""
        return math.floor(Fraction(position_mm) * self.steps_per_mm + Fraction(1, 2))

    def to_mm(self, position_steps: int) -> float:
        """Position in millimetres; converting back gives the same step."""
        return float(position_steps / self.steps_per_mm)

    @property
    def step_mm(self) -> float:
        """The smallest step."""
        return float(1 / self.steps_per_mm)


def _axis(name: str, config: AxisConfig, pull_off_mm: float) -> Axis:
    travel_mm = math.inf if config.travel is None else float(config.travel)
    usable_mm = travel_mm - 2 * pull_off_mm
    is_endless = config.travel is None
    at_low = config.home_end == "min"
    return Axis(
        name=name,
        steps_per_mm=config.steps_per_unit(),
        motor_sign=-1 if config.inverted else 1,
        low_mm=-usable_mm if is_endless or not at_low else 0.0,
        high_mm=usable_mm if is_endless or at_low else 0.0,
        travel_mm=travel_mm,
        home_sign=-1 if at_low else 1,
        max_rate_hz=config.max_rate_hz,
        start_rate_hz=config.start_rate_hz,
        acceleration_hz_s=config.acceleration_hz_s,
        backlash_steps=round(Fraction(config.backlash) * config.steps_per_unit()),
        avoid_hz=config.avoid_hz,
        kind=config.kind,
        unit=config.unit,
        has_switches=config.has_switches,
    )


@dataclass(frozen=True, slots=True)
class Machine:
    """All axes, in motor order, and how they are accelerated.

    Attributes:
        axes: in motor order.
        ramp: name of the law of all ramps.
        jerk_s: the shortest time in which acceleration comes to its full value, where it is told.
    """

    axes: tuple[Axis, ...]
    ramp: str = "linear"
    jerk_s: float = 0.05

    @classmethod
    def from_config(cls, config: Config) -> "Machine":
        """The machine that a configuration describes."""
        return cls(
            tuple(
                _axis(name, axis, config.pull_off(axis)) for name, axis in config.axes.table.items()
            ),
            config.planner.ramp,
            config.planner.jerk_ms / 1000,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes."""
        return tuple(axis.name for axis in self.axes)

    @property
    def vertical(self) -> int | None:
        """Motor number of the axis that lifts the tool; None: nothing lifts it."""
        names = self.names
        return names.index(VERTICAL) if VERTICAL in names else None

    def index(self, name: str) -> int:
        """Motor number of an axis.

        Raises:
            ValueError: if there is no such axis.
        """
        return [axis.name for axis in self.axes].index(name)

    def in_words(self, position_mm: Millimetres) -> str:
        """A point: X 1.000 Y 2.000 mm; each degree with its sign: X 1.000 mm A 90.000°."""
        words = []
        for place, (axis, value) in enumerate(zip(self.axes, position_mm, strict=True), start=1):
            # Millimetres of neighbours share their unit.
            more_mm = axis.unit == "mm" and any(
                next_.unit == "mm" for next_ in self.axes[place:][:1]
            )
            number = three_decimals(value)
            words.append(f"{axis.name.upper()} {number if more_mm else axis.with_unit(number)}")
        return " ".join(words)

    def unit_of_way(self, steps: Steps) -> str:
        """What a feed of these steps counts: "mm", or "°" where only rotary axes count."""
        for group in groups_of(self.names):
            units = {self.axes[at].unit for at in group if steps[at]}
            if units:
                return "°" if units == {"°"} else "mm"
        return "mm"

    def to_steps(self, position_mm: Millimetres) -> Steps:
        """Nearest steps of every axis."""
        return tuple(axis.to_steps(mm) for axis, mm in zip(self.axes, position_mm, strict=True))

    def to_mm(self, position_steps: Steps) -> Millimetres:
        """Millimetres of every axis."""
        return tuple(axis.to_mm(n) for axis, n in zip(self.axes, position_steps, strict=True))
