"""The program in hand, or the last one that was cut short: what must be known to go on with it.

Rule 1: what moves between two programs (a jog, a reference run) changes nothing about it. It is
        forgotten when it ends well, or another one is begun.
Rule 2: one that was refused, or stopped before its first move, has not begun: what was there before
        can still be gone on with.
"""

from collections.abc import Mapping
from typing import Any

from fraese.anythread import any_thread
from fraese.control.jobs import Note
from fraese.control.motionqueue import MotionQueue
from fraese.control.position import Position
from fraese.control.state import CutShort


class Unfinished:
    """Keeps it.

    Args:
        queue: knows which block is in hand.
        position: knows which parameters are in force there.

    Attributes:
        left: of the last one that was cut short; None: there is none.
    """

    def __init__(self, queue: MotionQueue, position: Position) -> None:
        self._queue = queue
        self._position = position
        self._note: Note | None = None
        self.left: Mapping[str, Any] | None = None

    def begin(self, note: Note | None) -> None:
        """A job begins; None: one with which nobody goes on. One that was given up is cut short."""
        self.end(done=False)
        self._note = note

    def end(self, *, done: bool) -> None:
        """It is over."""
        if self._note is not None:
            if done:
                self.left = None
            elif self._queue.tag:
                self.left = self.known()
            self._note = None

    @property
    @any_thread
    def place(self) -> CutShort | None:
        """Which program it is, and where; None: there is none, or one runs."""
        left = self.left
        if left is None or self._note is not None:
            return None
        line = left.get("line")
        return CutShort(str(left.get("name", "")), line if isinstance(line, int) else 0)

    def known(self) -> Mapping[str, Any] | None:
        """What must be known to go on; None: there is nothing."""
        if self._note is None:
            return self.left
        return self._note(self._queue.tag, self._position.offsets.parameters)
