"""What the simulated mill is like: facts of its own, whatever the axes are configured to be.

    [simulation]            the motors, all alike, and the frame
    [simulation.axes.x]     what is different on one axis, and its spindle

Rule 1: a motor here is one that is sold everywhere, on a spindle of 2 mm, or straight on a rotary
        table; it does not follow the configuration. So what is wrong there shows as a wrong place.
Rule 2: what a person sets on purpose to match the configuration, or builds as long as it says, is
        taken from there unless it is given: the switches of a drive, the socket, the travel.
"""

from collections.abc import Mapping
from decimal import Decimal
from typing import Any, Final

from pydantic import Field, field_validator, model_validator

from fraese.config.axes import AxisName
from fraese.config.axis import MOST_AXES, Band, from_below, gear_ratio
from fraese.config.section import NotNegative, Positive, Section
from fraese.config.solid import SimulatedSolid
from fraese.phrases import phrase

#: Keys of older files, in half-steps of a motor with 400 in a turn, and what they became.
_OLDER: Final[Mapping[str, str]] = {
    "max_rate_hz": "max_turns_s",
    "jump_hz": "start_turns_s",
    "acceleration_hz_s": "acceleration_turns_s2",
}
_OLDER_HALF_STEPS_PER_REV: Final = 400


class SimulatedMotor(Section):
    """What every motor of the simulated mill is like, unless its axis says otherwise."""

    full_steps_per_rev: int = Field(
        200,
        ge=4,
        le=10_000,
        description="Full steps in one turn of a motor: 200 at 1.8 degrees, 400 at 0.9.",
    )
    max_turns_s: Positive = Field(15, description="Above it a motor stalls, turns/s.")
    start_turns_s: Positive = Field(3, description="Start/stop rate of a motor, turns/s.")
    acceleration_turns_s2: Positive = Field(
        150, description="Change of rate that a motor can follow, turns/s per second."
    )
    overrun_mm: NotNegative = Field(
        2,
        description=(
            "Way of a carriage behind its switch, to the mechanical end, mm; degrees on a rotary"
            " axis."
        ),
    )
    backlash_mm: NotNegative = Field(
        0,
        description=(
            "How far a spindle turns back before its carriage follows, mm; degrees on a rotary"
            " axis."
        ),
    )
    resonances_turns_s: tuple[Band, ...] = Field(
        (),
        max_length=8,
        description=(
            "Bands of rates in which a motor resonates, pairs of turns/s: it falls out of step when"
            " it stays there."
        ),
    )
    scatter_mm: NotNegative = Field(
        0,
        description=(
            "Standard deviation of the place at which a switch closes, mm; degrees on a rotary"
            " axis."
        ),
    )

    _bands = field_validator("resonances_turns_s")(from_below)


class SimulatedAxis(Section):
    """One axis of the simulated mill; what is left out is as for all motors, or as configured."""

    motor: int | None = Field(
        None,
        examples=[1],
        ge=1,
        le=MOST_AXES,
        description="Socket that its motor really hangs on; without it, as in axes.",
    )
    microsteps: int | None = Field(
        None,
        examples=[8],
        ge=1,
        le=256,
        description=(
            "Pulses for one full step, on stepdir: the switches of the drive; without it, the"
            " setting that comes nearest to steps_per_rev of the axis."
        ),
    )
    full_steps_per_rev: int | None = Field(
        None, examples=[400], ge=4, le=10_000, description="Full steps in one turn of this motor."
    )
    pitch_mm: Decimal = Field(
        Decimal("2"),
        gt=0,
        le=1000,
        decimal_places=9,
        description=(
            "Way of the carriage in one turn of the spindle, mm; on a rotary axis pitch_deg, by"
            " default 360."
        ),
    )
    pitch_deg: Decimal = Field(
        Decimal("360"),
        gt=0,
        le=100_000,
        decimal_places=9,
        description="Turn of a rotary axis in one turn of its spindle, degrees.",
    )
    gear: str = Field(
        "1",
        description=(
            'Turns of the motor for one turn of the spindle, a number or a ratio such as "5/2".'
        ),
    )
    inverted: bool = Field(
        False, description="Whether the carriage goes down when the field turns forward."
    )
    travel_mm: Decimal | None = Field(
        None,
        examples=[300],
        gt=0,
        le=100_000,
        decimal_places=9,
        description=(
            "Way from one end switch to the other, mm, on a rotary axis travel_deg; without it, as"
            " in axes."
        ),
    )
    travel_deg: Decimal | None = Field(
        None,
        examples=[360],
        gt=0,
        le=1_000_000,
        decimal_places=9,
        description="Turn of a rotary axis from one end to the other, degrees.",
    )
    max_turns_s: Positive | None = Field(
        None, examples=[15], description="Above it this motor stalls, turns/s."
    )
    start_turns_s: Positive | None = Field(
        None, examples=[3], description="Start/stop rate of this motor, turns/s."
    )
    acceleration_turns_s2: Positive | None = Field(
        None,
        examples=[150],
        description="Change of rate that this motor can follow, turns/s per second.",
    )
    overrun_mm: NotNegative | None = Field(
        None,
        examples=[2],
        description="Way behind its switches, to the mechanical ends, mm or degrees.",
    )
    backlash_mm: NotNegative | None = Field(
        None, examples=[0], description="How far its spindle turns back in vain, mm or degrees."
    )
    resonances_turns_s: tuple[Band, ...] | None = Field(
        None,
        examples=[[[2.5, 3.5]]],
        max_length=8,
        description="Bands of rates in which this motor resonates, pairs of turns/s.",
    )
    scatter_mm: NotNegative | None = Field(
        None,
        examples=[0.01],
        description="Standard deviation of where its switches close, mm or degrees.",
    )

    _bands = field_validator("resonances_turns_s")(from_below)

    @field_validator("gear", mode="before")
    @classmethod
    def _ratio(cls, value: Any) -> str:
        return gear_ratio(value)


