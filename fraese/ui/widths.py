"""How far one press of a jog key goes."""

from dataclasses import dataclass
from typing import Final

from fraese.ui.shape import Shape

#: From this press on the jog by single steps goes ten-fold.
REPEAT_FROM: Final = 21
REPEAT_FACTOR: Final = 10
#: What the app starts with: 1 mm.
FIRST_WIDTH: Final = 3


class RepeatRule:
    """The original's repeat rule (TASTATUR.PAS, Eingabe).

    Presses 1 to 20 of the same key count single, from the 21st on ten-fold; only another key
    resets it, a pause does not.
    """

    def __init__(self) -> None:
        self._key = ""
        self._count = 0

    def press(self, key: str) -> None:
        """A key was pressed, any key."""
        if key == self._key:
            self._count += 1
        else:
            self._key, self._count = key, 1

    def forget(self) -> None:
        """Something other than a key was used."""
        self.press("")

    @property
    def factor(self) -> int:
        """What the press last seen counts."""
        return REPEAT_FACTOR if self._count >= REPEAT_FROM else 1


@dataclass(frozen=True, slots=True)
class Width:
    """A jog width.

    Attributes:
        mm: per press, degrees where the axis turns; None: one step, with the repeat rule.
        label: for the display.
    """

    mm: float | None
    label: str


def widths(shape: Shape) -> tuple[Width, ...]:
    """What there is to choose from."""
    units = ",".join(shape.units)
    gap = " " if units.startswith("mm") else ""
    return (
        Width(None, f"1 {shape.step_word}"),
        *(Width(mm, f"{mm:g}{gap}{units}") for mm in (0.01, 0.1, 1.0, 10.0)),
    )
