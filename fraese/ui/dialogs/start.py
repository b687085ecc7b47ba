"""The one question before a program starts: everything that is known of it, at a glance."""

from collections.abc import Collection
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final

from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.widgets import Button, Input, OptionList
from textual.widgets.option_list import Option

from fraese.control.state import MachineState
from fraese.phrases import spoken
from fraese.plaintext import plain
from fraese.ui.briefing import Line, Problem, lines, may_start, problems
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.programs import Program
from fraese.ui.shape import Shape
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.options import Options
from fraese.ui.widgets.pathpane import PathPane
from fraese.ui.widgets.projection import XY
from fraese.ui.widgets.scene import Scene

_LONGEST: Final = 9


class What(Enum):
    """What a person decides."""

    START = auto()
    FRAME = auto()
    LOOK_AT = auto()


@dataclass(frozen=True, slots=True)
class Decision:
    """What is to be done; ``line``: from which on, or at which to look; 0: the first."""

    what: What
    line: int = 0


class StartDialog(Dialog[Decision]):
    """Bounds, tools, time, the machine, all that is wrong; start, the frame first, from a line.

    Args:
        keys: the table.
        program: looked through just now.
        shape: which axes the machine has.
        state: how it stands.
        scene: what is drawn.
        news: what became of the program's file; empty: nothing.
        tried: end switches that were pressed by hand, and seen.
    """

    AREA = Area.START
    COVERS = True
    YES = spoken("Start")

    def __init__(
        self,
        keys: KeyTable,
        program: Program,
        shape: Shape,
        state: MachineState,
        scene: Scene,
        news: str = "",
        tried: Collection[str] = (),
    ) -> None:
        super().__init__(keys)
        facts = program.facts
        assert facts is not None
        self.HEADING = spoken("Start {name}", name=program.name)
        self._count = len(program.lines)
        self._lines: list[Line] = lines(facts, state, shape, tried, program.map_words)
        self._problems: list[Problem] = problems(facts, state, news)
        self._may_start = may_start(self._problems)
        self._moves = facts.low_mm is not None
        self._scene = scene

    def inner(self) -> ComposeResult:
        """Picture and facts side by side, what is wrong below."""
        with Horizontal(id="briefing"):
            yield PathPane(self._scene, XY, id="briefing-path")
            with Vertical(id="briefing-facts"):
                for line in self._lines:
                    fact = Fact(f"{line.label:<10} {line.text}", classes="one-line")
                    fact.set_class(bool(line.tone), line.tone or "-plain")
                    yield fact
        if self._problems:
            yield Options(
                *(Option(Text(plain(problem.words))) for problem in self._problems),
                id="problems",
                compact=True,
            )
        else:
            yield Fact(spoken("✓ Nothing is wrong with it."), classes="-good one-line")
        with Horizontal(id="from-line-row"):
            yield Fact(spoken("from line "), classes="label-beside")
            yield Input(
                "",
                placeholder="1",
                id="from-line",
                max_length=_LONGEST,
                type="integer",
                valid_empty=True,
                compact=True,
            )

    def also(self) -> ComposeResult:
        """The frame, where there is one."""
        if self._may_start and self._moves:
            yield Button(spoken("Frame first"), id="frame", compact=True)

    def on_mount(self) -> None:
        """What is wrong comes first."""
        yes = self.query_one("#yes", Button)
        yes.disabled = not self._may_start
        if self._may_start:
            yes.focus()
        else:
            self.query_one("#problems", OptionList).focus()

    @on(OptionList.OptionSelected, "#problems")
    def _selected(self, event: OptionList.OptionSelected) -> None:
        problem = self._problems[event.option_index]
        if problem.line:
            self.dismiss(Decision(What.LOOK_AT, problem.line))

    @on(Button.Pressed, "#frame")
    def action_frame(self) -> None:
        """Round it first, above the work."""
        if self._may_start and self._moves:
            self.dismiss(Decision(What.FRAME))

    def action_accept(self) -> None:
        """Start, if nothing is wrong."""
        if not self._may_start:
            self.complain(spoken("It is refused: mend the lines above, and open it again."))
            return
        text = self.query_one("#from-line", Input).value.strip()
        line = int(text) if text.isdecimal() else 0
        if text and not 1 <= line <= self._count:
            self.complain(spoken("The program has the lines 1 to {count}.", count=self._count))
            return
        self.dismiss(Decision(What.START, line))


class WayDialog(Dialog[bool]):
    """What a start in the middle will do, before it does it.

    Args:
        keys: the table.
        way: in lines.
    """

    AREA = Area.START_THERE
    COVERS = True
    HEADING = spoken("Start in the middle")
    YES = spoken("Go")

    def __init__(self, keys: KeyTable, way: list[str]) -> None:
        super().__init__(keys)
        self._way = way

    def inner(self) -> ComposeResult:
        """Line by line."""
        for line in self._way:
            yield Fact(line, classes="fact")

    def action_accept(self) -> None:
        """Go."""
        self.dismiss(True)
