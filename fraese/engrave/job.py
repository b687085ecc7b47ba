"""What somebody wants: which way, how large, with which tool.

Every number has its bounds here, and an option of the same name.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

from fraese.errors import UsageError
from fraese.phrases import phrase

OUTLINE, SWEEP, BITMAP = "outline", "sweep", "bitmap"
CORNER, CENTRE, FILE = "corner", "centre", "file"
DOTS, STEPS = "dots", "steps"


class Bounds(NamedTuple):
    """What a number may be.

    Attributes:
        least: no less,
        most: and no more.
        above: the least itself is too little.
    """

    least: float
    most: float
    above: bool = False


_LENGTH: Final = Bounds(0, 10_000, above=True)
_FEED: Final = Bounds(0, 100_000, above=True)
#: Options with a number, by their names.
BOUNDS: Final[Mapping[str, Bounds]] = {
    "width": _LENGTH,
    "height": _LENGTH,
    "depth": Bounds(0, 1000, above=True),
    "pass-depth": Bounds(0.001, 1000),
    "safe-height": Bounds(0, 1000, above=True),
    "feed": _FEED,
    "plunge-feed": _FEED,
    "spindle": Bounds(0, 1_000_000),
    "power": Bounds(0, 1_000_000, above=True),
    "power-min": Bounds(0, 1_000_000),
    "distance": Bounds(0.005, 1000),
    "dpi": Bounds(1, 5080),
    "angle": Bounds(-360, 360),
    "overscan": Bounds(0, 100),
    "threshold": Bounds(0, 100, above=True),
    "levels": Bounds(2, 256),
    "tabs": Bounds(0, 1000),
    "tab-width": _LENGTH,
    "tab-height": Bounds(0, 1000, above=True),
    "tolerance": Bounds(0.0005, 10),
}


def check_number(option: str, value: float) -> None:
    """See whether an option may have this value.

    Raises:
        UsageError: if it may not.
    """
    bounds = BOUNDS[option]
    if bounds.least <= value <= bounds.most and not (bounds.above and value == bounds.least):
        return
    template = (
        phrase("above {least:g} and up to {most:g}", least=bounds.least, most=bounds.most)
        if bounds.above
        else phrase("from {least:g} to {most:g}", least=bounds.least, most=bounds.most)
    )
    raise UsageError(
        phrase(
            "--{option} is {value:g}; it goes {bounds}.",
            option=option,
            value=value,
            bounds=template,
        )
    )


class Tabs(NamedTuple):
    """Bridges that hold what is cut out.

    Attributes:
        number: of each closed path; 0: there are none.
        width_mm: of the way of the tool's middle.
        height_mm: above the bottom.
    """

    number: int
    width_mm: float
    height_mm: float


NO_TABS: Final = Tabs(0, 4.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class Job:
    """What is to be made of a file; lengths in mm.

    Attributes:
        way: outline, sweep or bitmap.
        width_mm: of all of it,
        height_mm: likewise; with both it fits into both; with none it is as large as its file says.
        origin: what is at zero: its lower left corner, its centre, or the zero of the file.
        distance_mm: from line to line, and from dot to dot.
        angle_deg: of the lines of a sweep.
        both_ways: every other line is cut backwards.
        threshold: what is darker is dark, per cent.
        inverted: what is bright is cut.
        grey: of a bitmap: dots, or steps.
        levels: so many steps, white counted.
        tolerance_mm: lines are nowhere further from curves.
        tabs: of outlines.
    """

    way: str = OUTLINE
    width_mm: float | None = None
    height_mm: float | None = None
    origin: str = CORNER
    distance_mm: float = 0.1
    angle_deg: float = 0.0
    both_ways: bool = True
    threshold: float = 50.0
    inverted: bool = False
    grey: str = DOTS
    levels: int = 16
    tolerance_mm: float = 0.01
    tabs: Tabs = NO_TABS
