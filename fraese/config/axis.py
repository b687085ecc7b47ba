"""One axis: how its steps become millimetres or degrees, and what its motor can follow.

Rule 1: it is linear, with keys in mm, or rotary, with keys in degrees; the key of one kind is
        refused on the other.
"""

import re
from abc import ABC, abstractmethod
from decimal import Decimal
from fractions import Fraction
from typing import Any, ClassVar, Final, Literal

from pydantic import Field, field_validator, model_validator

from fraese.config.section import Positive, Section
from fraese.phrases import phrase

#: What no card has more of.
MOST_AXES: Final = 4

Band = tuple[Positive, Positive]
_GEAR = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?|[0-9]{1,9}/[0-9]{1,9}")


def gear_ratio(value: Any) -> str:
    """A ratio as it is written, read strictly.

    Raises:
        ValueError: if it is no positive number or ratio.
    """
    text = str(value).replace(":", "/").replace(" ", "")
    if not _GEAR.fullmatch(text) or not all(map(Fraction, text.split("/"))):
        raise ValueError(phrase('must be a positive number or ratio such as "5/2"'))
    return text


def from_below(value: tuple[Band, ...] | None) -> tuple[Band, ...] | None:
    """Bands of rates, each from its lower to its higher one.

    Raises:
        ValueError: if one is not.
    """
    if any(low_hz >= high_hz for low_hz, high_hz in value or ()):
        raise ValueError(phrase("a band is a lower and a higher rate, in this order"))
    return value


