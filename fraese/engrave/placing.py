"""How large it becomes, and where it lies: the sheet.

origin corner        centre            file
+-------+         +-------+         +-------+
|       |         |   0   |         |       |      0 stays where the
0-------+         +-------+         +-------+      drawing has it
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from fraese.engrave.drawing import Drawing, Picture
from fraese.engrave.job import CENTRE, CORNER, FILE, Job
from fraese.engrave.shapes import Path, Points, bounds
from fraese.errors import UsageError
from fraese.phrases import phrase

#: A picture of which nobody says how large it is becomes so wide, mm.
USUAL_WIDTH_MM: Final = 50.0
#: With this tolerance it is found out how large a drawing is, mm.
_ROUGH_MM: Final = 0.1
#: A drawing that is less wide has no width, mm.
_LEAST_MM: Final = 1e-6
_LARGEST_MM: Final = 10_000.0


@dataclass(frozen=True)
class Sheet:
    """Where everything lies, mm.

    Attributes:
        low: the lower left corner.
        size: width and height.
    """

    low: tuple[float, float]
    size: tuple[float, float]


def placed_drawing(drawing: Drawing, job: Job, name: str) -> tuple[list[Path], Sheet]:
    """The paths of a drawing as large as wanted, and where they are wanted.

    Raises:
        UsageError: if there is nothing in it, or it has no size that could be changed.
    """
    rough = drawing.paths(_ROUGH_MM)
    if not rough:
        raise UsageError(phrase("{name} has no lines that could be cut.", name=name))
    low, high = bounds(rough)
    scale = _scale(high - low, job, name)
    if abs(scale - 1) > 1e-9 or job.tolerance_mm != _ROUGH_MM:
        rough = drawing.paths(job.tolerance_mm / scale)
    low, high = bounds(rough)
    # Curves that were rough before are a little larger now.
    scale = _scale(high - low, job, name)
    size = (high - low) * scale
    _check_size(size, name)
    corner = _corner(size, job, low * scale)
    paths = [path.placed(scale, corner - low * scale) for path in rough]
    return paths, Sheet(_pair(corner), _pair(size))


def placed_picture(picture: Picture, job: Job, name: str) -> tuple[Sheet, list[str]]:
    """Where a picture lies, and what is to be said of that.

    Raises:
        UsageError: if its own zero is asked for.
    """
    if job.origin == FILE:
        raise UsageError(
            phrase(
                "{name} is a picture and has no zero of its own: --origin corner or centre.",
                name=name,
            )
        )
    notes: list[str] = []
    if job.width_mm is None and job.height_mm is None:
        scale = USUAL_WIDTH_MM / picture.columns
        notes.append(
            phrase(
                "{name} becomes {width:g} mm wide; --width or --height say otherwise.",
                name=name,
                width=USUAL_WIDTH_MM,
            )
        )
    else:
        scale = _scale(np.array((picture.columns, picture.rows), np.float64), job, name)
    size = np.array((picture.columns, picture.rows)) * scale
    _check_size(size, name)
    return Sheet(_pair(_corner(size, job, np.zeros(2))), _pair(size)), notes


def _scale(size: Points, job: Job, name: str) -> float:
    """So many mm of a mm."""
    scales = []
    for wanted, there, what in (
        (job.width_mm, float(size[0]), phrase("width")),
        (job.height_mm, float(size[1]), phrase("height")),
    ):
        if wanted is None:
            continue
        if there < _LEAST_MM:
            # Of a straight line one of them is none; the other one counts.
            if job.width_mm is not None and job.height_mm is not None:
                continue
            raise UsageError(
                phrase("{name} has no {what} that could be changed.", name=name, what=what)
            )
        scales.append(wanted / there)
    if not scales and (job.width_mm or job.height_mm):
        raise UsageError(phrase("{name} is one point; it has no size.", name=name))
    return min(scales, default=1.0)


def _check_size(size: Points, name: str) -> None:
    if float(size.max()) > _LARGEST_MM:
        raise UsageError(
            phrase(
                "{name} would be {width:.0f} x {height:.0f} mm; --width or --height make it"
                " smaller.",
                name=name,
                width=float(size[0]),
                height=float(size[1]),
            )
        )


def _corner(size: Points, job: Job, own: Points) -> Points:
    return {CORNER: np.zeros(2), CENTRE: -size / 2, FILE: own}[job.origin]


def _pair(values: Points) -> tuple[float, float]:
    return float(values[0]), float(values[1])
