"""One thing that can break something, done only by who says so twice."""

from textual.app import ComposeResult
from textual.widgets import Button

from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.widgets.fact import Fact


class ConfirmDialog(Dialog[bool]):
    """Asks whether it is meant.

    Args:
        keys: the table.
        heading: what it is.
        sentence: what it can break.
        yes: the button that does it.
    """

    AREA = Area.CONFIRM

    def __init__(self, keys: KeyTable, heading: str, sentence: str, yes: str) -> None:
        super().__init__(keys)
        self.HEADING, self.YES = heading, yes
        self._sentence = sentence

    def inner(self) -> ComposeResult:
        """What it can break."""
        yield Fact(self._sentence, classes="question")

    def action_accept(self) -> None:
        """It is meant, unless Back has the focus."""
        self.dismiss(True if not self.query_one("#back", Button).has_focus else None)
