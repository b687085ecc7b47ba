"""What a file holds: a program, or a list of coordinates."""

from collections.abc import Callable, Generator
from contextlib import closing
from itertools import islice
from pathlib import Path
from typing import Final, Literal

from fraese.gcode.coordlist import looks_like_points
from fraese.gcode.text import read_lines

Kind = Literal["gcode", "points"]
Lines = Generator[str, None, None]
# How many lines a look into the file takes at most.
GLANCE: Final = 200
_SUFFIXES: Final[dict[str, Kind]] = {
    **dict.fromkeys((".ngc", ".nc", ".gcode", ".gco", ".gc", ".g", ".tap", ".cnc"), "gcode"),
    **dict.fromkeys((".csv", ".tsv", ".xyz", ".pts"), "points"),
}


def kind_of(path: Path, open_lines: Callable[[], Lines] | None = None) -> Kind:
    """What a file holds, by its suffix, else by its first line that says anything.

    Args:
        path: its name counts.
        open_lines: its lines; None: from the disk.

    Raises:
        ProgramError: the file cannot be read.
    """
    kind = _SUFFIXES.get(path.suffix.lower())
    if kind is not None:
        return kind
    with closing(read_lines(path) if open_lines is None else open_lines()) as lines:
        return "points" if looks_like_points(islice(lines, GLANCE)) else "gcode"
