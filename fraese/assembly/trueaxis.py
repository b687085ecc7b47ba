"""What an axis of the simulated mill really is, in half-steps of its motor.

    [simulation], [simulation.axes.x]  +  what Rule 2 of ``config/simulation.py`` leaves open

Rule 1: a step of the card is so many half-steps of the motor as its phase table or its drive makes
        of it; nothing that the axes are configured to be changes that.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from fraese.config import Config
from fraese.config.axis import AxisConfig
from fraese.config.simulation import SimulatedMotor
from fraese.kinds.card import card_kind
from fraese.motor.mill import Slide
from fraese.motor.phases import TURN_STEPS
from fraese.motor.rotor import RotorLimits

_HALF_STEPS: Final = 2


@dataclass(frozen=True, slots=True)
class TrueAxis:
    """One axis of the simulated mill.

    Attributes:
        name: a letter.
        unit: of all ways, "mm" or "°".
        motor: what it follows, full steps, play.
        pitch: way of its carriage in one turn of the spindle.
        gear: turns of the motor for one turn of the spindle.
        steps_in_turn: steps of the card in which the field makes one electrical turn.
        sense: which way a positive step of the card turns the field, 1 or -1.
        sign: which way a carriage goes when the field turns forward, 1 or -1.
        travel: from one end to the other; None: it turns endlessly.
        has_switches: at both ends.
        socket: of the card, from 0.
    """

    name: str
    unit: str
    motor: SimulatedMotor
    pitch: Fraction
    gear: Fraction
    steps_in_turn: int
    sense: int
    sign: int
    travel: Fraction | None
    has_switches: bool
    socket: int

    @property
    def half_steps_per_unit(self) -> Fraction:
        """Half-steps of its motor for each mm or degree of its carriage."""
        return self.half_steps_per_rev * self.gear / self.pitch

    @property
    def half_steps_per_step(self) -> Fraction:
        """Half-steps of the motor in one step of the card."""
        return Fraction(TURN_STEPS, self.steps_in_turn)

    @property
    def steps_per_rev(self) -> Fraction:
        """Steps of the card in one turn of the motor."""
        return self.half_steps_per_rev / self.half_steps_per_step

    @property
    def half_steps_per_rev(self) -> int:
        """Half-steps in one turn of the motor."""
        return _HALF_STEPS * self.motor.full_steps_per_rev

    @property
    def units_per_step(self) -> Fraction:
        """What its carriage does at one positive step of the card, mm or degrees."""
        turned = self.sense * self.sign * self.half_steps_per_step
        return turned / self.half_steps_per_unit

    def with_unit(self, number: float | Fraction) -> str:
        """A number as people write it: 12.5 mm, 90°."""
        space = "" if self.unit == "°" else " "
        return f"{float(number):.4g}{space}{self.unit}"

    def ratio(self, axis: AxisConfig) -> Fraction:
        """What its carriage does for each mm or degree that the axis is told; 1 is right."""
        wanted = axis.steps_per_unit() * (-1 if axis.inverted else 1)
        return self.units_per_step * wanted

    def suits(self, axis: AxisConfig) -> bool:
        """It is as the axis is configured: the same ways, the same travel, the same socket."""
        return (
            self.ratio(axis) == 1
            and self.travel == (None if axis.travel is None else Fraction(axis.travel))
            and self.socket == axis.motor - 1
        )

    @property
    def in_words(self) -> str:
        """What gives the half-steps of its motor their meaning."""
        return (
            f"{self.half_steps_per_unit} {self.steps_in_turn} {self.sense} {self.sign}"
            f" {self.travel} {self.socket}"
        )

    def slide(self, snaps_to_pole: bool) -> Slide:
        """What the mechanics are made from."""
        travel = None if self.travel is None else self.travel * self.half_steps_per_unit
        return Slide(
            travel_steps=float("inf") if travel is None else float(travel),
            limits=self._limits(snaps_to_pole),
            overrun_steps=self._half_steps(self.motor.overrun_mm),
            backlash_steps=self._half_steps(self.motor.backlash_mm),
            has_switches=self.has_switches,
            steps_in_turn=self.steps_in_turn,
            scatter_steps=self.motor.scatter_mm * float(self.half_steps_per_unit),
        )

    def _limits(self, snaps_to_pole: bool) -> RotorLimits:
        motor, per_rev = self.motor, self.half_steps_per_rev
        return RotorLimits(
            max_rate_hz=motor.max_turns_s * per_rev,
            jump_hz=motor.start_turns_s * per_rev,
            acceleration_hz_s=motor.acceleration_turns_s2 * per_rev,
            snaps_to_pole=snaps_to_pole,
            resonances_hz=tuple(
                (low * per_rev, high * per_rev) for low, high in motor.resonances_turns_s
            ),
        )

    def _half_steps(self, way: float) -> int:
        return round(Fraction(way) * self.half_steps_per_unit)


def true_axes(config: Config) -> tuple[TrueAxis, ...]:
    """Every axis of the simulated mill, in motor order."""
    return tuple(_true_axis(config, name, axis) for name, axis in config.axes.table.items())


def _true_axis(config: Config, name: str, axis: AxisConfig) -> TrueAxis:
    own, motor = config.simulation.own(name), config.simulation.motor_of(name)
    steps_in_turn, sense = card_kind(config).stepping(config, name)
    is_linear = axis.kind == "linear"
    travel = (own.travel_mm if is_linear else own.travel_deg) or axis.travel
    return TrueAxis(
        name=name,
        unit=axis.unit,
        motor=motor,
        pitch=Fraction(own.pitch_mm if is_linear else own.pitch_deg),
        gear=Fraction(own.gear),
        steps_in_turn=steps_in_turn,
        sense=sense,
        sign=-1 if own.inverted else 1,
        travel=None if travel is None else Fraction(travel),
        has_switches=axis.has_switches,
        socket=(own.motor or axis.motor) - 1,
    )
