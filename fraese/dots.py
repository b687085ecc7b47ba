"""A field of dots in character cells: braille where the terminal has it, else half blocks.

    braille  2 x 4 dots a cell     half blocks  1 x 2 dots a cell     both: square dots

Rule 1: a dot belongs to a layer. A cell shows the dots of all layers, in the colour of the highest
        that has one there.
Rule 2: lines are drawn many at once, clipped first, so that what a large zoom shows costs no more.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cell:
    """How dots lie in a character.

    Attributes:
        wide: dots side by side,
        high: and one above the other.
        weights: what each adds to the number of the character, row by row.
        characters: by that number.
    """

    wide: int
    high: int
    weights: NDArray[np.int64]
    characters: str


BRAILLE: Final = Cell(
    2,
    4,
    np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]]),
    " " + "".join(chr(0x2800 + n) for n in range(1, 256)),
)
HALVES: Final = Cell(1, 2, np.array([[1], [2]]), " ▀▄█")
#: For terminals that have neither.
ASCII: Final = Cell(1, 2, np.array([[1], [2]]), " '.:")


class Dots:
    """Dots of several layers.

    Args:
        width: in cells.
        height: in cells.
        layers: how many; a later one lies above.
        cell: how dots lie in a cell.

    Attributes:
        dots: (layers, rows, columns) of dots.
    """

    def __init__(self, width: int, height: int, layers: int, cell: Cell = BRAILLE) -> None:
        self.width, self.height, self.cell = width, height, cell
        self.dots = np.zeros((layers, height * cell.high, width * cell.wide), np.bool_)

    def lines(self, layer: int, begin: Points, end: Points) -> NDArray[np.int64]:
        """Draw straight lines; which rows of cells they touch.

        Args:
            layer: theirs.
            begin: (n, 2) of column and row of dots, may lie outside.
            end: likewise.
        """
        rows, columns = self.dots.shape[1:]
        begin, end = _clipped(begin, end, columns, rows)
        if not len(begin):
            return np.zeros(0, np.int64)
        way = end - begin
        counts = np.ceil(np.abs(way).max(axis=1)).astype(np.int64) + 1
        starts = np.cumsum(counts) - counts
        which = np.repeat(np.arange(len(counts)), counts)
        share = (np.arange(counts.sum()) - starts[which]) / np.maximum(counts - 1, 1)[which]
        at = (begin[which] + way[which] * share[:, None]).astype(np.int64)
        x, y = np.clip(at[:, 0], 0, columns - 1), np.clip(at[:, 1], 0, rows - 1)
        self.dots[layer, y, x] = True
        return np.unique(y // self.cell.high)

    def row(self, index: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """A row of cells: the number of each character, and its layer; -1: nothing is there."""
        high, wide = self.cell.high, self.cell.wide
        band = self.dots[:, index * high : (index + 1) * high]
        cells = band.reshape(len(band), high, self.width, wide)
        some = cells.any(axis=(1, 3))
        numbers = (cells.any(axis=0) * self.cell.weights[:, None, :]).sum(axis=(0, 2))
        order = np.arange(len(band))[:, None]
        return numbers, np.where(some, order, -1).max(axis=0)


def _clipped(begin: Points, end: Points, columns: int, rows: int) -> tuple[Points, Points]:
    """The parts of lines that lie inside (Liang and Barsky)."""
    way = end - begin
    enter, leave = np.zeros(len(begin)), np.ones(len(begin))
    inside = np.ones(len(begin), np.bool_)
    with np.errstate(divide="ignore", invalid="ignore"):
        for axis, high in ((0, columns - 0.001), (1, rows - 0.001)):
            step, at = way[:, axis], begin[:, axis]
            first, second = -at / step, (high - at) / step
            stands = step == 0
            inside &= ~stands | ((at >= 0) & (at <= high))
            enter = np.where(stands, enter, np.maximum(enter, np.minimum(first, second)))
            leave = np.where(stands, leave, np.minimum(leave, np.maximum(first, second)))
    inside &= enter <= leave
    begin, way = begin[inside], way[inside]
    return begin + way * enter[inside, None], begin + way * leave[inside, None]
