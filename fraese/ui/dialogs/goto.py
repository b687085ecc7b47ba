"""Where to go, asked as words."""

from dataclasses import dataclass
from enum import Enum

from textual.app import ComposeResult
from textual.widgets import Input, RadioButton, RadioSet

from fraese.axiswords import Target, target
from fraese.errors import UsageError
from fraese.ui.dialogs.dialog import Choice, Dialog
from fraese.ui.keys import Area, KeyTable
from fraese.ui.shape import Shape
from fraese.ui.widgets.fact import Fact

_NUMBERS = ("10", "5", "-1", "90")
#: Of all axes, with every digit that counts.
_LONGEST = 500


class From(Enum):
    """What the numbers of a target count from."""

    WORK = "work zero"
    MACHINE = "machine zero"
    HERE = "here"


@dataclass(frozen=True, slots=True)
class GoTo:
    """What was asked for; ``text`` is offered again the next time."""

    target: Target
    counted_from: From
    text: str


def example(shape: Shape) -> str:
    """What may be typed, with its units."""
    words = " ".join(
        f"{axis.letter}{number}" for axis, number in zip(shape.axes, _NUMBERS, strict=False)
    )
    return f"{words} F300   ({', '.join((*shape.units, 'mm/min'))})"


class GoToDialog(Dialog[GoTo]):
    """A position as words.

    Args:
        keys: the table.
        shape: which axes there are.
        last: what was asked for the time before, if anything.
    """

    AREA = Area.GO_TO
    HEADING = "Go to"
    YES = "Go"

    def __init__(self, keys: KeyTable, shape: Shape, last: GoTo | None) -> None:
        super().__init__(keys)
        self._shape = shape
        self._text = last.text if last else ""
        self._counted_from = last.counted_from if last else From.WORK

    def inner(self) -> ComposeResult:
        """One input, one choice."""
        yield Input(self._text, placeholder=example(self._shape), id="target", max_length=_LONGEST)
        yield Fact("counted from", classes="label")
        with RadioSet(id="counted-from"):
            for choice in From:
                yield Choice(choice.value, choice is self._counted_from)

    def action_counted_from(self, by: int) -> None:
        """The next choice, or the one before; also while the input has the focus."""
        buttons = list(self.query(RadioButton))
        at = next(index for index, button in enumerate(buttons) if button.value)
        buttons[(at + by) % len(buttons)].value = True

    def action_accept(self) -> None:
        """Read the words."""
        text = self.query_one("#target", Input).value
        chosen = self.query_one(RadioSet).pressed_index
        try:
            there = target(text, self._shape.names)
        except UsageError as error:
            self.complain(str(error))
            return
        self.dismiss(GoTo(there, list(From)[chosen], text))
