"""What the job asks."""

from textual.app import ComposeResult
from textual.widgets import Button

from fraese.control.state import MachineState
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keys import Area, KeyTable
from fraese.ui.widgets.fact import Fact


class AskDialog(Dialog[bool]):
    """The job asks for something to be done.

    Args:
        keys: the table.
        question: the job's words.
    """

    AREA = Area.ASK
    HEADING = "The job waits"
    YES = "Go on"

    def __init__(self, keys: KeyTable, question: str) -> None:
        super().__init__(keys)
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
