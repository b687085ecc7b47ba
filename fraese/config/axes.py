"""The axes: which there are, a table for each, and where their motors are plugged in.

    [axes]
    names = ["x", "y", "z", "a"]     which there are, in this order

    [axes.x]                         one table an axis; what is left out keeps its default
    travel_mm = 400

Rule 1: an axis is linear, with keys in mm, or rotary, with keys in degrees; the key of one kind is
        refused on the other.
Rule 2: above the card an axis and its motor have one number, its place in ``names``. Which socket
        of the card the motor is plugged in is known here and to the card.
"""

from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Annotated, Any, ClassVar, Final, Literal, get_args

from pydantic import Discriminator, Field, Tag, field_validator, model_validator
from pydantic_core.core_schema import ValidationInfo

from fraese.config.axis import MOST_AXES, AxisConfig, LinearAxis, RotaryAxis
from fraese.config.section import Section
from fraese.phrases import phrase

AxisName = Literal["x", "y", "z", "a", "b", "c", "u", "v", "w"]
#: The axis that lifts the tool, where there is one.
VERTICAL: Final = "z"
#: What kind of axis a letter is when its table does not say.
_ROTARY: Final = frozenset("abc")
_LETTERS: Final[tuple[AxisName, ...]] = get_args(AxisName)
#: Defaults of an axis that differ from those of its kind.
_OWN: Final[Mapping[str, Mapping[str, Any]]] = {
    "y": {"travel_mm": Decimal("200")},
    "z": {"travel_mm": Decimal("60"), "home_end": "max"},
}


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
        custom_error_message=phrase('an axis is a table, its kind "linear" or "rotary"'),
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
            raise ValueError(phrase("names an axis twice"))
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
            raise ValueError(
                phrase("is not among axes.names; add it there: names = [{longer}]", longer=longer)
            )
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
