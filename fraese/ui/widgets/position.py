"""The position of every axis: work coordinate, large, and what it is made of.

beside                                under
X  -12.345    machine -112.345        X  -12.345
              offset   100.000        machine -112.345  offset 100.000  to go 3.000  ● ref
              ● referenced              0 ├────●────────────────────────────────┤ 296
"""

import math
from typing import Final

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical

from fraese.control.state import MachineState, three_decimals
from fraese.phrases import spoken
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.big import AxisNumber
from fraese.ui.widgets.fact import Fact, Lines

_NUMBER: Final = 9


class AxisRow(Vertical):
    """One axis."""

    def __init__(self, axis: AxisShape, index: int, step_word: str) -> None:
        super().__init__(id=f"axis-{axis.name}", classes="axis")
        self._axis = axis
        self._index = index
        self._step_word = step_word
        self._number = AxisNumber(axis.letter)
        self._beside = Lines(classes="made-of beside")
        self._under = Fact(classes="made-of under")
        self._gauge = Fact(classes="gauge")

    def compose(self) -> ComposeResult:
        """The number, what it is made of, the way between the limits."""
        with Horizontal(classes="numbers"):
            yield self._number
            yield self._beside
        yield self._under
        yield self._gauge

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        referenced = state.referenced[self._index]
        self._number.show(three_decimals(state.work_mm[self._index]), is_known=referenced)
        tone = "" if referenced else "-warn"
        if self._beside.display:
            self._beside.show("\n".join(self._made_of(state)[: self._beside.size.height]), tone)
        if self._under.display:
            self._under.show(_fitting(self._made_of(state), self._under.size.width), tone)
        if self._gauge.display:
            self._gauge.show(self._way(state), "" if referenced else "-weak")

    def _made_of(self, state: MachineState) -> list[str]:
        """What the number is made of, the most important first."""
        i = self._index
        known = state.referenced[i]
        mark = spoken("● ref") if known else spoken("○ NOT REFERENCED")
        # While one axis has some way to go all say so: lines that change places are not read.
        to_go = state.to_go_mm if any(state.to_go_mm) else ()
        way = [spoken("to go   {short}", short=self._short(to_go[i]))] if to_go else []
        return [
            spoken("machine {short}", short=self._short(state.position_mm[i])),
            spoken("offset  {short}", short=self._short(state.offset_mm[i])),
            *(way or [mark]),
            spoken(
                "{steps} {step_word}s", steps=state.position_steps[i], step_word=self._step_word
            ),
        ]

    def _short(self, mm: float) -> str:
        number = three_decimals(mm).rjust(_NUMBER)
        return self._axis.with_unit(number) if self._axis.turns else number

    def _way(self, state: MachineState) -> str:
        i = self._index
        low, high, at = state.low_mm[i], state.high_mm[i], state.position_mm[i]
        if not math.isfinite(high - low):
            return spoken("turns without end: no limits")
        if not state.referenced[i]:
            travel = self._axis.with_unit(f"{high - low:g}")
            return spoken("travel {travel}, not referenced: no limits", travel=travel)
        low_word, high_word = f"{low:g}".rjust(6), f"{high:g}".ljust(6)
        room = max(8, self._gauge.size.width - len(low_word) - len(high_word) - 4)
        share = min(1.0, max(0.0, (at - low) / (high - low)))
        point = round(share * (room - 1))
        return f"{low_word} ├{'─' * point}●{'─' * (room - 1 - point)}┤ {high_word}"


def _fitting(parts: list[str], width: int) -> str:
    """As many of them on one line as there is room for."""
    text = parts[0]
    for part in parts[1:]:
        if len(text) + 2 + len(part) > width:
            break
        text += f"  {part}"
    return text


class PositionPanel(Vertical):
    """All axes.

    Args:
        shape: of the machine.
    """

    def __init__(self, shape: Shape) -> None:
        super().__init__(id="position")
        self._state: MachineState | None = None
        self._rows = [
            AxisRow(axis, index, shape.step_word) for index, axis in enumerate(shape.axes)
        ]

    def compose(self) -> ComposeResult:
        """One below the other."""
        yield from self._rows

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        self._state = state
        for row in self._rows:
            row.show(state)

    def on_resize(self) -> None:
        """What it is made of and the gauges are as long as there is room."""
        if self._state is not None:
            self.show(self._state)
