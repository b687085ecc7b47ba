"""The machine in both worlds: millimetres above, steps below, exact in between.

Rule 1: steps per millimetre are a fraction. A target is rounded once and absolutely,
        floor(x * k + 1/2); a move's steps are the difference of two targets.
Rule 2: machine zero lies at the pull-off distance from the switch to which an axis is referenced.
        An axis referenced at its lower end reaches from 0 upwards, one referenced at its upper
        end from 0 downwards.
"""

import math
from dataclasses import dataclass
from fractions import Fraction

from fraese.config import Config
from fraese.config.axes import AXIS_NAMES, AxisConfig

Steps = tuple[int, ...]
Millimetres = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Axis:
    """One axis.

    Attributes:
        name: "x", "y" or "z".
        steps_per_mm: exact, positive.
        motor_sign: -1 where the motor turns the other way round for positive moves.
        low_mm: the soft limits, in machine coordinates,
        high_mm: valid when the axis is referenced.
        travel_mm: from switch to switch.
        home_sign: -1 referenced at the lower end, +1 at the upper.
        max_rate_hz: what the motor can follow, steps/s,
        start_rate_hz: start/stop rate, steps/s,
        acceleration_hz_s: and change of rate, steps/s**2.
        backlash_steps: motor steps without effect after a reversal.
        avoid_hz: bands of step rates in which the motor resonates, from below to above.
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

    def to_steps(self, position_mm: float | Fraction) -> int:
        """Nearest step, halves upwards. A float is taken as the exact number that it is."""
        return math.floor(Fraction(position_mm) * self.steps_per_mm + Fraction(1, 2))

    def to_mm(self, position_steps: int) -> float:
        """Position in millimetres; converting back gives the same step."""
        return float(position_steps / self.steps_per_mm)

    @property
    def max_mm_s(self) -> float:
        """Highest speed."""
        return float(self.max_rate_hz / self.steps_per_mm)

    @property
    def step_mm(self) -> float:
        """The smallest step."""
        return float(1 / self.steps_per_mm)


def _axis(name: str, config: AxisConfig, pull_off_mm: float) -> Axis:
    usable_mm = float(config.travel_mm) - 2 * pull_off_mm
    at_low = config.home_end == "min"
    return Axis(
        name=name,
        steps_per_mm=config.steps_per_mm(),
        motor_sign=-1 if config.inverted else 1,
        low_mm=0.0 if at_low else -usable_mm,
        high_mm=usable_mm if at_low else 0.0,
        travel_mm=float(config.travel_mm),
        home_sign=-1 if at_low else 1,
        max_rate_hz=config.max_rate_hz,
        start_rate_hz=config.start_rate_hz,
        acceleration_hz_s=config.acceleration_hz_s,
        backlash_steps=round(Fraction(config.backlash_mm) * config.steps_per_mm()),
        avoid_hz=config.avoid_hz,
    )


@dataclass(frozen=True, slots=True)
class Machine:
    """All axes, in motor order."""

    axes: tuple[Axis, ...]

    @classmethod
    def from_config(cls, config: Config) -> "Machine":
        """The machine that a configuration describes."""
        pull_off_mm = config.homing.pull_off_mm
        return cls(
            tuple(_axis(name, getattr(config.axes, name), pull_off_mm) for name in AXIS_NAMES)
        )

    def index(self, name: str) -> int:
        """Motor number of an axis.

        Raises:
            ValueError: if there is no such axis.
        """
        return [axis.name for axis in self.axes].index(name)

    def to_steps(self, position_mm: Millimetres) -> Steps:
        """Nearest steps of every axis."""
        return tuple(axis.to_steps(mm) for axis, mm in zip(self.axes, position_mm, strict=True))

    def to_mm(self, position_steps: Steps) -> Millimetres:
        """Millimetres of every axis."""
        return tuple(axis.to_mm(n) for axis, n in zip(self.axes, position_steps, strict=True))
