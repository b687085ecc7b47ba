"""A look-through that takes long says so, and how far it is.

0 s          1 s                       10 s without a new line
nothing      progress, or one note     the line round which it goes
"""

import sys
import time
from collections.abc import Callable
from typing import Final

from fraese.cli.output import note, show_progress, wipe_progress
from fraese.errors import FraeseError, ProgramError
from fraese.phrases import phrase
from fraese.program.check import Facts
from fraese.program.telling import Stage

_SILENT_S: Final = 1.0
_ROUND_S: Final = 10.0


class Looking:
    """Told how far a look-through is.

    Args:
        name: of the file.
        now_s: a clock.
    """

    def __init__(self, name: str, now_s: Callable[[], float] = time.monotonic) -> None:
        self._name = name
        self._now_s = now_s
        self._began_s = self._new_s = now_s()
        self._lines = 0
        self._is_told = self._is_warned = False
        self._shows_progress = sys.stderr.isatty()

    def __call__(self, stage: Stage) -> None:
        """It is so far."""
        now_s = self._now_s()
        if stage.lines != self._lines:
            self._lines, self._new_s = stage.lines, now_s
        if now_s - self._began_s < _SILENT_S:
            return
        if self._shows_progress:
            show_progress(
                phrase(
                    "looking {name} through: line {line}  Ctrl+C ends it",
                    name=self._name,
                    line=stage.line,
                )
            )
        elif not self._is_told:
            note(
                phrase(
                    "Looking {name} through takes a while; it is in line {line}.",
                    name=self._name,
                    line=stage.line,
                )
            )
        self._is_told = True
        if now_s - self._new_s >= _ROUND_S and not self._is_warned:
            self._is_warned = True
            self.done()
            note(
                phrase(
                    "{name}, line {line}: for {seconds:g} s it goes round here, and has not ended."
                    " Does this loop end? Ctrl+C ends the look.",
                    name=self._name,
                    line=stage.line,
                    seconds=_ROUND_S,
                )
            )

    def done(self) -> None:
        """Nothing of it stays on the screen."""
        if self._is_told and self._shows_progress:
            wipe_progress()


def tell_others(facts: Facts | None, name: str, error: FraeseError) -> None:
    """Say what else is wrong with a program than what it is refused for."""
    if facts is None:
        return
    for complaint in (*facts.errors, *facts.outside):
        said = str(ProgramError(complaint.message, complaint.line, name))
        if said.rstrip(".") != str(error).rstrip("."):
            note(said)
