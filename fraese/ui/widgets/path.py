"""The lines of the program, coloured, the one being played highlighted and kept in view."""

from collections.abc import Callable, Sequence
from typing import Final

from rich.segment import Segment
from rich.style import Style
from textual.geometry import Region, Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from fraese.phrases import spoken
from fraese.plaintext import dotted

#: Kinds of parts that have a colour of their own.
_KINDS: Final = ("comment", "code", "switch", "axis", "word", "flow", "value", "wrong")
#: The parts of a line: of which kind each is, and its text.
Parts = Callable[[str], Sequence[tuple[str, str]]]


def _one_part(line: str) -> Sequence[tuple[str, str]]:
    return (("plain", line),)


class PathView(ScrollView, can_focus=False):
    """Draws only the lines that are seen, so that a long program costs no more than a short one.

    Args:
        open_key: opens a program.
    """

    COMPONENT_CLASSES = {  # noqa: RUF012
        "path--number", "path--line", "path--current", "path--pointed",
        *(f"path--{kind}" for kind in _KINDS),
    }  # fmt: skip

    def __init__(self, open_key: str) -> None:
        super().__init__(id="path")
        self._none = spoken("No program: press {open_key} to open one.", open_key=open_key)
        self._lines: Sequence[str] = ()
        self._parts: Parts = _one_part
        self._current = self._pointed = 0
        self._digits = 6

    @property
    def current(self) -> int:
        """The highlighted line, 1-based; 0: none."""
        return self._current

    def load(self, lines: Sequence[str], parts: Parts = _one_part) -> None:
        """Show this program from its top."""
        self._lines, self._parts = lines, parts
        self._current = self._pointed = 0
        self._digits = max(4, len(str(len(lines))))
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
            self._point_at(0)
            self._keep_in_view(line - 1)

    def show_line(self, line: int) -> None:
        """Look at this line, 1-based; it is pointed at until one is played."""
        self._point_at(line)
        self.scroll_to(y=max(0, line - 1 - self.size.height // 3), animate=False)

    @property
    def pointed_at(self) -> int:
        """The line that somebody wanted to see, 1-based; 0: none."""
        return self._pointed

    def _point_at(self, line: int) -> None:
        before, self._pointed = self._pointed, line
        for changed in (before, line):
            if changed:
                self._refresh_line(changed - 1)

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
            text = "" if self._lines or y else self._none
            return Strip([Segment(text, base)]).adjust_cell_length(width, base)
        current = index + 1 == self._current
        pointed = index + 1 == self._pointed and not current
        style = self.get_component_rich_style("path--current") if current else base
        if pointed:
            style = self.get_component_rich_style("path--pointed")
        number = style if current or pointed else self.get_component_rich_style("path--number")
        sign = Segment(
            f"{'▶' if current else '»' if pointed else ' '}{index + 1:>{self._digits}} ", number
        )
        text = self._lines[index].expandtabs().rstrip("\r\n")[: width + 1]
        return Strip([sign, *self._coloured(text, style, current or pointed)]).adjust_cell_length(
            width, style
        )

    def _coloured(self, text: str, style: Style, whole: bool) -> list[Segment]:
        if whole:
            return [Segment(dotted(text), style)]
        return [
            Segment(
                dotted(part),
                self.get_component_rich_style(f"path--{kind}") if kind in _KINDS else style,
            )
            for kind, part in self._parts(text)
        ]
