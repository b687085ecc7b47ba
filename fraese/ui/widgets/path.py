"""The lines of the program, the one being played highlighted and kept in view."""

from collections.abc import Sequence

from rich.segment import Segment
from textual.geometry import Region, Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from fraese.plaintext import dotted
from fraese.ui.keys import said

_NONE = f"No program: press {said('open')} to open one."


class PathView(ScrollView, can_focus=False):
    """Draws only the lines that are seen, so that a long program costs no more than a short one."""

    COMPONENT_CLASSES = {"path--number", "path--line", "path--current"}  # noqa: RUF012

    def __init__(self) -> None:
        super().__init__(id="path")
        self._lines: Sequence[str] = ()
        self._current = 0

    @property
    def current(self) -> int:
        """The highlighted line, 1-based; 0: none."""
        return self._current

    def load(self, lines: Sequence[str]) -> None:
        """Show this program from its top."""
        self._lines = lines
        self._current = 0
        self.virtual_size = Size(0, len(lines))
        self.scroll_to(0, 0, animate=False)
        self.refresh()

    def mark(self, line: int) -> None:
        """Highlight this line, 1-based; 0: none."""
        if line == self._current:
            return
        for changed in (self._current, line):
            if changed:
                self._refresh_line(changed - 1)
        self._current = line
        if line:
            self._keep_in_view(line - 1)

    def scroll_pages(self, pages: float) -> None:
        """Look elsewhere, until the next line is played."""
        self.scroll_relative(y=pages * max(1, self.size.height // 2), animate=False)

    def _refresh_line(self, index: int) -> None:
        self.refresh(Region(0, index - self.scroll_offset.y, self.size.width, 1))

    def _keep_in_view(self, index: int) -> None:
        """Scroll by whole stretches: the current line walks from the upper to the lower third."""
        height = self.size.height
        top = index - self.scroll_offset.y
        if not height // 6 <= top < height - max(1, height // 3):
            self.scroll_to(y=max(0, index - height // 3), animate=False)

    def render_line(self, y: int) -> Strip:
        """One line of the screen."""
        index = y + self.scroll_offset.y
        width = self.size.width
        base = self.get_component_rich_style("path--line")
        if index >= len(self._lines):
            text = "" if self._lines or y else _NONE
            return Strip([Segment(text, base)]).adjust_cell_length(width, base)
        current = index + 1 == self._current
        style = self.get_component_rich_style("path--current") if current else base
        number = style if current else self.get_component_rich_style("path--number")
        text = self._lines[index].expandtabs().rstrip("\r\n")
        return Strip(
            [
                Segment(f"{'▶' if current else ' '}{index + 1:>6} ", number),
                Segment(dotted(text), style),
            ]
        ).adjust_cell_length(width, style)
