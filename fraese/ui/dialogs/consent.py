"""Before the configuration is written: which keys, from what to what, in which file."""

from textual.app import ComposeResult
from textual.widgets import Button

from fraese.control.calibration.proposal import Proposal
from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.widgets.fact import Fact


class ConsentDialog(Dialog[bool]):
    """Shows old and new, and asks.

    Args:
        keys: the table.
        proposal: what is to be written.
        path: of the file.
    """

    AREA = Area.CONSENT
    HEADING = spoken("Write the configuration?")
    YES = spoken("Write")

    def __init__(self, keys: KeyTable, proposal: Proposal, path: str) -> None:
        super().__init__(keys)
        self._proposal = proposal
        self._path = path

    def inner(self) -> ComposeResult:
        """Keys, file, and from when on it counts."""
        for change in self._proposal.changes:
            yield Fact(change.words(), classes="change")
        yield Fact(
            spoken(
                "in {path}; comments stay. It counts from the next start of the program.",
                path=self._path,
            ),
            classes="question more",
        )

    def action_accept(self) -> None:
        """Yes."""
        if self.query_one("#back", Button).has_focus:
            self.action_back()
            return
        self.dismiss(True)
