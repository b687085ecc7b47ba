"""Dialogs: one question each, Enter says yes, Escape goes back."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TypeVar

from textual import on
from textual.app import ComposeResult
from textual.binding import Binding
from textual.containers import Horizontal, Vertical
from textual.widgets import Button, Checkbox, DirectoryTree, Input, RadioButton, RadioSet

from fraese.axiswords import Target, target
from fraese.control.state import MachineState
from fraese.errors import UsageError
from fraese.ui.fact import Fact
from fraese.ui.pages import LivePage

R = TypeVar("R")


class Tick(Checkbox):
    """A box whose state is seen without colours too."""

    def __init__(self, label: str, value: bool = False, *, id: str) -> None:  # noqa: A002
        super().__init__(label, value, id=id, compact=True)
        self.BUTTON_INNER = "✓" if value else " "

    def watch_value(self) -> None:
        """Draw the tick, or none."""
        self.BUTTON_INNER = "✓" if self.value else " "
        super().watch_value()


class Choice(RadioButton):
    """One of several, seen without colours too."""

    def __init__(self, label: str, value: bool = False) -> None:
        super().__init__(label, value)
        self.BUTTON_INNER = "●" if value else " "

    def watch_value(self) -> None:
        """Draw the point, or none."""
        self.BUTTON_INNER = "●" if self.value else " "
        super().watch_value()


class Dialog(LivePage[R | None]):
    """A box in the middle, with a title and two buttons. The result None: nothing is wanted."""

    BINDINGS = [Binding("escape", "back", "Back", show=False)]  # noqa: RUF012
    HEADING = ""
    YES = "OK"
    KEYS = "Enter: do it   Esc: back"

    def compose(self) -> ComposeResult:
        """Frame around what ``inner`` gives."""
        with Vertical(classes="dialog"):
            yield Fact(self.HEADING, classes="dialog-title")
            yield from self.inner()
            yield Fact("", id="complaint")
            with Horizontal(classes="buttons"):
                yield Button(self.YES, variant="primary", id="yes", compact=True)
                yield Button("Back", id="back", compact=True)
            yield Fact(self.KEYS, classes="hint")

    def inner(self) -> ComposeResult:
        """What is asked."""
        yield from ()

    def show(self, state: MachineState) -> None:
        """Most dialogs do not care how the machine stands."""

    def complain(self, sentence: str) -> None:
        """Say what is wrong; the dialog stays."""
        self.query_one("#complaint", Fact).show(sentence, "-alarm")

    def action_back(self) -> None:
        """Nothing is wanted."""
        self.dismiss(None)

    def action_accept(self) -> None:
        """Take what was entered, or complain."""

    @on(Button.Pressed, "#yes")
    def _yes(self) -> None:
        self.action_accept()

    @on(Button.Pressed, "#back")
    def _back(self) -> None:
        self.action_back()

    @on(Input.Submitted)
    def _entered(self) -> None:
        self.action_accept()


class From(Enum):
    """What the numbers of a target count from."""

    WORK = "work zero"
    MACHINE = "machine zero"
    HERE = "here"


@dataclass(frozen=True, slots=True)
class GoTo:
    """What was asked for; ``text`` is offered again the next time."""

    target: Target
    counted_from: From
    text: str


class GoToDialog(Dialog[GoTo]):
    """A position as words.

    Args:
        axes: names.
        last: what was asked for the time before, if anything.
    """

    BINDINGS = [  # noqa: RUF012
        Binding("up", "counted_from(-1)", show=False),
        Binding("down", "counted_from(1)", show=False),
    ]
    HEADING = "Go to"
    YES = "Go"
    KEYS = "Enter: go   ↑ ↓: counted from   Esc: back"

    def __init__(self, axes: Sequence[str], last: GoTo | None) -> None:
        super().__init__()
        self._axes = axes
        self._text = last.text if last else ""
        self._counted_from = last.counted_from if last else From.WORK

    def inner(self) -> ComposeResult:
        """One input, one choice."""
        yield Input(self._text, placeholder="X10 Y5 Z-1 F300   (mm, mm/min)", id="target")
        yield Fact("counted from", classes="label")
        with RadioSet(id="counted-from"):
            for choice in From:
                yield Choice(choice.value, choice is self._counted_from)

    def action_counted_from(self, by: int) -> None:
        """The next choice, or the one before; also while the input has the focus."""
        buttons = list(self.query(RadioButton))
        at = next(index for index, button in enumerate(buttons) if button.value)
        buttons[(at + by) % len(buttons)].value = True

    def action_accept(self) -> None:
        """Read the words."""
        text = self.query_one("#target", Input).value
        chosen = self.query_one(RadioSet).pressed_index
        try:
            there = target(text, self._axes)
        except UsageError as error:
            self.complain(str(error))
            return
        self.dismiss(GoTo(there, list(From)[chosen], text))


@dataclass(frozen=True, slots=True)
class Reference:
    """Which axes; ``measure``: run to the other end too."""

    axes: tuple[str, ...]
    measure: bool


class ReferenceDialog(Dialog[Reference]):
    """Which axes to reference.

    Args:
        axes: names, in the order in which they are referenced.
    """

    BINDINGS = [  # noqa: RUF012
        Binding("enter", "accept", show=False, priority=True),
        Binding("m", "tick('measure')", show=False),
        *(Binding(axis, f"tick('axis-{axis}')", show=False) for axis in "xyz"),
    ]
    HEADING = "Reference: run to the end switches"
    YES = "Reference"
    KEYS = "Enter: go   x y z m: choose   Esc: back"

    def __init__(self, axes: Sequence[str]) -> None:
        super().__init__()
        self._axes = tuple(axes)

    def inner(self) -> ComposeResult:
        """A box per axis, all ticked."""
        with Horizontal(classes="boxes"):
            for axis in self._axes:
                yield Tick(axis.upper(), True, id=f"axis-{axis}")
        yield Tick("measure the travel to the other end too", id="measure")

    def action_tick(self, name: str) -> None:
        """Tick or untick."""
        self.query_one(f"#{name}", Checkbox).toggle()

    def action_accept(self) -> None:
        """Which boxes are ticked."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
            return
        ticked = {str(box.id) for box in self.query(Checkbox) if box.value}
        axes = tuple(axis for axis in self._axes if f"axis-{axis}" in ticked)
        if not axes:
            self.complain("Choose at least one axis.")
            return
        self.dismiss(Reference(axes, "measure" in ticked))


