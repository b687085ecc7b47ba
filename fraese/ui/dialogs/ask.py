"""What the job asks, and what is to be done about it."""

from enum import Enum

from textual import on
from textual.app import ComposeResult
from textual.widgets import Button

from fraese.control.state import MachineState
from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.widgets.fact import Fact


class Reply(Enum):
    """What a person wants; the value is the button's id."""

    GO_ON = "yes"
    BY_HAND = "by-hand"
    LIFT = "lift"
    STOP = "back"


class AskDialog(Dialog[Reply]):
    """The job asks for something to be done.

    Args:
        keys: the table.
        question: the job's words.
        lifts: an axis lifts the tool.
    """

    AREA = Area.ASK
    HEADING = spoken("The job waits")
    YES = spoken("Go on")
    BACK = spoken("Stop the job")

    def __init__(self, keys: KeyTable, question: str, *, lifts: bool = True) -> None:
        super().__init__(keys)
        self._question = question
        self._lifts = lifts

    def inner(self) -> ComposeResult:
        """The question."""
        yield Fact(self._question, classes="question")

    def also(self) -> ComposeResult:
        """The machine is free meanwhile."""
        yield Button(spoken("Move by hand"), id=Reply.BY_HAND.value, compact=True)
        if self._lifts:
            yield Button(spoken("Lift the tool"), id=Reply.LIFT.value, compact=True)

    def hints(self) -> str:
        """The line of keys."""
        return self.keys.hint(self.AREA, but=None if self._lifts else "lift")

    def show(self, state: MachineState) -> None:
        """The job may have ended, or ask for something else."""
        if state.question != self._question:
            self.dismiss(None)

    def action_accept(self) -> None:
        """What has the focus; else it has been done."""
        focused = self.focused.id if self.focused is not None else ""
        self.dismiss(next((reply for reply in Reply if reply.value == focused), Reply.GO_ON))

    def action_back(self) -> None:
        """The button that stops says so."""
        self.dismiss(Reply.STOP)

    @on(Button.Pressed, "#by-hand")
    def action_by_hand(self) -> None:
        """Jog, go, touch off; then go on."""
        self.dismiss(Reply.BY_HAND)

    @on(Button.Pressed, "#lift")
    def action_lift(self) -> None:
        """The same, with the tool out of the way."""
        if self._lifts:
            self.dismiss(Reply.LIFT)
