"""The help screen, made from the key table."""

from textual.app import ComposeResult
from textual.binding import Binding
from textual.containers import Vertical, VerticalScroll
from textual.content import Content
from textual.screen import ModalScreen
from textual.widgets import Static

from fraese.ui.fact import Fact
from fraese.ui.keys import COMMANDS, GROUPS

_NOTES = (
    "At half-step width the original's repeat rule holds: presses 1 to 20 of the same key count"
    " single, from the 21st on ten-fold; only another key resets it.",
    "Nothing here is an emergency stop: that is a switch which cuts the power.",
    "Inside tmux or screen Escape may arrive late (tmux: set escape-time 0); Ctrl+C never does.",
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
                    yield Static(self._group(group), classes="help-group")
                yield Static("\n\n".join(_NOTES), classes="help-notes", markup=False)
            yield Fact("Every command is also in the palette: Ctrl+P.   Esc: back", classes="hint")

    @staticmethod
    def _group(group: str) -> Content:
        lines = [Content.styled(group, "bold $primary")]
        for command in COMMANDS:
            if command.group == group:
                key = Content.styled(f"{command.shown:>6}  ", "bold $accent")
                lines.append(Content.assemble(key, f"{command.title}: {command.help}"))
        return Content("\n").join(lines)
