"""How far one press of a jog key goes."""

from dataclasses import dataclass
from typing import Final

from fraese.phrases import spoken
from fraese.ui.shape import Shape

#: From this press on the jog by single steps goes ten-fold.
REPEAT_FROM: Final = 21
REPEAT_FACTOR: Final = 10
#: After so long without a key the count begins anew.
PAUSE_S: Final = 1.0
#: What the app starts with: 1 mm.
FIRST_WIDTH: Final = 3


class RepeatRule:
    """The original's repeat rule (TASTATUR.PAS, Eingabe).

    Presses 1 to 20 of the same key count single, from the 21st on ten-fold; another key resets it.
    Unlike the original's, a pause does so too: who comes back means one step.

    Attributes:
        factor: what the press counts that is being done. It may have been made some time ago, with
            others behind it already.
    """

    def __init__(self) -> None:
        self._key = ""
        self._count = 0
        self._at_s = 0.0
        self.factor = 1

    def press(self, key: str, at_s: float = 0.0) -> int:
        """A key was pressed, any key; at this time. What it will count when it is done."""
        gap_s, self._at_s = at_s - self._at_s, at_s
        is_same = key == self._key and gap_s < PAUSE_S
        self._key, self._count = key, self._count + 1 if is_same else 1
        return REPEAT_FACTOR if self._count >= REPEAT_FROM else 1

    def does(self, factor: int) -> None:
        """A press that counts so much is done next."""
        self.factor = factor

    def forget(self) -> None:
        """Something other than a key was used, or nothing for a while."""
        self.press("")
        self.factor = 1


@dataclass(frozen=True, slots=True)
class Width:
    """A jog width.

    Attributes:
        mm: per press, degrees where the axis turns; None: one step, with the repeat rule.
        label: for the display.
    """

    mm: float | None
    label: str


def plain_rate(feed_mm_min: float) -> str:
    """A rate without its unit."""
    return f"{feed_mm_min:.10g}"


def rate_words(feed_mm_min: float, shape: Shape) -> str:
    """A rate with its unit: 600 mm/min, 90°/min; 600/min where there are axes of both kinds."""
    number, units = plain_rate(feed_mm_min), shape.units
    unit = units[0] if len(units) == 1 else ""
    return f"{number} {unit}/min" if unit == "mm" else f"{number}{unit}/min"


def widths(shape: Shape) -> tuple[Width, ...]:
    """What there is to choose from."""
    units = ",".join(shape.units)
    gap = " " if units.startswith("mm") else ""
    return (
        Width(None, spoken("1 {step_word}", step_word=shape.step_word)),
        *(Width(mm, f"{mm:g}{gap}{units}") for mm in (0.01, 0.1, 1.0, 10.0)),
    )
