"""The keys that depend on the machine: jogs, zeros, widths, boxes of axes.

Rule 1: axes are jogged by place. X, Y and Z have their own; any other axis takes the fourth place,
        and then those that X, Y and Z leave free.
Rule 2: an axis is zeroed by its capital letter. Where that is another command's (A, W), by ``0``,
        and a second such axis by ``9``.
"""

from collections.abc import Container, Sequence
from dataclasses import dataclass
from typing import Final

from fraese.phrases import spoken
from fraese.ui.keyrows.row import Area, Row
from fraese.ui.shape import AxisShape
from fraese.ui.widths import REPEAT_FACTOR, REPEAT_FROM, Width


@dataclass(frozen=True, slots=True)
class _Place:
    """Two keys that lie opposite each other: (as Textual names it, for people).

    Attributes:
        minus: in negative direction,
        plus: in positive direction.
        upright: one key above the other, apart from the arrows.
    """

    minus: tuple[str, str]
    plus: tuple[str, str]
    upright: bool = False


_FOURTH: Final = ""
_PLACES: Final = {
    "x": _Place(("left", "←"), ("right", "→")),
    "y": _Place(("down", "↓"), ("up", "↑")),
    "z": _Place(("pagedown", "PgDn"), ("pageup", "PgUp"), upright=True),
    _FOURTH: _Place(("end", "End"), ("home", "Home"), upright=True),
}
#: In this order they are given to axes of other names.
_FREE_PLACES: Final = (_FOURTH, "z", "y", "x")
_OTHER_ZERO_KEYS: Final = ("0", "9")


def jog_rows(axes: Sequence[AxisShape], *, upright: bool) -> list[Row]:
    """Two for each axis: by the place of its name, or a free one."""
    names = [axis.name for axis in axes]
    free = (place for place in _FREE_PLACES if place not in names)
    places = [_PLACES[name if name in _PLACES else next(free)] for name in names]
    return [
        _jog(place, axis, sign)
        for axis, place in zip(axes, places, strict=True)
        if place.upright is upright
        for sign in ((1, -1) if upright else (-1, 1))
    ]


def _jog(place: _Place, axis: AxisShape, sign: int) -> Row:
    key, shown = place.plus if sign > 0 else place.minus
    direction = spoken("positive") if sign > 0 else spoken("negative")
    verb = spoken("Turn") if axis.turns else spoken("Move")
    return Row(
        Area.MACHINE,
        key,
        shown,
        f"jog('{axis.name}', {sign})",
        spoken("Jog {letter}{what}", letter=axis.letter, what="+" if sign > 0 else "−"),
        spoken(
            "{verb} {letter} by one step width in {direction} direction.",
            verb=verb,
            letter=axis.letter,
            direction=direction,
        ),
        "Jog",
        given_name=f"jog_{axis.name}_{'plus' if sign > 0 else 'minus'}",
    )


def is_jog(row: Row) -> bool:
    """It jogs an axis."""
    return row.action.startswith("jog(")


def zero_rows(axes: Sequence[AxisShape], taken: Container[str]) -> list[Row]:
    """One for each axis: its capital letter, where no other row has it."""
    others = iter(_OTHER_ZERO_KEYS)
    return [_zero(axis, axis.letter if axis.letter not in taken else next(others)) for axis in axes]


def _zero(axis: AxisShape, key: str) -> Row:
    name = axis.letter
    return Row(
        Area.MACHINE, key, key, f"zero('{axis.name}')", spoken("Zero {name}", name=name),
        spoken("Let the work zero of {name} be here.", name=name), "Position",
        given_name=f"zero_{axis.name}",
    )  # fmt: skip


def set_width(number: int, width: Width) -> Row:
    """Chooses this step width."""
    rule = (
        ""
        if width.mm
        else spoken(
            "; from press {repeat_from} of the same key on {repeat_factor}",
            repeat_from=REPEAT_FROM,
            repeat_factor=REPEAT_FACTOR,
        )
    )
    return Row(
        Area.MACHINE,
        str(number),
        str(number),
        f"set_width({number - 1})",
        spoken("Step {label}", label=width.label),
        spoken("Step width {label}{rule}.", label=width.label, rule=rule),
        "Jog",
        given_name=f"step_width_{number}",
    )


def choose(axis: AxisShape) -> Row:
    """Ticks the box of this axis."""
    return Row(Area.REFERENCE, axis.name, axis.name, f"tick('axis-{axis.name}')", hint="choose")
