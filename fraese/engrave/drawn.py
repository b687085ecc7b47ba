"""A drawing as a picture of dots: what lies in an odd number of closed lines is black.

    +--------+       . # # # .       open lines are one dot wide, black on white and
    |  +--+  |  -->  . # . # .       white on black
    |  +--+  |       . # # # .
    +--------+

Rule 1: a dot is as dark as so much of it lies inside: it is looked at in up to 4 x 4 places.
Rule 2: open lines are whole dots: greys as thin as that would not be left by dithering.
"""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from fraese.engrave.hatching import crossings
from fraese.engrave.placing import Sheet
from fraese.engrave.shapes import Path, Points

#: Places in each direction in which a dot is looked at; fewer where all of them would be too many.
_PLACES: Final = 4
_MOST_PLACES: Final = 64_000_000
_BLACK: Final = 255


class DrawnPicture:
    """See ``drawing.Picture``.

    Args:
        paths: as they lie on the sheet, mm.
        sheet: where that lies.
        tolerance_mm: of arcs.
    """

    def __init__(self, paths: Sequence[Path], sheet: Sheet, tolerance_mm: float) -> None:
        self.notes: list[str] = []
        self.columns = self.rows = 0
        self._sheet = sheet
        self._lines = [path.flattened(tolerance_mm) for path in paths if not path.is_closed]
        self._rings = [path.flattened(tolerance_mm) for path in paths if path.is_closed]

    def darkness(self, columns: int, rows: int) -> NDArray[np.uint8]:
        """See ``drawing.Picture``."""
        places = max(1, min(_PLACES, math.isqrt(_MOST_PLACES // (columns * rows))))
        inside = self._filled(columns * places, rows * places)
        parts = inside[::-1].reshape(rows, places, columns, places)
        dark = (parts.mean(axis=(1, 3)) * _BLACK).round()
        return np.asarray(np.where(self._drawn(columns, rows), _BLACK - dark, dark), np.uint8)

    def _filled(self, columns: int, rows: int) -> NDArray[np.bool_]:
        """(rows, columns), from below: whether the middle of a place is inside."""
        changes = np.zeros((rows, columns + 1), np.bool_)
        if self._rings:
            placed = [self._placed(ring, columns, rows) for ring in self._rings]
            begin = np.concatenate([ring[:-1] for ring in placed])
            end = np.concatenate([ring[1:] for ring in placed])
            which, along = crossings(begin, end, 1.0)
            first = np.clip(np.ceil(along - 0.5), 0, columns).astype(np.int64)
            row = np.clip(which, 0, rows - 1).astype(np.int64)
            np.logical_xor.at(changes, (row, first), True)
        inside: NDArray[np.bool_] = np.logical_xor.accumulate(changes, axis=1)
        return inside[:, :-1]

    def _drawn(self, columns: int, rows: int) -> NDArray[np.bool_]:
        """(rows, columns), from above: whether an open line leads over a dot."""
        picture = Image.new("1", (columns, rows))
        pen = ImageDraw.Draw(picture)
        for line in self._lines:
            at = np.clip(self._placed(line, columns, rows), 0, (columns - 1, rows - 1)).astype(int)
            at[:, 1] = rows - 1 - at[:, 1]
            each = [(x, y) for x, y in at.tolist()]
            if len(each) > 1:
                pen.line(each, fill=1)
            else:
                pen.point(each, fill=1)
        return np.asarray(picture, np.bool_)

    def _placed(self, points: Points, columns: int, rows: int) -> Points:
        """In places, from the lower left corner of the sheet."""
        size, low = np.array(self._sheet.size), np.array(self._sheet.low)
        return np.asarray((points - low) / size * (columns, rows))
