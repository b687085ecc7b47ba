"""Plotter files (HPGL), as the cards of the time came with a program for.

    bytes --lexer--> commands --plotter, by the table of commands--> paths in mm

Rule 1: a plotter's unit is 0.025 mm.
Rule 2: what draws is drawn, with every pen alike. What does not is passed over, with a word for
        each command, said once.
Rule 3: nothing is refused but what cannot be a plotter file at all.
"""

from fraese.engrave.chains import chained
from fraese.engrave.drawing import checked
from fraese.engrave.hpgl.commands import carry_out
from fraese.engrave.hpgl.lexer import commands
from fraese.engrave.hpgl.plotter import Plotter
from fraese.engrave.shapes import Path

#: Of the first look, which finds out what is to be said, in mm.
_COARSE_MM = 1.0


class HpglDrawing:
    """See ``drawing.Drawing``.

    Args:
        data: what is in the file.
        name: of the file.
    """

    def __init__(self, data: bytes, name: str) -> None:
        self._name = name
        self._commands = list(commands(data))
        self.notes: list[str] = []
        self.notes = self._plotted(_COARSE_MM).notes

    def paths(self, tolerance_mm: float) -> list[Path]:
        """See ``drawing.Drawing``."""
        return chained(checked(self._plotted(tolerance_mm).paths, self._name))

    def _plotted(self, tolerance_mm: float) -> Plotter:
        plotter = Plotter(self._name, tolerance_mm)
        for command in self._commands:
            carry_out(command, plotter)
        plotter.lift()
        return plotter


def read(data: bytes, name: str) -> HpglDrawing:
    """A drawing.

    Raises:
        UsageError: never for what is in it; when it is drawn, if it leaves all bounds.
    """
    return HpglDrawing(data, name)
