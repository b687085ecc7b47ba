"""What a macro will do, before it does it."""

from typing import Final

from textual.app import ComposeResult

from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Dialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.macros import Macro
from fraese.ui.widgets.fact import Lines

#: So many lines are shown; the dialog must not cover the position.
_SHOWN: Final = 6


class MacroDialog(Dialog[bool]):
    """Its lines, and whether it is meant.

    Args:
        keys: the table.
        macro: which.
    """

    AREA = Area.CONFIRM
    YES = spoken("Run")

    def __init__(self, keys: KeyTable, macro: Macro) -> None:
        super().__init__(keys)
        self.HEADING = macro.name
        self._macro = macro

    def inner(self) -> ComposeResult:
        """Its first lines, or its file."""
        yield Lines("", id="macro-lines", classes="question")

    def on_mount(self) -> None:
        """Line by line; Enter runs them."""
        lines = [self._macro.file] if self._macro.file else list(self._macro.lines)
        more = len(lines) - _SHOWN
        if more > 0:
            lines = [*lines[:_SHOWN], spoken("… and {more} more", more=more)]
        self.query_one("#macro-lines", Lines).show("\n".join(lines))
        self.query_one("#yes").focus()

    def action_accept(self) -> None:
        """Yes."""
        if self.query_one("#back").has_focus:
            self.action_back()
        else:
            self.dismiss(True)
