"""The log: what has happened, with time and count, the latest last."""

from typing import Final

from textual.app import ComposeResult

from fraese.control.state import MachineState
from fraese.ui.eventlog import Kind
from fraese.ui.keyrows import Area
from fraese.ui.views.view import Desk, View
from fraese.ui.widgets.events import EventList
from fraese.ui.widgets.fact import Fact

#: What can be shown, in words.
_CHOICES: Final = (
    ("All events", tuple(Kind)),
    ("Alarms and warnings", (Kind.ALARM, Kind.WARNING)),
    ("Alarms", (Kind.ALARM,)),
)


class LogView(View):
    """Every alarm, refusal and note."""

    AREA = Area.LOG
    NAME = "log"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._list = EventList(desk.events)
        self._choice = 0
        self._heading = Fact(_CHOICES[0][0], id="log-heading")

    def inner(self) -> ComposeResult:
        """What is shown, and the list."""
        yield self._heading
        yield self._list

    def show_inner(self, state: MachineState) -> None:
        """What has been added."""
        self._list.look()

    def show_said(self, text: str, tone: str) -> None:
        """What was said is an event, too."""
        super().show_said(text, tone)
        self._list.look()

    def action_filter_log(self) -> None:
        """All, or what matters, or alarms only."""
        self._choice = (self._choice + 1) % len(_CHOICES)
        words, kinds = _CHOICES[self._choice]
        self._heading.show(words)
        self._list.choose(kinds)

    def action_copy_log(self) -> None:
        """Give what is shown to the terminal's clipboard."""
        text = self._list.text()
        self.app.copy_to_clipboard(text)
        lines = len(text.splitlines())
        self.say(f"{lines} event{'' if lines == 1 else 's'} copied, if the terminal allows it.")

    def action_scroll_log(self, lines: int) -> None:
        """Look at older ones, or newer ones."""
        self._list.scroll_lines(lines)
