"""Probing cycles, written in the language: the same words that a person would write.

    down on a plate     edge          corner            centre of a hole    centre of a boss
        |               ->|           ->|  then ^         <- o ->             -> [ ] <-

Rule 1: a contact is felt twice, first with the feed ``fast_mm_min``, then with ``slow_mm_min``; the
        second one counts.
Rule 2: behind a contact the probe goes back the way it came. Where the probe shares the input of
        the end switches, an unexpected contact on any other way stops the motors as an end would.
Rule 3: found is the edge of the work, not the middle of the tool: half its diameter is added.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from fraese.control.controller import Controller
from fraese.errors import UsageError
from fraese.phrases import phrase
from fraese.program.typed import run_text


@dataclass(frozen=True, slots=True)
class Probing:
    """What a cycle has to be told, mm.

    Attributes:
        thickness_mm: of the plate on the work; 0: the work itself is touched.
        diameter_mm: of the tool or the probe's ball.
        reach_mm: the contact is no further away than this.
        clear_mm: so far the probe goes back behind a contact.
        width_mm: of a boss, about; or how far a corner's other side is passed.
        depth_mm: how far beside a boss the probe goes down.
        fast_mm_min: towards the first contact,
        slow_mm_min: and the second.
    """

    thickness_mm: float = 0.0
    diameter_mm: float = 3.0
    reach_mm: float = 20.0
    clear_mm: float = 2.0
    width_mm: float = 20.0
    depth_mm: float = 3.0
    fast_mm_min: float = 120.0
    slow_mm_min: float = 30.0

    def given(self, values: Mapping[str, float]) -> "Probing":
        """With some of them given by name, without the unit.

        Raises:
            UsageError: naming what there is not, or what is out of bounds.
        """
        names = {name.split("_mm")[0]: name for name in self.__dataclass_fields__}
        for name, value in values.items():
            if name not in names:
                raise UsageError(
                    phrase(
                        'Probing knows no "{name}"; it knows {names}.',
                        name=name,
                        names=", ".join(sorted(names)),
                    )
                )
            if not 0 <= value <= _MOST or (value == 0 and name not in _MAY_BE_NOTHING):
                raise UsageError(
                    phrase(
                        "{name} {value:g}: above 0 and at most {most:g}.",
                        name=name,
                        value=value,
                        most=_MOST,
                    )
                )
        return replace(self, **{names[name]: value for name, value in values.items()})


_MOST: Final = 1000.0
_MAY_BE_NOTHING: Final = ("thickness", "diameter")


class _Cycle:
    """Lines of one cycle; positions are work coordinates.

    Args:
        given: what it was told.
        start: where the tool stands, by axis.
    """

    def __init__(self, given: Probing, start: Mapping[str, float]) -> None:
        self.given = given
        self.start = start
        self.lines = ["G21 G90 G94"]
        self._found = 0

    def go(self, **to: str | float) -> None:
        """A rapid to a place."""
        self.lines.append("G0 " + _words(to))

    def touch(self, axis: str, sign: int) -> str:
        """Feel for a contact twice, and go back by the clearance.

        Args:
            axis: along which.
            sign: in which direction.

        Returns:
            The parameter that has where the edge is.
        """
        given, letter = self.given, axis.upper()
        self._found += 1
        number = f"#{self._found}"
        half_mm = 0.0 if axis == "z" else given.diameter_mm / 2
        back = f"G0 {letter}{-sign * given.clear_mm:.4f}"
        self.lines += [
            f"G91 G38.2 {letter}{sign * given.reach_mm:.4f} F{given.fast_mm_min:g}",
            back,
            f"G38.2 {letter}{2 * sign * given.clear_mm:.4f} F{given.slow_mm_min:g}",
            f"{number}=[{_at(axis, 5061)}+{sign * half_mm:.4f}]",
            back,
            "G90",
        ]
        return number

    def zero_at(self, **places: str) -> None:
        """Let these places, in the work coordinates up to now, be zero."""
        self.lines.append(
            "G10 L20 P0 "
            + _words({axis: f"[{_at(axis, 5420)}-{at}]" for axis, at in places.items()})
        )


def _at(axis: str, first: int) -> str:
    return f"#{first + 'xyz'.index(axis)}"


def _words(values: Mapping[str, str | float]) -> str:
    return " ".join(
        f"{axis.upper()}{at if isinstance(at, str) else f'{at:.4f}'}" for axis, at in values.items()
    )


# --- the cycles ----------------------------------------------------------------------------------


def _down(cycle: _Cycle) -> None:
    found = cycle.touch("z", -1)
    cycle.zero_at(z=f"[{found}-{cycle.given.thickness_mm:.4f}]")


def _edge(axis: str, sign: int) -> Callable[[_Cycle], None]:
    def edge(cycle: _Cycle) -> None:
        cycle.zero_at(**{axis: cycle.touch(axis, sign)})

    return edge


def _corner(x_sign: int, y_sign: int) -> Callable[[_Cycle], None]:
    """The tool stands outside, off both edges; each is felt ``width_mm`` past the corner."""

    def corner(cycle: _Cycle) -> None:
        start, width_mm = cycle.start, cycle.given.width_mm
        cycle.go(y=start["y"] + y_sign * width_mm)
        x = cycle.touch("x", x_sign)
        cycle.go(x=start["x"])
        cycle.go(y=start["y"])
        cycle.go(x=start["x"] + x_sign * width_mm)
        y = cycle.touch("y", y_sign)
        cycle.go(y=start["y"])
        cycle.go(x=start["x"])
        cycle.zero_at(x=x, y=y)

    return corner


def _hole(cycle: _Cycle) -> None:
    """The tool stands inside."""
    middles = {}
    for axis in "xy":
        low = cycle.touch(axis, -1)
        cycle.go(**{axis: cycle.start[axis]})
        high = cycle.touch(axis, 1)
        middles[axis] = f"[[{low}+{high}]/2]"
        cycle.go(**{axis: middles[axis]})
    cycle.zero_at(**middles)


def _boss(cycle: _Cycle) -> None:
    """The tool stands above the middle, about; it goes over and down on each of the four sides."""
    given, top_mm = cycle.given, cycle.start["z"]
    out_mm = given.width_mm / 2 + given.diameter_mm / 2 + 2 * given.clear_mm
    middles: dict[str, str] = {}
    for axis in "xy":
        sides = []
        for sign in (-1, 1):
            cycle.go(**{axis: cycle.start[axis] + sign * out_mm})
            cycle.go(z=top_mm - given.depth_mm)
            sides.append(cycle.touch(axis, -sign))
            cycle.go(**{axis: cycle.start[axis] + sign * out_mm})
            cycle.go(z=top_mm)
        middles[axis] = f"[[{sides[0]}+{sides[1]}]/2]"
        cycle.go(**{axis: middles[axis]})
    cycle.zero_at(**middles)


#: By name: what is done, and the axes that it needs.
CYCLES: Final[dict[str, tuple[Callable[[_Cycle], None], str]]] = {
    phrase("down on work or plate"): (_down, "z"),
    phrase("edge X+"): (_edge("x", 1), "x"),
    phrase("edge X−"): (_edge("x", -1), "x"),
    phrase("edge Y+"): (_edge("y", 1), "y"),
    phrase("edge Y−"): (_edge("y", -1), "y"),
    phrase("corner X+ Y+"): (_corner(1, 1), "xy"),
    phrase("corner X− Y+"): (_corner(-1, 1), "xy"),
    phrase("corner X+ Y−"): (_corner(1, -1), "xy"),
    phrase("corner X− Y−"): (_corner(-1, -1), "xy"),
    phrase("centre of a hole"): (_hole, "xy"),
    phrase("centre of a boss"): (_boss, "xyz"),
}


def cycles_for(axes: Sequence[str]) -> tuple[str, ...]:
    """Names of the cycles that a machine with these axes can do."""
    return tuple(name for name, (_, needed) in CYCLES.items() if set(needed) <= set(axes))


def probe(controller: Controller, name: str, values: Mapping[str, float]) -> None:
    """Start a cycle; the controller's ``run`` works it off, and sets the zero at its end.

    Args:
        controller: the machine.
        name: of the cycle.
        values: what it is told, see ``Probing.given``.

    Raises:
        UsageError: if there is no such cycle, or a value is out of bounds.
        LimitError: if it would leave the travel.
        StateError: if the machine is not ready.
    """
    if name not in cycles_for(controller.machine.names):
        raise UsageError(phrase('There is no cycle "{name}" on this machine.', name=name))
    state = controller.state()
    cycle = _Cycle(Probing().given(values), dict(zip(state.axes, state.work_mm, strict=True)))
    CYCLES[name][0](cycle)
    run_text(controller, "\n".join([*cycle.lines, "M2", ""]), phrase("probe: {name}", name=name))
