"""The log: what has happened, with time and count, the latest last."""

from textual.app import ComposeResult

from fraese.control.state import MachineState
from fraese.ui.keys import Area
from fraese.ui.views.view import Desk, View
from fraese.ui.widgets.events import EventList


class LogView(View):
    """Every alarm, refusal and note."""

    AREA = Area.LOG
    NAME = "log"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._list = EventList(desk.events)

    def inner(self) -> ComposeResult:
        """The list."""
        yield self._list

    def show_inner(self, state: MachineState) -> None:
        """What has been added."""
        self._list.look()

    def show_said(self, text: str, tone: str) -> None:
        """What was said is an event, too."""
        super().show_said(text, tone)
        self._list.look()

    def action_scroll_log(self, lines: int) -> None:
        """Look at older ones, or newer ones."""
        self._list.scroll_lines(lines)
