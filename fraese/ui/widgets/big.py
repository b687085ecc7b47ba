"""Digits larger than Textual's, for the picture that is read from across the workshop.

A digit is 5 x 8 dots. A dot is one column wide and half a row high, or in a large terminal two
columns wide and one row high.
"""

from typing import Final

from rich.segment import Segment
from textual.geometry import Size
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

_ROWS: Final = 8
#: Dots of a character, row by row, the leftmost dot in the highest bit; and its width.
_DOTS: Final[dict[str, tuple[int, tuple[int, ...]]]] = {
    "0": (5, (0x0E, 0x1B, 0x1B, 0x1B, 0x1B, 0x1B, 0x1B, 0x0E)),
    "1": (5, (0x06, 0x0E, 0x1E, 0x06, 0x06, 0x06, 0x06, 0x1F)),
    "2": (5, (0x0E, 0x1B, 0x03, 0x03, 0x06, 0x0C, 0x18, 0x1F)),
    "3": (5, (0x0E, 0x1B, 0x03, 0x06, 0x06, 0x03, 0x1B, 0x0E)),
    "4": (5, (0x03, 0x07, 0x0F, 0x1B, 0x1B, 0x1F, 0x03, 0x03)),
    "5": (5, (0x1F, 0x18, 0x18, 0x1E, 0x03, 0x03, 0x1B, 0x0E)),
    "6": (5, (0x0E, 0x1B, 0x18, 0x1E, 0x1B, 0x1B, 0x1B, 0x0E)),
    "7": (5, (0x1F, 0x03, 0x03, 0x06, 0x06, 0x0C, 0x0C, 0x0C)),
    "8": (5, (0x0E, 0x1B, 0x1B, 0x0E, 0x1B, 0x1B, 0x1B, 0x0E)),
    "9": (5, (0x0E, 0x1B, 0x1B, 0x1B, 0x0F, 0x03, 0x1B, 0x0E)),
    "-": (5, (0x00, 0x00, 0x00, 0x1F, 0x1F, 0x00, 0x00, 0x00)),
    ".": (2, (0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x03)),
    " ": (5, (0x00,) * _ROWS),
}
_HALVES: Final = {(False, False): " ", (True, False): "▀", (False, True): "▄", (True, True): "█"}


def _dots(text: str, row: int) -> list[bool]:
    """One row of dots, a blank one between characters."""
    dots: list[bool] = []
    for char in text:
        width, rows = _DOTS[char]
        dots += [bool(rows[row] >> bit & 1) for bit in range(width - 1, -1, -1)] + [False]
    return dots[:-1]


def big_lines(text: str, double: bool) -> list[str]:
    """A number in large digits: 4 lines, or 8 lines of double width."""
    if double:
        return ["".join("██" if dot else "  " for dot in _dots(text, row)) for row in range(_ROWS)]
    return [
        "".join(_HALVES[pair] for pair in zip(_dots(text, row), _dots(text, row + 1), strict=True))
        for row in range(0, _ROWS, 2)
    ]


class BigNumber(Widget):
    """A right-aligned number, drawn when it changes; as large as the height allows."""

    value: reactive[str] = reactive("0", layout=False)

    def show(self, text: str) -> None:
        """This number."""
        self.value = text

    def render_line(self, y: int) -> Strip:
        """One line of the digits."""
        width = self.size.width
        lines = big_lines(self.value, double=self.size.height >= _ROWS)
        text = lines[y] if y < len(lines) else ""
        return Strip([Segment(text.rjust(width)[-width:], self.rich_style)], width)

    def get_content_width(self, container: Size, viewport: Size) -> int:
        """What the number needs."""
        return len(big_lines(self.value, double=self.size.height >= _ROWS)[0])
