"""The list of commands in the first picture."""

from textual.app import ComposeResult
from textual.containers import ItemGrid

from fraese.ui.keys import COMMANDS
from fraese.ui.links import Link

#: Not in the list: the widths have their own line, the path is in another picture.
_ELSEWHERE = ("width", "set_width", "scroll_path")


class CommandList(ItemGrid):
    """Every command with its key, to be clicked."""

    def __init__(self) -> None:
        super().__init__(id="commands")

    def compose(self) -> ComposeResult:
        """As in the table."""
        for command in COMMANDS:
            if command.action.partition("(")[0] not in _ELSEWHERE:
                yield Link(command.action, command.shown, command.title)
