"""The moves of a program as dots in a terminal: what is cut."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import numpy as np

from fraese.dots import Cell, Dots
from fraese.engrave.moves import Move, way_of
from fraese.engrave.placing import Sheet

#: Lines that are drawn together.
_TOGETHER: Final = 20_000


class Sketch:
    """Rows of characters that fill up as moves pass.

    Args:
        sheet: where what is cut lies.
        columns: characters side by side at most.
        rows: and one below the other at most.
        cell: how dots lie in a character.
    """

    def __init__(self, sheet: Sheet, columns: int, rows: int, cell: Cell) -> None:
        wide, tall = (max(side, 1e-3) for side in sheet.size)
        self._per_mm = min((columns * cell.wide - 1) / wide, (rows * cell.high - 1) / tall)
        width = int(wide * self._per_mm / cell.wide) + 1
        height = int(tall * self._per_mm / cell.high) + 1
        self._dots = Dots(width, height, 1, cell)
        self._corner = (sheet.low[0], sheet.low[1] + sheet.size[1])
        self._at = (0.0, 0.0)
        self._waiting: list[tuple[tuple[float, float], tuple[float, float]]] = []

    def take(self, move: Move) -> None:
        """The next one."""
        begin = self._at
        end = (begin[0] if move.x is None else move.x, begin[1] if move.y is None else move.y)
        self._at = end
        # A cutter that goes down and nowhere else makes a dot.
        if not move.cuts and not (move.z is not None and move.z < 0):
            return
        points = way_of(move, begin, end, 0.3 / self._per_mm)
        self._waiting += pairwise(points)
        if len(self._waiting) > _TOGETHER:
            self._settle()

    def _settle(self) -> None:
        if self._waiting:
            at = (np.array(self._waiting) - self._corner) * (self._per_mm, -self._per_mm)
            self._dots.lines(0, at[:, 0], at[:, 1])
            self._waiting.clear()

    def lines(self) -> Iterator[str]:
        """The rows, from the top."""
        self._settle()
        characters = self._dots.cell.characters
        for row in range(self._dots.height):
            numbers, _ = self._dots.row(row)
            yield "".join(characters[number] for number in numbers.tolist()).rstrip()
