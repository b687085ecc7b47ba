"""The position of every axis, large: work and machine coordinates, and steps."""

import math
from typing import Final

from textual.app import ComposeResult
from textual.containers import Container, Horizontal, Vertical

from fraese.control.state import MachineState, three_decimals
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.big import BigNumber
from fraese.ui.widgets.fact import Fact, Number

_COLUMNS: Final = ("work", "machine", "steps")


class AxisRow(Vertical):
    """One axis."""

    def __init__(self, axis: AxisShape, index: int, step_word: str) -> None:
        super().__init__(id=f"axis-{axis.name}", classes="axis")
        self._axis = axis
        self._index = index
        self._step_word = step_word
        self._mark = Fact(classes="mark")
        self._big = BigNumber(classes="big")
        self._plain = [Fact(classes=f"plain plain-{what}") for what in _COLUMNS]
        self._work = Number(8, classes="work")
        self._machine = Number(8, classes="machine")
        self._steps = Number(6, classes="steps")
        self._count = Fact(classes="count")
        self._small = Fact(classes="small")
        self._gauge = Fact(classes="gauge")

    def compose(self) -> ComposeResult:
        """Name and mark, three numbers; the same in small; the way between the limits."""
        axis = self._axis
        with Horizontal(classes="numbers"):
            with Vertical(classes="name"):
                letter = f"{axis.letter} {axis.unit}" if axis.turns else axis.letter
                yield Fact(letter, classes="letter")
                yield self._mark
            yield self._big
            yield self._work
            with Container(classes="rest"):
                yield self._machine
                yield self._steps
                yield self._count
            yield from self._plain
        yield self._small
        yield self._gauge

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        i = self._index
        referenced = state.referenced[i]
        self._mark.show("● ref" if referenced else "○ no ref", "-good" if referenced else "-weak")
        work, machine = three_decimals(state.work_mm[i]), three_decimals(state.position_mm[i])
        steps = str(state.position_steps[i])
        for number, text in (
            (self._big, work),
            (self._work, work),
            (self._machine, machine),
            (self._steps, steps),
        ):
            if number.display:
                number.show(text)
        for plain, text in zip(self._plain, (work, machine, steps), strict=True):
            if plain.display:
                plain.show(text)
        if self._count.display:
            self._count.show(f"{steps} {self._step_word}s")
        if self._small.display:
            self._small.show(f"machine {self._axis.with_unit(machine)}  {steps} steps")
        if self._gauge.display:
            self._gauge.show(self._way(state), "" if referenced else "-weak")

    def _way(self, state: MachineState) -> str:
        i = self._index
        low, high, at = state.low_mm[i], state.high_mm[i], state.position_mm[i]
        if not math.isfinite(high - low):
            return "turns without end: no limits"
        if not state.referenced[i]:
            travel = self._axis.with_unit(f"{high - low:g}")
            return f"travel {travel}, not referenced: no limits"
        low_word, high_word = f"{low:g}".rjust(6), f"{high:g}".ljust(6)
        room = max(8, self._gauge.size.width - len(low_word) - len(high_word) - 4)
        share = min(1.0, max(0.0, (at - low) / (high - low)))
        point = round(share * (room - 1))
        return f"{low_word} ├{'─' * point}●{'─' * (room - 1 - point)}┤ {high_word}"


class PositionPanel(Vertical):
    """All axes, with a heading.

    Args:
        shape: of the machine.
    """

    def __init__(self, shape: Shape) -> None:
        super().__init__(id="position")
        self._shape = shape
        self._rows = [
            AxisRow(axis, index, shape.step_word) for index, axis in enumerate(shape.axes)
        ]

    def compose(self) -> ComposeResult:
        """Heading and rows."""
        units = ", ".join(self._shape.units)
        with Horizontal(id="heading"):
            yield Fact("", classes="name")
            yield Fact(f"work {units}", classes="work")
            yield Fact(f"machine {units}", classes="machine")
            yield Fact(f"{self._shape.step_word}s", classes="steps")
        yield from self._rows

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        for row in self._rows:
            row.show(state)