class FileTree(DirectoryTree):
    """Folders and files, hidden ones left out."""

    ICON_NODE = "▸ "
    ICON_NODE_EXPANDED = "▾ "
    ICON_FILE = "  "

    def filter_paths(self, paths: Iterable[Path]) -> Iterable[Path]:
        """Leave out what is hidden."""
        return [path for path in paths if not path.name.startswith(".")]


class OpenDialog(Dialog[Path]):
    """A program file: its path is typed, or it is chosen from the tree.

    Args:
        folder: where the tree begins.
        path: what is in the input.
    """

    HEADING = "Open a program"
    YES = "Open"
    KEYS = "Enter: open   Tab: to the files   Esc: back"

    def __init__(self, folder: Path, path: str) -> None:
        super().__init__()
        self._folder = folder
        self._path = path

    def inner(self) -> ComposeResult:
        """Input and tree."""
        yield Input(self._path, placeholder="path of a program file", id="file")
        yield FileTree(self._folder, id="tree")

    @on(DirectoryTree.FileSelected)
    def _chosen(self, event: DirectoryTree.FileSelected) -> None:
        self.dismiss(event.path)

    def action_accept(self) -> None:
        """What was typed."""
        text = self.query_one("#file", Input).value.strip()
        if not text:
            self.complain("Type the path of a program file, or choose one below.")
            return
        self.dismiss(Path(text).expanduser())


class AskDialog(Dialog[bool]):
    """The job asks for something to be done.

    Args:
        question: the job's words.
    """

    BINDINGS = [Binding("enter,space", "accept", show=False, priority=True)]  # noqa: RUF012
    HEADING = "The job waits"
    YES = "Go on"
    KEYS = "Enter: go on   Esc: stop the job"

    def __init__(self, question: str) -> None:
        super().__init__()
        self._question = question

    def inner(self) -> ComposeResult:
        """The question."""
        yield Fact(self._question, classes="question")

    def show(self, state: MachineState) -> None:
        """The job may have ended, or ask for something else."""
        if state.question != self._question:
            self.dismiss(None)

    def action_accept(self) -> None:
        """It has been done."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
            return
        self.dismiss(True)
