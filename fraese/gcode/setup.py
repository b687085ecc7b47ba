"""What a program finds when it starts."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fraese.gcode.text import lines_of, open_plain, require_inside
from fraese.gcode.userwords import Word, no_word
from fraese.tooldata import ToolData
from fraese.workframe import Point

FileLines = Callable[[Path], Iterator[str] | None]


def lines_on_disk(path: Path) -> Iterator[str] | None:
    """The lines of a file as it is now; None: there is none.

    Raises:
        ProgramError: it cannot be read.
    """
    require_inside(path)
    stream = open_plain(path)
    return None if stream is None else lines_of(stream, str(path))


@dataclass(frozen=True, slots=True)
class Setup:
    """What the interpreter is told before the first line.

    Args:
        axes: letters of the machine's axes, in machine order; so are all points.
        rotary: which of them are in degrees.
        position_mm: start position in machine coordinates; empty: zero.
        parameters: persistent numbered parameters as of LinuxCNC (5161.. and 5181.. for G28
            and G30, 5210 and 5211.. for G92, 5220 for the active system, 5221.. for G54 to
            G59.3), lengths in mm.
        tools: tool table by tool number. None: there is no table, every tool is allowed and
            has length 0. An empty table, on the other hand, knows no tool.
        tool: number of the tool in the spindle, 0 for none.
        inches: start in G20 instead of G21.
        block_delete: whether lines that start with ``/`` are left out.
        file: name of the program for messages.
        folders: where ``o<name> call`` looks for ``name.ngc``, one after the other.
        file_lines: the lines of such a file; None: there is none.
        max_idle_lines: how many lines a loop or subroutine may do without any motion before
            the program counts as one that never ends.
        unreferenced: letters of axes of which nobody knows the place: none of them is moved to a
            place of the machine (G28, G30, G53).
        ignored_m_codes: which of M100 to M199 are passed over; the others are refused.
        user_word: what somebody has made of M100 to M199; None: nothing.
    """

    axes: str = "xyz"
    rotary: str = "abc"
    position_mm: Point = ()
    parameters: Mapping[int, float] = field(default_factory=dict)
    tools: Mapping[int, ToolData] | None = None
    tool: int = 0
    inches: bool = False
    block_delete: bool = False
    file: str = ""
    folders: tuple[Path, ...] = ()
    file_lines: FileLines = lines_on_disk
    max_idle_lines: int = 300_000
    unreferenced: str = ""
    ignored_m_codes: frozenset[int] = frozenset()
    user_word: Callable[[int], Word | None] = no_word
