"""How far a look-through is, said now and then."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

from fraese.gcode import canon
from fraese.program.translate import Moves

if TYPE_CHECKING:
    from fraese.program.outline import Outline, OutlineMaker
    from fraese.program.source import ProgramSource

#: Between two words about how far it is.
_TELL_S: Final = 0.1
#: So many moves between two looks at the clock.
_LOOKS: Final = 200


@dataclass(frozen=True, slots=True)
class Stage:
    """How far a look-through is.

    Attributes:
        lines: read so far.
        outline: of what was read; None: no newer one than before.
        line: in hand, in whichever file.
    """

    lines: int
    outline: "Outline | None" = None
    line: int = 0


Tell = Callable[[Stage], object]


class Told(Protocol):
    """What is looked through; the survey."""

    source: "ProgramSource"
    drawing: "OutlineMaker | None"


class Teller:
    """Says now and then how far it is: how many lines often, the outline ever more rarely."""

    def __init__(self, survey: Told, tell: Tell | None) -> None:
        self._survey = survey
        self._tell = tell
        self._told_s = self._began_s = self._drawn_s = time.monotonic()

    def passing(self, moves: Moves) -> Moves:
        """Pass everything on, both ways."""
        facts: canon.Facts | None = None
        count = 0
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            count += 1
            if not count % _LOOKS:
                self._look(move.line)
            facts = yield move

    def _look(self, line: int) -> None:
        now_s, survey = time.monotonic(), self._survey
        if self._tell is None or now_s - self._told_s < _TELL_S:
            return
        self._told_s = now_s
        outline = None
        if survey.drawing is not None and now_s - self._began_s > 2 * (
            self._drawn_s - self._began_s
        ):
            self._drawn_s = now_s
            outline = survey.drawing.outline()
        self._tell(Stage(survey.source.lines_read, outline, line))