class AxisConfig(Section, ABC):
    """One axis: how steps become a way, and what its motor can follow.

    What the two kinds share. Lengths are in mm or degrees.
    """

    #: What stands behind a number.
    unit: ClassVar[str]
    #: How the keys of this kind end, and what the keys of the other are called here.
    key_unit: ClassVar[str]
    _stranger: ClassVar[str]

    kind: Literal["linear", "rotary"]
    motor: int = Field(
        1,
        ge=1,
        le=MOST_AXES,
        description=(
            "Socket of the card that its motor is plugged in; by default its place in axes.names."
        ),
    )
    steps_per_rev: int = Field(
        400,
        ge=1,
        le=1_000_000,
        description=(
            "Smallest steps in one turn of the motor: half-steps on a phase card, else pulses."
        ),
    )
    gear: str = Field(
        "1",
        description=(
            'Turns of the motor for one turn of the spindle, a number or a ratio such as "5/2".'
        ),
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
    avoid_hz: tuple[Band, ...] = Field(
        (),
        max_length=8,
        description=(
            "Bands of step rates in which the motor resonates, pairs of steps/s: no move keeps a"
            " rate within one, ramps pass through."
        ),
    )
    home_end: Literal["min", "max"] = Field(
        "min", description=("The end switch to which the axis is referenced.")
    )

    @property
    @abstractmethod
    def pitch(self) -> Decimal:
        """Way in one turn of the spindle."""

    @property
    @abstractmethod
    def travel(self) -> Decimal | None:
        """Way from one end to the other; None: it turns endlessly."""

    @property
    @abstractmethod
    def backlash(self) -> Decimal:
        """Way that is lost when the axis turns round."""

    @property
    @abstractmethod
    def has_switches(self) -> bool:
        """Whether there is an end switch at both ends."""

    @model_validator(mode="before")
    @classmethod
    def _own_unit(cls, value: Any) -> Any:
        """A key of the other kind is no typing error: say what it is called here."""
        for key in value if isinstance(value, dict) else ():
            stem, _, unit = str(key).rpartition("_")
            if unit == cls._stranger and f"{stem}_{cls.key_unit}" in cls.model_fields:
                other = "rotary" if cls._stranger == "deg" else "linear"
                raise ValueError(
                    phrase(
                        "{key} belongs to a {other} axis; this one has {stem}_{key_unit}",
                        key=key,
                        other=other,
                        stem=stem,
                        key_unit=cls.key_unit,
                    )
                )
        return value

    @field_validator("gear", mode="before")
    @classmethod
    def _ratio(cls, value: Any) -> str:
        return gear_ratio(value)

    _bands = field_validator("avoid_hz")(from_below)

    @model_validator(mode="after")
    def _rates(self) -> "AxisConfig":
        if self.start_rate_hz > self.max_rate_hz:
            raise ValueError(
                phrase(
                    "start_rate_hz ({start_rate_hz:g}) must not be above max_rate_hz"
                    " ({max_rate_hz:g})",
                    start_rate_hz=self.start_rate_hz,
                    max_rate_hz=self.max_rate_hz,
                )
            )
        return self

    def steps_per_unit(self) -> Fraction:
        """Steps per mm or per degree, exactly, as a fraction."""
        return Fraction(self.steps_per_rev) * Fraction(self.gear) / Fraction(self.pitch)


class LinearAxis(AxisConfig):
    """A linear axis: how steps become millimetres, and what its motor can follow."""

    unit: ClassVar[str] = "mm"
    key_unit: ClassVar[str] = "mm"
    _stranger: ClassVar[str] = "deg"

    kind: Literal["linear"] = Field(
        "linear", description='"linear", in mm, or "rotary", in degrees.'
    )
    pitch_mm: Decimal = Field(
        Decimal("2"),
        gt=0,
        le=1000,
        decimal_places=9,
        description=("Way of the carriage in one turn of the spindle, mm."),
    )
    travel_mm: Decimal = Field(
        Decimal("300"),
        gt=0,
        le=100_000,
        decimal_places=9,
        description=("Way from one end switch to the other, mm."),
    )
    backlash_mm: Decimal = Field(
        Decimal("0"),
        ge=0,
        le=10,
        decimal_places=9,
        description=("Way that is lost when the axis turns round, mm; made up for with steps."),
    )
    end_switches: bool = Field(
        True,
        description=(
            "Whether there is a switch at both ends; without, the axis is referenced by its name:"
            " where it stands becomes zero."
        ),
    )

    @property
    def pitch(self) -> Decimal:
        """Way in one turn of the spindle, mm."""
        return self.pitch_mm

    @property
    def travel(self) -> Decimal:
        """Way from one end to the other, mm."""
        return self.travel_mm

    @property
    def backlash(self) -> Decimal:
        """Way that is lost when the axis turns round, mm."""
        return self.backlash_mm

    @property
    def has_switches(self) -> bool:
        """Whether there is an end switch at both ends."""
        return self.end_switches


class RotaryAxis(AxisConfig):
    """A rotary axis: how steps become degrees, and what its motor can follow."""

    unit: ClassVar[str] = "°"
    key_unit: ClassVar[str] = "deg"
    _stranger: ClassVar[str] = "mm"

    kind: Literal["rotary"] = Field(
        "rotary", description='"linear", in mm, or "rotary", in degrees.'
    )
    pitch_deg: Decimal = Field(
        Decimal("360"),
        gt=0,
        le=100_000,
        decimal_places=9,
        description="Turn of the table in one turn of the spindle, degrees.",
    )
    travel_deg: Decimal | None = Field(
        None,
        gt=0,
        le=1_000_000,
        decimal_places=9,
        description="Turn from one end to the other, degrees; without it, the axis is endless.",
    )
    backlash_deg: Decimal = Field(
        Decimal("0"),
        ge=0,
        le=90,
        decimal_places=9,
        description="Turn that is lost when the axis turns round, degrees; made up for with steps.",
    )
    end_switches: bool = Field(
        False,
        description=(
            "Whether there is a switch at both ends; without, the axis is referenced by its name:"
            " where it stands becomes zero."
        ),
    )

    @property
    def pitch(self) -> Decimal:
        """Turn of the table in one turn of the spindle, degrees."""
        return self.pitch_deg

    @property
    def travel(self) -> Decimal | None:
        """Turn from one end to the other, degrees; None: it turns endlessly."""
        return self.travel_deg

    @property
    def backlash(self) -> Decimal:
        """Turn that is lost when the axis turns round, degrees."""
        return self.backlash_deg

    @property
    def has_switches(self) -> bool:
        """Whether there is an end switch at both ends."""
        return self.end_switches

    @model_validator(mode="after")
    def _ends(self) -> "RotaryAxis":
        if self.end_switches and self.travel_deg is None:
            raise ValueError(
                phrase(
                    "an endless axis has no end switches; give travel_deg, or leave out"
                    " end_switches"
                )
            )
        return self
