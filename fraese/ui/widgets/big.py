"""An axis and its number, as large as there is room for: its letter as tall as its digits."""

from collections.abc import Sequence
from typing import Final

from rich.segment import Segment
from textual.geometry import Size
from textual.reactive import reactive
from textual.strip import Strip
from textual.widget import Widget

from fraese.ui.widgets.glyphs import BOLD, TALL, THIN, Font

#: Drawn in this width whatever the number is, so that nothing jumps.
_WIDEST: Final = "-000.000"
_CHOICE: Final = (
    (TALL, True),
    (BOLD, True),
    (TALL, False),
    (BOLD, False),
    (THIN, False),
)
#: Between letter and number, columns.
_GAP: Final = 3


def font_for(room: Size) -> tuple[Font, bool] | None:
    """The largest that fits, and whether its dots are doubled; None: plain text only."""
    for font, double in _CHOICE:
        needed = len(font.lines("X", double=double)[0]) + _GAP
        needed += len(font.lines(_WIDEST, double=double)[0])
        if room.height >= font.rows(double=double) and room.width >= needed:
            return font, double
    return None


class AxisNumber(Widget):
    """A letter at the left, a number at the right; drawn when one of them changes.

    Args:
        letter: of the axis.
    """

    COMPONENT_CLASSES = {"axis--known", "axis--unknown"}  # noqa: RUF012

    value: reactive[str] = reactive("0.000", layout=False)
    is_known: reactive[bool] = reactive(False, layout=False)

    def __init__(self, letter: str) -> None:
        super().__init__(classes="number")
        self.letter = letter

    def show(self, text: str, *, is_known: bool) -> None:
        """This number; ``is_known``: it can be relied on."""
        self.value = text
        self.is_known = is_known

    def render_line(self, y: int) -> Strip:
        """One line of the letter and the digits."""
        width, choice = self.size.width, font_for(self.size)
        if choice is None:
            letters: Sequence[str] = [self.letter]
            digits: Sequence[str] = [self.value]
        else:
            font, double = choice
            letters = font.lines(self.letter, double=double)
            digits = font.lines(self.value, double=double)
        tone = "axis--known" if self.is_known else "axis--unknown"
        style = self.get_component_rich_style(tone)
        if y >= len(digits):
            return Strip.blank(width, self.rich_style)
        room = max(0, width - len(letters[y]))
        digit = digits[y].rjust(room)[-room:] if room else ""
        return Strip([Segment(letters[y], style), Segment(digit, self.rich_style)], width)
