"""The list of commands in the first picture."""

from typing import Final

from textual.app import ComposeResult
from textual.containers import Grid

from fraese.ui.keys import LISTED
from fraese.ui.links import Link

_COLUMNS: Final = 4


class CommandList(Grid):
    """Every command with its key, to be clicked; read column by column."""

    def __init__(self) -> None:
        super().__init__(id="commands")

    def compose(self) -> ComposeResult:
        """A grid is filled row by row."""
        rows = -(-len(LISTED) // _COLUMNS)
        columns = [LISTED[at : at + rows] for at in range(0, len(LISTED), rows)]
        widths = [max(len(command.shown) for command in column) for column in columns]
        for row in range(rows):
            for column, width in zip(columns, widths, strict=True):
                if row < len(column):
                    command = column[row]
                    yield Link(command.action, command.shown.ljust(width), command.title)
