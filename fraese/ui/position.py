"""The position of every axis, large: work and machine coordinates in mm, and half-steps."""

from textual.app import ComposeResult
from textual.containers import Container, Horizontal, Vertical

from fraese.control.state import MachineState
from fraese.ui.big import BigNumber
from fraese.ui.fact import Fact, Number


def millimetres(position_mm: float) -> str:
    """Three decimals, never minus nil."""
    return f"{round(position_mm, 3) + 0.0:.3f}"


class AxisRow(Vertical):
    """One axis."""

    def __init__(self, name: str, index: int) -> None:
        super().__init__(id=f"axis-{name}", classes="axis")
        self._axis_name = name
        self._index = index
        self._mark = Fact(classes="mark")
        self._big = BigNumber(classes="big")
        self._work = Number(8, classes="work")
        self._machine = Number(8, classes="machine")
        self._steps = Number(6, classes="steps")
        self._count = Fact(classes="count")
        self._small = Fact(classes="small")
        self._gauge = Fact(classes="gauge")

    def compose(self) -> ComposeResult:
        """Name and mark, three numbers; the same in small; the way between the limits."""
        with Horizontal(classes="numbers"):
            with Vertical(classes="name"):
                yield Fact(self._axis_name.upper(), classes="letter")
                yield self._mark
            yield self._big
            yield self._work
            with Container(classes="rest"):
                yield self._machine
                yield self._steps
                yield self._count
        yield self._small
        yield self._gauge

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        i = self._index
        referenced = state.referenced[i]
        self._mark.show("● ref" if referenced else "○ no ref", "-good" if referenced else "-weak")
        for number, text in (
            (self._big, millimetres(state.work_mm[i])),
            (self._work, millimetres(state.work_mm[i])),
            (self._machine, millimetres(state.position_mm[i])),
            (self._steps, str(state.position_steps[i])),
        ):
            if number.display:
                number.show(text)
        if self._count.display:
            self._count.show(f"{state.position_steps[i]} half-steps")
        if self._small.display:
            self._small.show(
                f"machine {millimetres(state.position_mm[i])} mm  {state.position_steps[i]} steps"
            )
        if self._gauge.display:
            self._gauge.show(self._way(state), "" if referenced else "-weak")

    def _way(self, state: MachineState) -> str:
        i = self._index
        if not state.referenced[i]:
            return f"travel {state.high_mm[i] - state.low_mm[i]:g} mm, not referenced: no limits"
        low_mm, high_mm, at_mm = state.low_mm[i], state.high_mm[i], state.position_mm[i]
        low, high = f"{low_mm:g}".rjust(6), f"{high_mm:g}".ljust(6)
        room = max(8, self._gauge.size.width - len(low) - len(high) - 4)
        share = min(1.0, max(0.0, (at_mm - low_mm) / (high_mm - low_mm)))
        at = round(share * (room - 1))
        return f"{low} ├{'─' * at}●{'─' * (room - 1 - at)}┤ {high}"


class PositionPanel(Vertical):
    """All axes, with a heading."""

    def __init__(self, axes: tuple[str, ...]) -> None:
        super().__init__(id="position")
        self._rows = [AxisRow(name, index) for index, name in enumerate(axes)]

    def compose(self) -> ComposeResult:
        """Heading and rows."""
        with Horizontal(id="heading"):
            yield Fact("", classes="name")
            yield Fact("work mm", classes="work")
            yield Fact("machine mm", classes="machine")
            yield Fact("half-steps", classes="steps")
        yield from self._rows

    def show(self, state: MachineState) -> None:
        """Draw what changed."""
        for row in self._rows:
            row.show(state)
