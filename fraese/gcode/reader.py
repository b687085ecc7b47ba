"""A file of whatever kind as canonical moves."""

from collections.abc import Generator
from contextlib import closing
from itertools import islice
from pathlib import Path
from typing import Final, Literal

from fraese.gcode.canon import Facts, Move
from fraese.gcode.coordlist import looks_like_points, read_points
from fraese.gcode.interpreter import Interpreter
from fraese.gcode.setup import Setup
from fraese.gcode.text import read_lines

Kind = Literal["gcode", "points"]
# How many lines a look into the file takes at most.
GLANCE: Final = 200
_SUFFIXES: Final[dict[str, Kind]] = {
    **dict.fromkeys((".ngc", ".nc", ".gcode", ".gco", ".gc", ".g", ".tap", ".cnc"), "gcode"),
    **dict.fromkeys((".csv", ".tsv", ".xyz", ".pts"), "points"),
}


def kind_of(path: Path) -> Kind:
    """What a file holds, by its suffix, else by its first line that says anything.

    Raises:
        ProgramError: the file cannot be read.
    """
    kind = _SUFFIXES.get(path.suffix.lower())
    if kind is not None:
        return kind
    with closing(read_lines(path)) as lines:
        return "points" if looks_like_points(islice(lines, GLANCE)) else "gcode"


def read_moves(
    path: Path,
    setup: Setup,
    unit: str = "mm",
    feed_mm_min: float = 0.0,
) -> Generator[Move, Facts | None, None]:
    """Yield the moves of a file; answer barriers with ``send``.

    Args:
        path: program or list of coordinates.
        setup: what the program finds.
        unit: unit of a list of coordinates that does not say its own.
        feed_mm_min: feed of a list of coordinates that has none; 0 for none.

    Raises:
        ProgramError: the file cannot be read, or a line is refused.
    """
    lines = read_lines(path, setup.file)
    if kind_of(path) == "gcode":
        yield from Interpreter(setup).run(lines)
    else:
        yield from read_points(lines, setup, unit, feed_mm_min)
