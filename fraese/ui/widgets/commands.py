"""The list of commands in the first picture."""

from collections.abc import Sequence
from typing import Final

from textual.app import ComposeResult
from textual.containers import Grid
from textual.widgets import Static

from fraese.ui.keyrows import Row
from fraese.ui.widgets.links import Link

_COLUMNS: Final = 3


class CommandList(Grid):
    """Every command with its key, to be clicked; read column by column.

    Args:
        listed: the commands.
    """

    def __init__(self, listed: Sequence[Row]) -> None:
        super().__init__(id="commands")
        self._listed = listed
        self._rows = -(-len(listed) // _COLUMNS)
        self.styles.height = self._rows

    def compose(self) -> ComposeResult:
        """A grid is filled row by row."""
        columns = [
            self._listed[at : at + self._rows] for at in range(0, len(self._listed), self._rows)
        ]
        widths = [max(len(command.shown) for command in column) for column in columns]
        for row in range(self._rows):
            for column, width in zip(columns, widths, strict=True):
                if row < len(column):
                    command = column[row]
                    yield Link(command.action, command.shown.ljust(width), command.title)
                else:
                    yield Static("")
