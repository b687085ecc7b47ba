"""What dialogs have in common: one question each, Enter says yes, Escape goes back."""

from typing import TypeVar

from textual import on
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.widgets import Button, Checkbox, Input, RadioButton

from fraese.control.state import MachineState
from fraese.phrases import spoken
from fraese.ui.dialogs.page import LivePage
from fraese.ui.widgets.fact import Fact, Flowing

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


class Dialog(LivePage[R]):
    """A box in the middle, with a title and two buttons."""

    HEADING = ""
    YES = spoken("OK")
    BACK = spoken("Back")

    def compose(self) -> ComposeResult:
        """Frame around what ``inner`` gives."""
        with Vertical(classes="dialog"):
            yield Fact(self.HEADING, classes="dialog-title")
            yield from self.inner()
            yield Flowing("", id="complaint")
            with Horizontal(classes="buttons"):
                yield Button(self.YES, variant="primary", id="yes", compact=True)
                yield from self.also()
                yield Button(self.BACK, id="back", compact=True)
            yield Fact(self.hints(), classes="hint")

    def inner(self) -> ComposeResult:
        """What is asked."""
        yield from ()

    def also(self) -> ComposeResult:
        """Other buttons."""
        yield from ()

    def hints(self) -> str:
        """The line of keys."""
        return self.keys.hint(self.AREA)

    def show(self, state: MachineState) -> None:
        """Most dialogs do not care how the machine stands."""

    def complain(self, sentence: str) -> None:
        """Say what is wrong; the dialog stays."""
        self.query_one("#complaint", Fact).show(sentence, "-alarm")

    def action_accept(self) -> None:
        """Take what was entered, or complain."""

    @on(Button.Pressed, "#yes")
    def _yes(self) -> None:
        if self.is_there:
            self.action_accept()

    @on(Button.Pressed, "#back")
    def _back(self) -> None:
        self.action_back()

    @on(Input.Submitted)
    def _entered(self) -> None:
        if self.is_there:
            self.action_accept()