class SimulationConfig(SimulatedMotor):
    """The simulated mill: its motors and its frame, whatever the axes are configured to be."""

    snaps_to_pole: bool = Field(
        False,
        description=(
            "Whether a rotor without current turns to its nearest pole; else friction holds it."
        ),
    )
    lag_ms: float = Field(
        0, ge=0, le=1000, description=("From the carriage's arrival to the contact, ms.")
    )
    bounce_readings: int = Field(
        0, ge=0, le=100, description=("Readings after each change that bounce.")
    )
    reference_mm: NotNegative = Field(
        1,
        description=(
            "How far before its end switch a carriage presses the one for referencing, where there"
            " is one, mm or degrees."
        ),
    )
    tool_length_mm: NotNegative = Field(
        0, description="How far the tool really reaches below the spindle, mm."
    )
    tool_diameter_mm: NotNegative = Field(0, description="Its true diameter, mm.")
    solids: dict[str, SimulatedSolid] = Field(
        default_factory=dict,
        max_length=20,
        description="What lies on the table and can be touched, by a name of your own.",
    )
    axes: dict[AxisName, SimulatedAxis] = Field(
        default_factory=dict, description="What one axis really is, by its name."
    )

    @model_validator(mode="before")
    @classmethod
    def _from_half_steps(cls, value: Any) -> Any:
        """Older keys keep their meaning: half-steps of a motor with 400 in a turn."""
        if not isinstance(value, dict):
            return value
        values = dict(value)
        for older, key in _OLDER.items():
            if older not in values:
                continue
            rate = values.pop(older)
            if key in values:
                raise ValueError(
                    phrase(
                        "{older} is the older name of {key}, in half-steps of a motor with"
                        " {older_half_steps_per_rev} in a turn; leave it out",
                        older=older,
                        key=key,
                        older_half_steps_per_rev=_OLDER_HALF_STEPS_PER_REV,
                    )
                )
            if isinstance(rate, bool) or not isinstance(rate, int | float | Decimal):
                raise ValueError(
                    phrase(
                        "{older} must be a number; better, give {key} in turns",
                        older=older,
                        key=key,
                    )
                )
            values[key] = float(rate) / _OLDER_HALF_STEPS_PER_REV
        return values

    def own(self, name: str) -> SimulatedAxis:
        """What is said of one axis; socket, microsteps and travel may be left open."""
        return next((own for known, own in self.axes.items() if known == name), SimulatedAxis())

    def motor_of(self, name: str) -> SimulatedMotor:
        """The motor of one axis: its own facts, and for the others those of all."""
        own = self.own(name)
        facts = {key: getattr(own, key) for key in SimulatedMotor.model_fields}
        common = {key: getattr(self, key) for key, value in facts.items() if value is None}
        return SimulatedMotor.model_validate({**facts, **common})
