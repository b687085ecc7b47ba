"""The line of keys at the bottom: what there is room for, the stop key first, to be clicked."""

from collections.abc import Sequence
from dataclasses import dataclass

from textual import events
from textual.content import Content
from textual.widget import Widget

from fraese.ui.keyrows import Row
from fraese.ui.widgets.links import Link


@dataclass(frozen=True, slots=True)
class Entry:
    """A key with its word; ``here``: it leads to where one is."""

    row: Row
    word: str
    here: bool = False

    @property
    def width(self) -> int:
        """Columns."""
        return len(self.row.shown) + 1 + len(self.word)


class KeyBar(Widget):
    """Keys with their words. Where they do not fit, first the gaps shrink, then words, then keys.

    Args:
        first: what is kept longest, in this order.
        views: the keys of the views, by name.
        more: what is added where there is room.
        here: the view that it belongs to.
    """

    def __init__(
        self, first: Sequence[Row], views: dict[str, Row], more: Sequence[Row], here: str
    ) -> None:
        super().__init__(id="keys")
        self._first = first
        self._views = views
        self._more = more
        self._here = here
        self._places: list[tuple[int, int, str]] = []

    def _entries(self, *, full: bool, more: int) -> list[Entry]:
        views = [
            Entry(row, row.title if full else row.footer, name == self._here)
            for name, row in self._views.items()
        ]
        first = [Entry(row, row.footer) for row in self._first]
        return [*first, *views, *(Entry(row, row.footer) for row in self._more[:more])]

    def fitting(self, width: int) -> tuple[list[Entry], int]:
        """What is shown in this width, and how far apart."""
        for more in range(len(self._more), -1, -1):
            for full, gap in ((True, 3), (True, 2)):
                entries = self._entries(full=full, more=more)
                if _width(entries, gap) <= width:
                    return entries, gap
        for gap in (2, 1):
            entries = self._entries(full=False, more=0)
            if _width(entries, gap) <= width:
                return entries, gap
        while len(entries) > 1 and _width(entries, 1) > width:
            # The stop key and the views that are near stay.
            entries.pop(1 if len(entries) > len(self._views) + 1 else -1)
        return entries, 1

    def render(self) -> Content:
        """One line."""
        entries, gap = self.fitting(self.size.width)
        parts: list[tuple[str, str] | str] = []
        self._places, at = [], 0
        for entry in entries:
            if parts:
                parts.append(" " * gap)
                at += gap
            key, word = ("reverse bold",) * 2 if entry.here else ("bold $accent", "")
            parts += [(f"{entry.row.shown} ", key), (entry.word, word)]
            self._places.append((at, at + entry.width, entry.row.action))
            at += entry.width
        return Content.assemble(*parts)

    def on_click(self, event: events.Click) -> None:
        """A click does what the key does."""
        at = event.get_content_offset(self)
        for left, right, action in self._places:
            if at is not None and left <= at.x < right:
                self.post_message(Link.Clicked(action))


def _width(entries: Sequence[Entry], gap: int) -> int:
    return sum(entry.width for entry in entries) + gap * (len(entries) - 1)
