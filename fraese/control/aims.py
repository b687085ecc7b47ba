"""Where the move in hand of a program ends. A program is planned ahead of the motors.

    planned   move 1 -> X10   move 2 -> X10 Y5   move 3 -> ...     noted by tag, as blocks have it
    played    ------------------^                                  to go: from here to X10 Y5

Rule 1: one thread notes; a look is of one entry. What has been played is forgotten in time.
Rule 2: points that were merged to one line (G64 P) have its end, under the tag of its blocks.
"""

from collections.abc import Callable
from typing import Final

from fraese.anythread import any_thread
from fraese.control.motionqueue import MotionQueue
from fraese.control.position import Position
from fraese.machine import Millimetres

#: So many ends are noted before those that lie behind are forgotten.
_MANY: Final = 4096


class Aims:
    """Ends of the moves that were planned.

    Args:
        queue: knows which move is in hand.
        position: where the machine is; and where a move by hand leads.
    """

    def __init__(self, queue: MotionQueue, position: Position) -> None:
        self._queue = queue
        self._position = position
        self._ends: dict[int, Millimetres] = {}
        self._most = _MANY

    def begin(self) -> Callable[[int, Millimetres], object]:
        """A program begins; what it returns is told the end of each move, by its tag."""
        self._ends, self._most = {}, _MANY
        return self._note

    def _note(self, tag: int, end_mm: Millimetres) -> None:
        ends = self._ends
        ends[tag] = end_mm
        if len(ends) >= self._most:
            played = self._queue.tag
            self._ends = {each: end for each, end in ends.items() if each >= played}
            self._most = max(_MANY, 2 * len(self._ends))

    @property
    @any_thread
    def to_go_mm(self) -> tuple[float, ...]:
        """What is left of the move in hand, per axis: of a program's, or of one by hand."""
        end_mm = self._ends.get(self._queue.tag)
        if end_mm is None:
            return self._position.to_go_mm
        machine, here = self._position.machine, self._position.position_steps
        ends = (axis.to_steps(mm) for axis, mm in zip(machine.axes, end_mm, strict=True))
        return machine.to_mm(tuple(end - at for end, at in zip(ends, here, strict=True)))
