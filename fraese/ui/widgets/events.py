"""The list of events: only what is seen is drawn, however many there are."""

from typing import Final

from rich.segment import Segment
from textual.geometry import Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from fraese.phrases import shown, spoken
from fraese.plaintext import dotted
from fraese.ui.eventlog import Event, EventLog, Kind

_NONE: Final = spoken("Nothing has happened yet.")
_SIGNS: Final = {Kind.ALARM: "!", Kind.WARNING: "?", Kind.SAID: " "}


class EventList(ScrollView, can_focus=False):
    """Events, one a line and the advice of an alarm below it; keeps to the end unless scrolled.

    Args:
        log: where they are.
    """

    COMPONENT_CLASSES = {"event--said", "event--warning", "event--alarm", "event--time"}  # noqa: RUF012

    def __init__(self, log: EventLog) -> None:
        super().__init__(id="events")
        self._log = log
        self._kinds: tuple[Kind, ...] = tuple(Kind)
        self._seen: tuple[int, int] | None = None
        self._rows: list[tuple[Event, str]] = []

    def look(self) -> None:
        """Draw what was added since the last time."""
        if self._log.version == self._seen:
            return
        self._seen = self._log.version
        at_end = self.scroll_offset.y >= self.max_scroll_y
        self._rows = []
        for event in self._log.of(self._kinds):
            self._rows.append((event, event.title))
            if event.advice:
                self._rows.append((event, f"  {shown(event.advice)}"))
        self.virtual_size = Size(0, len(self._rows))
        if at_end:
            self.scroll_end(animate=False)
        self.refresh()

    def choose(self, kinds: tuple[Kind, ...]) -> None:
        """Show only these."""
        self._kinds, self._seen = kinds, None
        self.look()

    def text(self) -> str:
        """What is shown, for other programs."""
        return "\n".join(
            f"{event.at:%Y-%m-%d %H:%M:%S} {event.kind.value:8}"
            f"{event.title} {shown(event.advice)}".rstrip()
            for event in self._log.of(self._kinds)
        )

    def scroll_lines(self, lines: int) -> None:
        """Look at older ones, or newer ones."""
        self.scroll_relative(y=lines, animate=False)

    def render_line(self, y: int) -> Strip:
        """One row."""
        index, width = y + self.scroll_offset.y, self.size.width
        said = self.get_component_rich_style("event--said")
        if index >= len(self._rows):
            text = "" if self._rows or y else _NONE
            return Strip([Segment(text, said)]).adjust_cell_length(width, said)
        event, text = self._rows[index]
        style = self.get_component_rich_style(f"event--{event.kind.value}")
        first = text == event.title
        clock = f"{event.at:%H:%M:%S} {_SIGNS[event.kind]} " if first else " " * 11
        faint = self.get_component_rich_style("event--time")
        return Strip([Segment(clock, faint), Segment(dotted(text), style)]).adjust_cell_length(
            width, said
        )
