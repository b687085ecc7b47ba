"""Where to go, asked as words."""

from enum import Enum

from textual.app import ComposeResult
from textual.widgets import RadioButton, RadioSet

from fraese.axiswords import target
from fraese.phrases import spoken
from fraese.ui.dialogs.dialog import Choice
from fraese.ui.dialogs.line import Command, LineDialog
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.machinelink import MachineLink
from fraese.ui.shape import Shape
from fraese.ui.widgets.fact import Fact

#: Under these names it is remembered.
_LINE, _FROM = "go to", "go to, counted from"
_NUMBERS = ("10", "5", "-1", "90")


class From(Enum):
    """What the numbers of a target count from."""

    WORK = spoken("work zero")
    MACHINE = spoken("machine zero")
    HERE = spoken("here")


def example(shape: Shape) -> str:
    """What may be typed, with its units."""
    words = " ".join(
        f"{axis.letter}{number}" for axis, number in zip(shape.axes, _NUMBERS, strict=False)
    )
    return f"{words} F300   ({', '.join((*shape.units, 'mm/min'))})"


class GoToDialog(LineDialog):
    """A position as words; where it cannot go is said here, and can be mended.

    Args:
        keys: the table.
        link: to the machine.
        inputs: what was typed last, by the name of the question.
    """

    AREA = Area.GO_TO
    HEADING = spoken("Go to")
    YES = spoken("Go")

    def __init__(self, keys: KeyTable, link: MachineLink, inputs: dict[str, str]) -> None:
        super().__init__(keys, link, inputs.get(_LINE, ""), example(link.shape))
        names = From.__members__
        self._inputs = inputs
        self._counted_from = names.get(inputs.get(_FROM, ""), From.WORK)

    def inner(self) -> ComposeResult:
        """One input, one choice."""
        yield from super().inner()
        yield Fact(spoken("counted from"), classes="label")
        with RadioSet(id="counted-from"):
            for choice in From:
                yield Choice(choice.value, choice is self._counted_from)

    def action_counted_from(self, by: int) -> None:
        """The next choice, or the one before; also while the input has the focus."""
        buttons = list(self.query(RadioButton))
        at = next(index for index, button in enumerate(buttons) if button.value)
        buttons[(at + by) % len(buttons)].value = True

    def command(self, line: str) -> Command:
        """Read the words."""
        chosen = list(From)[self.query_one(RadioSet).pressed_index]
        wanted = target(line, self.link.shape.names)
        self._counted_from = chosen
        return lambda controller: controller.move_to(
            wanted.targets_mm,
            relative=chosen is From.HERE,
            machine_coordinates=chosen is From.MACHINE,
            feed_mm_min=wanted.feed_mm_min,
        )

    def taken(self, line: str) -> None:
        """It is offered again the next time."""
        self._inputs |= {_LINE: line, _FROM: self._counted_from.name}
        super().taken(line)
