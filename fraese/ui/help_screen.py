"""The help screen, made from the key table."""

from rich.table import Table
from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from fraese.ui.fact import Fact
from fraese.ui.keys import COMMANDS, GROUPS

_NOTES = (
    "At half-step width the original's repeat rule holds: presses 1 to 20 of the same key count"
    " single, from the 21st on ten-fold; only another key resets it.",
    "Nothing here is an emergency stop: that is a switch which cuts the power.",
    "Escape takes a tenth of a second, since longer keys begin like it; inside tmux or screen more"
    " (tmux: set escape-time 0). Ctrl+C takes none.",
)


class HelpScreen(ModalScreen[None]):
    """Keys by group."""

    BINDINGS = [Binding("escape,question_mark,f1,q", "dismiss", show=False)]  # noqa: RUF012

    def compose(self) -> ComposeResult:
        """Heading, groups, notes."""
        with Vertical(classes="dialog wide"):
            yield Fact("Keys", classes="dialog-title")
            with VerticalScroll():
                for group in GROUPS:
                    yield Fact(group, classes="help-heading")
                    yield Static(self._group(group), classes="help-group")
                yield Static("\n\n".join(_NOTES), classes="help-notes", markup=False)
            yield Fact("Every command is also in the palette: Ctrl+P.   Esc: back", classes="hint")

    @staticmethod
    def _group(group: str) -> Table:
        table = Table.grid(padding=(0, 2))
        table.add_column(justify="right", min_width=5, no_wrap=True)
        table.add_column()
        for command in COMMANDS:
            if command.group == group:
                table.add_row(Text(command.shown, "bold"), f"{command.title}: {command.help}")
        return table
