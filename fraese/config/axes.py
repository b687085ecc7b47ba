"""The axes: how steps become millimetres, and what the motors can follow."""

import re
from decimal import Decimal
from fractions import Fraction
from typing import Any, Literal

from pydantic import Field, field_validator, model_validator

from fraese.config.section import Positive, Section

AXIS_NAMES = ("x", "y", "z")
AxisName = Literal["x", "y", "z"]
Band = tuple[Positive, Positive]
_GEAR = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?|[0-9]{1,9}/[0-9]{1,9}")


class AxisConfig(Section):
    """One axis: how steps become millimetres, and what its motor can follow."""

    steps_per_rev: int = Field(
        400,
        ge=1,
        le=1_000_000,
        description=(
            "Smallest steps in one turn of the motor: half-steps on a phase card, else pulses."
        ),
    )
    pitch_mm: Decimal = Field(
        Decimal("2"),
        gt=0,
        le=1000,
        decimal_places=9,
        description=("Way of the carriage in one turn of the spindle, mm."),
    )
    gear: str = Field(
        "1",
        description=(
            'Turns of the motor for one turn of the spindle, a number or a ratio such as "5/2".'
        ),
    )
    travel_mm: Decimal = Field(
        Decimal("300"),
        gt=0,
        le=100_000,
        decimal_places=9,
        description=("Way from one end switch to the other, mm."),
    )
    inverted: bool = Field(
        False, description=("Whether the motor turns the other way round for positive moves.")
    )
    max_rate_hz: float = Field(
        4000, gt=0, le=200_000, description=("Highest step rate of the motor, steps/s.")
    )
    start_rate_hz: float = Field(
        800,
        gt=0,
        le=200_000,
        description=("Start/stop rate, steps/s: below it the motor needs no ramp."),
    )
    acceleration_hz_s: float = Field(
        20_000,
        gt=0,
        le=100_000_000,
        description=("Change of the step rate in a ramp, steps/s per second."),
    )
    home_end: Literal["min", "max"] = Field(
        "min", description=("The end switch to which the axis is referenced.")
    )
    backlash_mm: Decimal = Field(
        Decimal("0"),
        ge=0,
        le=10,
        decimal_places=9,
        description=("Way that is lost when the axis turns round, mm; made up for with steps."),
    )
    avoid_hz: tuple[Band, ...] = Field(
        (),
        max_length=8,
        description=(
            "Bands of step rates in which the motor resonates, pairs of steps/s: no move keeps a"
            " rate within one, ramps pass through."
        ),
    )

    @field_validator("gear", mode="before")
    @classmethod
    def _ratio(cls, value: Any) -> str:
        text = str(value).replace(":", "/").replace(" ", "")
        if not _GEAR.fullmatch(text) or not all(map(Fraction, text.split("/"))):
            raise ValueError('must be a positive number or ratio such as "5/2"')
        return text

    @field_validator("avoid_hz")
    @classmethod
    def _from_below(cls, value: tuple[Band, ...]) -> tuple[Band, ...]:
        if any(low_hz >= high_hz for low_hz, high_hz in value):
            raise ValueError("a band is a lower and a higher rate, in this order")
        return value

    @model_validator(mode="after")
    def _rates(self) -> "AxisConfig":
        if self.start_rate_hz > self.max_rate_hz:
            raise ValueError(
                f"start_rate_hz ({self.start_rate_hz:g}) must not be above"
                f" max_rate_hz ({self.max_rate_hz:g})"
            )
        return self

    def steps_per_mm(self) -> Fraction:
        """Exactly, as a fraction."""
        return Fraction(self.steps_per_rev) * Fraction(self.gear) / Fraction(self.pitch_mm)


class AxesConfig(Section):
    """The three axes."""

    x: AxisConfig = Field(AxisConfig(), description="The X axis.")
    y: AxisConfig = Field(AxisConfig(travel_mm=Decimal("200")), description="The Y axis.")
    z: AxisConfig = Field(
        AxisConfig(travel_mm=Decimal("60"), home_end="max"), description="The Z axis, vertical."
    )

    @model_validator(mode="before")
    @classmethod
    def _own_defaults(cls, value: Any) -> Any:
        """A table that names some keys of an axis leaves the others at that axis' defaults."""
        if not isinstance(value, dict):
            return value
        own: dict[str, dict[str, Any]] = {
            "y": {"travel_mm": Decimal("200")},
            "z": {"travel_mm": Decimal("60"), "home_end": "max"},
        }
        return {
            name: {**own.get(name, {}), **given} if isinstance(given, dict) else given
            for name, given in value.items()
        }
