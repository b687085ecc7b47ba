"""What a file holds: a program, or a list of coordinates."""

from contextlib import closing
from itertools import islice
from pathlib import Path
from typing import Final, Literal

from fraese.gcode.coordlist import looks_like_points
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
