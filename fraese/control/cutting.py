"""What cuts where the motors are: feed and spindle. A program is read ahead of them.

    read     F300 ..... M3 ..... F500 ....
    moves    1  2  3  4  5  6  7  8  9        entries: (1, F300) (4, M3) (7, F500)
    played   --------------^                  in force: F300, M3

Rule 1: one thread notes and ends; every look is of one tuple, which is replaced whole.
"""

from dataclasses import dataclass, replace
from typing import Any, Final

from fraese.anythread import any_thread


@dataclass(frozen=True, slots=True)
class Cutting:
    """Feed and spindle as a program wants them.

    Attributes:
        feed_mm_min: as programmed, without override; 0: none yet.
        direction: of the spindle: clockwise 1, counter-clockwise -1, off 0.
        rev_min: its speed, also of one that is off; 0: nobody has said any.
        by_hand: the operator switches it: what is said is what he was told.
        is_laser: it is the beam of a laser that burns.
        power_percent: of all its power, at the programmed feed; None: it is only on or off.
    """

    feed_mm_min: float = 0.0
    direction: int = 0
    rev_min: float = 0.0
    by_hand: bool = False
    is_laser: bool = False
    power_percent: float | None = None


#: Before the first program.
NO_CUTTING: Final = Cutting()


class CuttingHistory:
    """Which feed and spindle hold from which move on."""

    def __init__(self) -> None:
        self._entries: tuple[tuple[int, Cutting], ...] = ((0, NO_CUTTING),)

    def begin(self) -> None:
        """A program begins: its feed is not known yet, the spindle is as it was."""
        self._entries = ((0, replace(self._entries[-1][1], feed_mm_min=0.0)),)

    def note(self, move: int, played: int, **changes: Any) -> None:
        """From this move on it is otherwise.

        Args:
            move: number of the first move that is made so.
            played: of the move that is played now: what lies before is forgotten.
            changes: fields of ``Cutting``.
        """
        entries = self._from(played)
        self._entries = (*entries, (move, replace(entries[-1][1], **changes)))

    def end(self, played: int | None = None, *, is_off: bool = False) -> None:
        """The program is over.

        Args:
            played: the move at which it was cut short; None: played to its end.
            is_off: whatever turned was switched off.
        """
        last = self._entries[-1][1] if played is None else self.at(played)
        self._entries = ((0, replace(last, direction=0) if is_off else last),)

    @any_thread
    def at(self, played: int) -> Cutting:
        """What holds in this move."""
        return self._from(played)[0][1]

    def _from(self, played: int) -> tuple[tuple[int, Cutting], ...]:
        entries = self._entries
        passed = sum(move <= played for move, _ in entries[1:])
        return entries[passed:]
