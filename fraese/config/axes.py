"""The axes: how steps become millimetres or degrees, and what the motors can follow.

    [axes]
    names = ["x", "y", "z", "a"]     which there are, in this order

    [axes.x]                         one table an axis; what is left out keeps its default
    travel_mm = 400

Rule 1: an axis is linear, with keys in mm, or rotary, with keys in degrees; the key of one kind is
        refused on the other.
Rule 2: above the card an axis and its motor have one number, its place in ``names``. Which socket
        of the card the motor is plugged in is known here and to the card.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Final, Literal

from pydantic import Discriminator, Field, Tag, field_validator, model_validator
from pydantic_core.core_schema import ValidationInfo

from fraese.config.section import Positive, Section

AxisName = Literal["x", "y", "z", "a", "b", "c", "u", "v", "w"]
#: The axis that lifts the tool, where there is one.
VERTICAL: Final = "z"
#: What no card has more of.
MOST_AXES: Final = 4
#: What kind of axis a letter is when its table does not say.
_ROTARY: Final = frozenset("abc")
_LETTERS: Final = ("x", "y", "z", "a", "b", "c", "u", "v", "w")
#: Defaults of an axis that differ from those of its kind.
_OWN: Final[Mapping[str, Mapping[str, Any]]] = {
    "y": {"travel_mm": Decimal("200")},
    "z": {"travel_mm": Decimal("60"), "home_end": "max"},
}

Band = tuple[Positive, Positive]
_GEAR = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?|[0-9]{1,9}/[0-9]{1,9}")


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
                    f"{key!s} belongs to a {other} axis; this one has {stem}_{cls.key_unit}"
                )
        return value

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
                "an endless axis has no end switches; give travel_deg, or leave out end_switches"
            )
        return self


def _kind(value: Any) -> str | None:
    """Which of the two classes a table is for."""
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", "linear")
    return kind if kind in ("linear", "rotary") else None


def _either(schema: dict[str, Any]) -> None:
    """For editors: a table without its kind may be either."""
    for option in schema.pop("oneOf", ()):
        schema.setdefault("anyOf", []).append(option)


_AnyAxis = Annotated[
    Annotated[LinearAxis, Tag("linear")] | Annotated[RotaryAxis, Tag("rotary")],
    Discriminator(
        _kind,
        custom_error_type="axis_kind",
        custom_error_message='an axis is a table, its kind "linear" or "rotary"',
    ),
    Field(json_schema_extra=_either),
]


class AxesConfig(Section):
    """The axes that the machine has, and a table for each."""

    #: How another axis is written, for the file that explains itself.
    example: ClassVar[tuple[str, ...]] = (
        "Another axis: here a fourth one, rotary and endless, behind a worm gear of 90:1.",
        "    [card]",
        '    kind = "stepdir"',
        "    [axes]",
        '    names = ["x", "y", "z", "a"]',
        "    [axes.a]",
        '    gear = "90"',
    )

    names: tuple[AxisName, ...] = Field(
        ("x", "y", "z"),
        min_length=1,
        max_length=MOST_AXES,
        description=(
            "Their names, out of x y z a b c u v w; one to three on smc1500, one to four on"
            " stepdir."
        ),
    )
    x: _AnyAxis | None = Field(None, description="The X axis.")
    y: _AnyAxis | None = Field(None, description="The Y axis.")
    z: _AnyAxis | None = Field(None, description="The Z axis, vertical.")
    a: _AnyAxis | None = Field(None, description="The A axis, rotary unless it says linear.")
    b: _AnyAxis | None = Field(None, description="The B axis, rotary unless it says linear.")
    c: _AnyAxis | None = Field(None, description="The C axis, rotary unless it says linear.")
    u: _AnyAxis | None = Field(None, description="The U axis.")
    v: _AnyAxis | None = Field(None, description="The V axis.")
    w: _AnyAxis | None = Field(None, description="The W axis.")

    @field_validator("names")
    @classmethod
    def _no_axis_twice(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(value)) != len(value):
            raise ValueError("names an axis twice")
        return value

    @model_validator(mode="before")
    @classmethod
    def _own_defaults(cls, value: Any) -> Any:
        """A table that names some keys of an axis leaves the others at that axis' defaults."""
        if not isinstance(value, dict):
            return value
        names = value.get("names", cls.model_fields["names"].default)
        there = [name for name in names if name in _LETTERS] if _is_list(names) else []
        tables = {name: value.get(name, {}) for name in _LETTERS if name in value or name in there}
        places = {name: place for place, name in enumerate(there, start=1)}
        return {
            **value,
            **{name: _complete(name, places.get(name), given) for name, given in tables.items()},
        }

    @field_validator(*_LETTERS, mode="before")
    @classmethod
    def _is_named(cls, value: Any, info: ValidationInfo) -> Any:
        names = info.data.get("names")
        if value is not None and names is not None and info.field_name not in names:
            longer = ", ".join(f'"{name}"' for name in (*names, info.field_name))
            raise ValueError(f"is not among axes.names; add it there: names = [{longer}]")
        return value

    @property
    def table(self) -> dict[str, AxisConfig]:
        """Every axis by its name, in motor order."""
        return {name: getattr(self, name) for name in self.names}

    @property
    def sockets(self) -> tuple[int, ...]:
        """Where each motor is plugged in, in motor order, from 0."""
        return tuple(axis.motor - 1 for axis in self.table.values())

    @property
    def home_order(self) -> tuple[str, ...]:
        """Axes with end switches, the vertical one first."""
        order = [name for name, axis in self.table.items() if axis.has_switches]
        return tuple(sorted(order, key=lambda name: name != VERTICAL))


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _complete(name: str, place: int | None, given: Any) -> Any:
    """A table with what it leaves out that is the axis' own."""
    if not isinstance(given, dict):
        return given
    kind = "rotary" if name in _ROTARY else "linear"
    own = dict(_OWN.get(name, {})) if given.get("kind", kind) == "linear" else {}
    if place is not None and place <= MOST_AXES:
        own["motor"] = place
    return {"kind": kind, **own, **given}
