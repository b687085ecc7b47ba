"""The outlines of what is dark in a picture, by contourpy (marching squares).

Grey at an edge says where between two dots it lies, so an outline is smoother than the dots are.
"""

from collections.abc import Sequence
from typing import Final

import contourpy
import numpy as np
from numpy.typing import NDArray

from fraese.engrave.curves import simplified
from fraese.engrave.placing import Sheet
from fraese.engrave.shapes import Path, straight

#: Steps of dots are smaller than this share of a dot: lines are drawn through them.
_STAIRS: Final = 0.36
_WHITE: Final = 255.0


def contours(
    darkness: NDArray[np.uint8], threshold: float, sheet: Sheet, tolerance_mm: float
) -> list[Path]:
    """Closed paths round what is darker.

    Args:
        darkness: (rows, columns), the first row on top.
        threshold: per cent.
        sheet: where the picture lies.
        tolerance_mm: of the paths; where a dot is larger, a third of it.
    """
    rows, columns = darkness.shape
    pitch_mm = (sheet.size[0] / columns, sheet.size[1] / rows)
    # With white all round every outline is closed.
    padded = np.zeros((rows + 2, columns + 2), np.float32)
    padded[1:-1, 1:-1] = darkness[::-1]
    level = min(max(threshold / 100 * _WHITE, 0.5), _WHITE - 0.5)
    generator = contourpy.contour_generator(z=padded, line_type=contourpy.LineType.Separate)
    tolerance = max(tolerance_mm, _STAIRS * max(pitch_mm))
    # Dot 1 of the padded picture has its middle half a dot from the edge.
    high = np.add(sheet.low, sheet.size)
    lines = [
        np.clip((line - 0.5) * pitch_mm + sheet.low, sheet.low, high)
        for line in _lines(generator.lines(level))
    ]
    made = simplified(lines, tolerance)
    return [straight(points, close=True) for points in made if len(points) > 3]


def _lines(lines: object) -> Sequence[NDArray[np.float64]]:
    assert isinstance(lines, list)
    return lines
