"""What was really done: the way of every motor over all blocks, and the rate at its end.

Rule 1: positions are not counted but follow from the block in hand and its ticks done, so that a
        tick costs little and a count cannot drift.
Rule 2: ``last_cycles`` is the rate: what the tick last played took. It outlives its block, and is
        0 at standstill.
Rule 3: motors whose last tick was faster than their start/stop rate are torn: they may have
        turned on. A rate of dwell ticks moves nobody.
"""

from typing import Final, NamedTuple

from fraese.blocks import CYCLES_PER_S, Block
from fraese.motor.cursor import Cursor

#: The motor argument of a reading that belongs to no tick.
BETWEEN_TICKS: Final = -2


class Way(NamedTuple):
    """The way up to a moment: taken in no time, calculated when there is time.

    Attributes:
        base_steps: signed counts of the blocks before.
        base_travelled_steps: the same, both directions added.
        cursor: the block in hand.
        done: its ticks.
        moved: motors that have made their step of the tick in hand, a bit each.
    """

    base_steps: tuple[int, ...]
    base_travelled_steps: tuple[int, ...]
    cursor: Cursor | None
    done: int
    moved: int

    def position_steps(self) -> tuple[int, ...]:
        """Signed count of every motor."""
        if self.cursor is None:
            return self.base_steps
        moved = self.cursor.steps_after(self.done, self.moved)
        return tuple(a + b for a, b in zip(self.base_steps, moved, strict=True))

    def travelled_steps(self) -> tuple[int, ...]:
        """The count of every motor, both directions added."""
        if self.cursor is None:
            return self.base_travelled_steps
        moved = self.cursor.steps_after(self.done, self.moved)
        return tuple(a + abs(b) for a, b in zip(self.base_travelled_steps, moved, strict=True))


class Track:
    """The block in hand, and the sum of all that came before it.

    Attributes:
        cursor: the block in hand.
        last_cycles: what the last tick took; 0 at standstill.
        tag: of the block in hand, or of the last one.
        torn: motors that stopped without ramp above their start/stop rate in this run.
        finished: blocks that were played to their last tick.
    """

    def __init__(self, motors: int) -> None:
        self.cursor: Cursor | None = None
        self.last_cycles = 0
        self.tag = 0
        self.torn: frozenset[int] = frozenset()
        self.finished = 0
        self._moved_last: Cursor | None = None
        self._base_steps = (0,) * motors
        self._travelled_steps = (0,) * motors

    def begin(self, block: Block) -> Cursor:
        """Take a block in hand."""
        self.cursor = cursor = Cursor(block)
        self.tag = block.tag
        return cursor

    def end(self, nothing_follows: bool) -> None:
        """The block in hand is done, or given up; the motors may have to stop dead here."""
        cursor = self.cursor
        if cursor is None:
            return
        self._base_steps, self._travelled_steps = self.position_steps(), self.travelled_steps()
        self.cursor = None
        self.finished += cursor.done == cursor.ticks
        # Stopped before its first tick: it is the block before that still moved.
        if cursor.done:
            self._moved_last = cursor
        last = self._moved_last
        if nothing_follows and last and self.is_above_jump(last):
            self.torn |= {motor for motor, n in enumerate(last.block.steps) if n}

    def start(self) -> None:
        """A run begins from standstill."""
        self.torn = frozenset()

    def rest(self) -> None:
        """The motors stand."""
        self.last_cycles = 0
        self._moved_last = None

    def is_above_jump(self, cursor: Cursor) -> bool:
        """The rate last played is one that the motors cannot stop from without a ramp."""
        if not self.last_cycles or not cursor.leader_bit:
            return False
        return cursor.is_above_jump(self.last_cycles)

    def position_steps(self, motor: int = BETWEEN_TICKS) -> tuple[int, ...]:
        """Signed count of every motor, after ``motor`` has made its step of the present tick."""
        cursor = self.cursor
        if motor == BETWEEN_TICKS or cursor is None:
            return self.way().position_steps()
        moved = cursor.steps_within_beat(motor)
        return tuple(a + b for a, b in zip(self._base_steps, moved, strict=True))

    def travelled_steps(self) -> tuple[int, ...]:
        """The count of every motor, both directions added."""
        return self.way().travelled_steps()

    def way(self) -> Way:
        """The way so far, for somebody who has no time to calculate it just now."""
        cursor = self.cursor
        done, moved = (cursor.done, cursor.moved) if cursor is not None else (0, 0)
        return Way(self._base_steps, self._travelled_steps, cursor, done, moved)

    def rate_hz(self) -> float:
        """Ticks per second of the leader; 0 at standstill and in a dwell."""
        moving = self.cursor is not None and self.cursor.leader_bit
        return CYCLES_PER_S / self.last_cycles if moving and self.last_cycles else 0.0
