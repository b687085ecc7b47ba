"""The keys of the configuration, table by table; only what is seen is drawn."""

from collections.abc import Sequence
from itertools import groupby
from typing import Final

from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from fraese.phrases import shown, spoken
from fraese.plaintext import dotted
from fraese.ui.settings import Setting

_NAME: Final = 24
_VALUE: Final = 22
#: In front of what is not as it is by default; it is seen without colours, too.
_OWN: Final = "•"


class SettingList(ScrollView, can_focus=False):
    """One key a line below the name of its table; one of them is looked at."""

    COMPONENT_CLASSES = {  # noqa: RUF012
        "setting--table", "setting--name", "setting--own", "setting--faint", "setting--here",
    }  # fmt: skip

    class Looked(Message):
        """Another key is looked at."""

    def __init__(self) -> None:
        super().__init__(id="settings-list")
        self._rows: list[str | Setting] = []
        self._at = 0

    def load(self, settings: Sequence[Setting]) -> None:
        """Show these; the key that was looked at stays it, if it is among them."""
        here = self.here.key if self.here is not None else ""
        self._rows = []
        for table, some in groupby(settings, lambda setting: setting.table):
            self._rows += [f"[{table}]" if table else spoken("above all tables"), *some]
        self.virtual_size = Size(0, len(self._rows))
        keys = [row.key if not isinstance(row, str) else "" for row in self._rows]
        self._at = keys.index(here) if here in keys else 0
        self.go(0)

    @property
    def here(self) -> Setting | None:
        """The key that is looked at; None: there is none."""
        row = self._rows[self._at] if self._at < len(self._rows) else None
        return None if isinstance(row, str) else row

    def go(self, by: int) -> None:
        """So many keys on."""
        places = [at for at, row in enumerate(self._rows) if not isinstance(row, str)]
        if not places:
            self.refresh()
            return
        now = max((n for n, at in enumerate(places) if at <= self._at), default=0)
        self._look_at(places[min(max(now + by, 0), len(places) - 1)])

    def go_to_table(self, by: int) -> None:
        """The first key of the next table, or of the one before."""
        heads = [at for at, row in enumerate(self._rows) if isinstance(row, str)]
        if heads:
            now = max((n for n, at in enumerate(heads) if at <= self._at), default=0)
            self._look_at(heads[min(max(now + by, 0), len(heads) - 1)] + 1)

    def _look_at(self, at: int) -> None:
        self._at = at
        top, height = self.scroll_offset.y, max(1, self.size.height)
        if at - 1 < top:
            # With the name of its table, where that is just above.
            self.scroll_to(y=at - 1, animate=False)
        elif at >= top + height:
            self.scroll_to(y=at - height + 1, animate=False)
        self.refresh()
        self.post_message(self.Looked())

    def on_click(self, event: events.Click) -> None:
        """A click looks at a key."""
        at = event.y + self.scroll_offset.y
        if at < len(self._rows) and not isinstance(self._rows[at], str):
            self._look_at(at)

    def render_line(self, y: int) -> Strip:
        """One row."""
        at, width = y + self.scroll_offset.y, self.size.width
        plain = self.get_component_rich_style("setting--name")
        if at >= len(self._rows):
            return Strip.blank(width, plain)
        row = self._rows[at]
        if isinstance(row, str):
            style = self.get_component_rich_style("setting--table")
            return Strip([Segment(dotted(row), style)]).adjust_cell_length(width, plain)
        return Strip(self._parts(row, at == self._at)).adjust_cell_length(
            width, self.get_component_rich_style("setting--here") if at == self._at else plain
        )

    def _parts(self, setting: Setting, here: bool) -> list[Segment]:
        own = setting.value != setting.default
        styles: list[Style] = [
            self.get_component_rich_style(f"setting--{'here' if here else name}")
            for name in ("name", "own" if own else "name", "faint")
        ]
        sign = f"{'▶' if here else ' '}{_OWN if own else ' '} "
        texts = (
            sign + _short(setting.name, _NAME),
            _short(setting.value or "–", _VALUE),
            shown(setting.sentence),
        )
        return [Segment(dotted(text), style) for text, style in zip(texts, styles, strict=True)]


def _short(text: str, room: int) -> str:
    return (text if len(text) <= room else f"{text[: room - 1]}…").ljust(room + 1)
