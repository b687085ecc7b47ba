"""The log: what has happened, with time and count, the latest last."""

from typing import Final

from textual.app import ComposeResult

from fraese.control.state import MachineState
from fraese.phrases import spoken
from fraese.ui.eventlog import Kind
from fraese.ui.keyrows import Area
from fraese.ui.views.view import Desk, View
from fraese.ui.widgets.events import EventList
from fraese.ui.widgets.fact import Fact

#: What can be shown, in words.
_CHOICES: Final = (
    (spoken("All events"), tuple(Kind)),
    (spoken("Alarms and warnings"), (Kind.ALARM, Kind.WARNING)),
    (spoken("Alarms"), (Kind.ALARM,)),
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
        self.say(
            spoken("1 event copied, if the terminal allows it.")
            if lines == 1
            else spoken("{lines} events copied, if the terminal allows it.", lines=lines)
        )

    def action_scroll_log(self, lines: int) -> None:
        """Look at older ones, or newer ones."""
        self._list.scroll_lines(lines)
