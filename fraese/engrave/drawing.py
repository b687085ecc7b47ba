"""What readers make of files: a drawing of paths, or a picture of dots."""

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from fraese.engrave.shapes import Path
from fraese.errors import UsageError
from fraese.phrases import phrase

#: Further out is no place on a machine, mm.
FURTHEST_MM = 1e6


class Drawing(Protocol):
    """Paths, in mm, with Y upwards.

    Attributes:
        notes: what was left out, and what had to be assumed; a sentence each.
    """

    notes: list[str]

    def paths(self, tolerance_mm: float) -> list[Path]:
        """What is drawn.

        Args:
            tolerance_mm: how far straight lines may be from the curves of the file.

        Raises:
            UsageError: if a point lies too far out.
        """


@runtime_checkable
class Picture(Protocol):
    """Dots, with the first row on top.

    Attributes:
        notes: what was left out, and what had to be assumed; a sentence each.
        columns: dots from left to right,
        rows: and from top to bottom.
    """

    notes: list[str]
    columns: int
    rows: int

    def darkness(self, columns: int, rows: int) -> NDArray[np.uint8]:
        """(rows, columns) how dark it is, 0 to 255, in the mean of each field.

        Raises:
            UsageError: if the file ends too early, or is broken.
        """


def checked(paths: list[Path], name: str) -> list[Path]:
    """The paths, if all of them lie where a machine may come to.

    Raises:
        UsageError: if one does not.
    """
    for path in paths:
        if not (np.abs(path.points) <= FURTHEST_MM).all():
            raise UsageError(
                phrase(
                    "{name}: it draws more than {km:g} km away; is its unit right?",
                    name=name,
                    km=FURTHEST_MM / 1e6,
                )
            )
    return paths
