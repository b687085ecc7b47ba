"""What runs in a program that calls subroutines: one frame for each call, with its loops."""

from collections.abc import Sequence
from dataclasses import dataclass

from fraese.gcode.labels import OWord
from fraese.gcode.parameters import Scope
from fraese.gcode.source import Source
from fraese.gcode.subroutines import Sub


@dataclass(slots=True)
class Loop:
    """A loop that is running; ``place`` is its head's line, ``since`` a count of lines."""

    head: OWord
    place: int
    left: int = 0
    since: int = 0


class Frame:
    """A running program or subroutine; the program itself has no name.

    ``sub`` and ``left`` are those of a subprogram that M98 called: what it repeats, how often.
    """

    __slots__ = ("labels", "left", "loops", "name", "scope", "source", "sub")

    def __init__(
        self,
        source: Source,
        name: str = "",
        scope: Scope | None = None,
        sub: Sub | None = None,
        left: int = 0,
    ) -> None:
        self.source = source
        self.name = name
        self.scope = scope
        self.sub = sub
        self.left = left
        self.loops: dict[str, Loop] = {}
        self.labels: dict[str, int] = {}


def has_come_to(frames: Sequence[Frame], wanted: int, line: int, is_in_sub: bool) -> bool:
    """Whether what is carried out belongs to a line of the program, or to one behind it.

    What a line calls belongs to it, whichever file and lines that stands in. A line within a
    subroutine is come to when the subroutine runs.

    Args:
        frames: what is carried out, the program first.
        wanted: number of the line.
        line: that is carried out in the file in hand.
        is_in_sub: the line belongs to a subroutine that was defined.
    """
    main, *deeper = frames
    if not is_in_sub and (main.source.line if deeper else line) >= wanted:
        return True
    return any(
        frame.source.first_line - 1
        <= wanted
        <= (line if frame is frames[-1] else frame.source.line)
        for frame in deeper
        if frame.source.file == main.source.file
    )
