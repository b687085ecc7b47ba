"""The ways in which something is cut: outlines, sweeps, bitmaps.

One more is a function, and a row in ``WAYS``.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from fraese.engrave.chains import cleaned
from fraese.engrave.drawing import Drawing, Picture
from fraese.engrave.job import BITMAP, DOTS, OUTLINE, SWEEP, Job
from fraese.engrave.order import MOST_NESTED, ordered
from fraese.engrave.placing import Sheet, placed_drawing, placed_picture
from fraese.engrave.shapes import Path
from fraese.engrave.strokes import Row, Run, Strokes
from fraese.errors import UsageError
from fraese.phrases import phrase

#: Shorter pieces are none, mm.
_LEAST_MM: Final = 0.001
#: Dots that a picture is made of at most.
_MOST_DOTS: Final = 16_000_000
_BLACK: Final = 255

Source = Drawing | Picture
Tell = Callable[[str], None]
T = TypeVar("T")


class Plan(NamedTuple):
    """What is to be cut.

    Attributes:
        strokes: all of it.
        sheet: where it lies.
        notes: what is to be said of it.
    """

    strokes: Strokes
    sheet: Sheet
    notes: list[str]


def planned(source: Source, job: Job, name: str, tell: Tell = lambda what: None) -> Plan:
    """The strokes that a file becomes.

    Args:
        source: what is in the file.
        job: what somebody wants.
        name: of the file.
        tell: is told what is being done.

    Raises:
        UsageError: if nothing comes of it, or too much.
    """
    return WAYS[job.way](source, job, name, tell)


def _outline(source: Source, job: Job, name: str, tell: Tell) -> Plan:
    tell(phrase("finding outlines"))
    paths, sheet, notes = _paths(source, job, name)
    tell(phrase("looking for a short way"))
    clean = list(cleaned(paths, _LEAST_MM))
    if len(clean) > MOST_NESTED:
        notes.append(
            phrase(
                "{name}: these are {count} outlines; among more than {most} what lies inside is not"
                " cut first.",
                name=name,
                count=len(clean),
                most=MOST_NESTED,
            )
        )
    each = ordered(clean)
    return Plan(Strokes(_any(each, name), len(each)), sheet, notes)


def _sweep(source: Source, job: Job, name: str, tell: Tell) -> Plan:
    from fraese.engrave.hatching import hatched

    tell(phrase("finding outlines"))
    paths, sheet, notes = _paths(source, job, name)
    rings = [path for path in paths if path.is_closed]
    if len(rings) < len(paths):
        notes.append(
            phrase(
                "{name}: {count} lines are not closed; a sweep has nothing to fill there.",
                name=name,
                count=len(paths) - len(rings),
            )
        )
    tell(phrase("filling"))
    rows = hatched(rings, job.angle_deg, job.distance_mm, job.tolerance_mm, both_ways=job.both_ways)
    return Plan(Strokes(_any(rows, name), len(rows)), sheet, notes)


def _bitmap(source: Source, job: Job, name: str, tell: Tell) -> Plan:
    seen, sheet, notes = _as_picture(source, job, name)
    columns = _count(sheet.size[0], job.distance_mm)
    rows = _count(sheet.size[1], job.distance_mm)
    tell(phrase("reading"))
    levels = _levels(_seen(seen, job, columns, rows, name), job)
    full = np.flatnonzero(levels.any(axis=1))
    if not len(full):
        raise _nothing(name)
    made = _rows(levels, full, sheet, job)
    return Plan(Strokes(made, len(full)), sheet, notes)


#: Ways by name.
WAYS: Final[Mapping[str, Callable[[Source, Job, str, Tell], Plan]]] = {
    OUTLINE: _outline,
    SWEEP: _sweep,
    BITMAP: _bitmap,
}


def _paths(source: Source, job: Job, name: str) -> tuple[list[Path], Sheet, list[str]]:
    """What is drawn, or what is dark, as paths on their sheet."""
    if not isinstance(source, Picture):
        return *placed_drawing(source, job, name), []
    from fraese.engrave.contours import contours

    sheet, notes = placed_picture(source, job, name)
    # Finer than the picture is, nothing is gained.
    columns = min(source.columns, _count(sheet.size[0], job.distance_mm))
    rows = min(source.rows, _count(sheet.size[1], job.distance_mm))
    seen = _seen(source, job, columns, rows, name)
    return contours(seen, job.threshold, sheet, job.tolerance_mm), sheet, notes


def _as_picture(source: Source, job: Job, name: str) -> tuple[Picture, Sheet, list[str]]:
    """A picture, or a drawing filled in."""
    if isinstance(source, Picture):
        return source, *placed_picture(source, job, name)
    from fraese.engrave.drawn import DrawnPicture

    paths, sheet = placed_drawing(source, job, name)
    # A line that goes straight up has no width; it becomes one dot wide.
    wide, high = (max(side, job.distance_mm) for side in sheet.size)
    room = Sheet(sheet.low, (wide, high))
    return DrawnPicture(paths, room, job.tolerance_mm), room, []


def _count(length_mm: float, distance_mm: float) -> int:
    return max(1, round(length_mm / distance_mm))


def _any(strokes: Sequence[T], name: str) -> Sequence[T]:
    if not strokes:
        raise _nothing(name)
    return strokes


def _nothing(name: str) -> UsageError:
    return UsageError(phrase("Nothing of {name} is left to be cut this way.", name=name))


# --- dots --------------------------------------------------------------------------------------


def _seen(picture: Picture, job: Job, columns: int, rows: int, name: str) -> NDArray[np.uint8]:
    """How dark a picture is in so many fields."""
    if columns * rows > _MOST_DOTS:
        raise UsageError(
            phrase(
                "{name} would have {columns} x {rows} dots; up to {most:g} million are made. A"
                " greater --distance makes fewer.",
                name=name,
                columns=columns,
                rows=rows,
                most=_MOST_DOTS / 1e6,
            )
        )
    darkness = picture.darkness(columns, rows)
    return _BLACK - darkness if job.inverted else darkness


def _levels(darkness: NDArray[np.uint8], job: Job) -> NDArray[np.uint8]:
    """How strongly each dot is cut: 0 to the number of levels - 1."""
    if job.grey == DOTS:
        from fraese.engrave.pictures import dithered

        return dithered(darkness)
    most = job.levels - 1
    return ((darkness.astype(np.uint16) * most + _BLACK // 2) // _BLACK).astype(np.uint8)


def _rows(
    levels: NDArray[np.uint8], full: NDArray[np.int64], sheet: Sheet, job: Job
) -> Iterator[Row]:
    """Row by row from below, every other one backwards."""
    rows, columns = levels.shape
    pitch_mm, height_mm = sheet.size[0] / columns, sheet.size[1] / rows
    most = 1 if job.grey == DOTS else job.levels - 1
    for number, row in enumerate(reversed(full.tolist())):
        line = levels[row]
        y = sheet.low[1] + (rows - row - 0.5) * height_mm
        backwards = job.both_ways and number % 2 == 1
        edges = np.flatnonzero(np.diff(line)) + 1
        begins = np.concatenate(((0,), edges))
        ends = np.concatenate((edges, (columns,)))
        runs = [
            Run(begin * pitch_mm, end * pitch_mm, int(line[begin]) / most)
            for begin, end in zip(begins.tolist(), ends.tolist(), strict=True)
            if line[begin]
        ]
        along = (1.0, 0.0)
        begin_x = sheet.low[0]
        if backwards:
            width = columns * pitch_mm
            runs = [Run(width - b, width - a, strength) for a, b, strength in reversed(runs)]
            along, begin_x = (-1.0, 0.0), begin_x + width
        yield Row((begin_x, y), along, runs, pitch_mm if job.grey == DOTS else 0.0)
