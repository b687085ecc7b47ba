"""What a crash has left of the position, and what is to be made of it."""

from enum import Enum, auto

from textual import on
from textual.app import ComposeResult
from textual.widgets import Button

from fraese.control.asleft import Left
from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.widgets.fact import Fact


class Answer(Enum):
    """What a person makes of it."""

    REFERENCE = auto()
    AS_LEFT = auto()


class CrashDialog(Dialog[Answer]):
    """Reference again, or the position as it was left, where that may be.

    Args:
        keys: the table.
        left: what is known.
    """

    AREA = Area.CRASH
    HEADING = spoken("After a crash")
    YES = spoken("Reference again")

    def __init__(self, keys: KeyTable, left: Left) -> None:
        super().__init__(keys)
        self._left = left

    def inner(self) -> ComposeResult:
        """What is known, and what it rests on."""
        yield Fact(self._left.known, classes="question")
        if self._left.may_be_taken:
            yield Fact(self._left.nearness, classes="question more")

    def also(self) -> ComposeResult:
        """Only where the motors find back."""
        if self._left.may_be_taken:
            yield Button(spoken("Position as left"), id="as-left", compact=True)

    def hints(self) -> str:
        """The line of keys."""
        return self.keys.hint(self.AREA, but=None if self._left.may_be_taken else "as_left")

    @on(Button.Pressed, "#as-left")
    def action_as_left(self) -> None:
        """It is where it was left."""
        if self._left.may_be_taken:
            self.dismiss(Answer.AS_LEFT)

    def action_accept(self) -> None:
        """What has the focus, else reference again."""
        focused = self.focused.id if self.focused is not None else ""
        if focused == "back":
            self.action_back()
        elif focused == "as-left":
            self.action_as_left()
        else:
            self.dismiss(Answer.REFERENCE)
