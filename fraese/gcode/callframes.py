"""What runs in a program that calls subroutines: one frame for each call, with its loops."""

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
