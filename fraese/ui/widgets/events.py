"""The list of events: only what is seen is drawn, however many there are."""

import textwrap
from collections.abc import Iterator
from typing import Final

from rich.segment import Segment
from textual.geometry import Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from fraese.phrases import shown, spoken
from fraese.plaintext import dotted
from fraese.ui.eventlog import Event, EventLog, Kind

_NONE: Final = spoken("Nothing has happened yet.")
#: Columns of time and sign; so many are left to the words at least.
_CLOCK, _LEAST = 11, 20
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
        # An event, a row of its words, and whether that is its first.
        self._rows: list[tuple[Event, str, bool]] = []

    def on_resize(self) -> None:
        """Other words fit into a row."""
        self._seen = None
        self.look()

    def look(self) -> None:
        """Draw what was added since the last time."""
        if self._log.version == self._seen:
            return
        self._seen = self._log.version
        at_end = self.scroll_offset.y >= self.max_scroll_y
        room = max(_LEAST, self.size.width - _CLOCK)
        self._rows = [
            (event, row, at == 0)
            for event in self._log.of(self._kinds)
            for at, row in enumerate(_wrapped(event, room))
        ]
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
        event, text, is_first = self._rows[index]
        style = self.get_component_rich_style(f"event--{event.kind.value}")
        clock = f"{event.at:%H:%M:%S} {_SIGNS[event.kind]} " if is_first else " " * _CLOCK
        faint = self.get_component_rich_style("event--time")
        return Strip([Segment(clock, faint), Segment(dotted(text), style)]).adjust_cell_length(
            width, said
        )


def _wrapped(event: Event, room: int) -> Iterator[str]:
    """Its words in rows, the advice of an alarm below them."""
    yield from textwrap.wrap(event.title, room) or [""]
    yield from textwrap.wrap(shown(event.advice), room, initial_indent="  ", subsequent_indent="  ")
