"""What lies ahead of the motors: the driver's queue, and what is remembered of each block in it.

    push --> | serial 9 | serial 8 | serial 7 (in hand, tick 120) | --> played: told to position

Rule 1: every block goes to the driver through ``push``, every report comes through ``poll``: so
        that what is remembered here is what the driver holds.
Rule 2: a block that was played is told once; of one that was dropped half-way, what the driver
        counted.
"""

from collections import deque
from collections.abc import Iterable
from typing import Final, NamedTuple

from fraese.blocks import Block, remainder
from fraese.control.position import Position
from fraese.motor.seams import Report, StepDriver
from fraese.planner.lines import mm_per_tick, planned_s

#: An input that still changes after so many readings is a matter for a person.
_MOST_LOOKS: Final = 1000


class _Queued(NamedTuple):
    """What is remembered of a block."""

    serial: int
    block: Block
    ticks: int
    duration_s: float
    mm_per_tick: float


class MotionQueue:
    """The driver's queue as seen from this side.

    Args:
        driver: what plays the blocks.
        position: told what was played.

    Attributes:
        report: the driver's last word.
        blocks: blocks of this job pushed so far.
        is_fresh: nothing was pushed since that report.
    """

    def __init__(self, driver: StepDriver, position: Position) -> None:
        self._driver = driver
        self._position = position
        self.report: Report = driver.poll(0)
        position.count_from(self.report.position_steps)
        self.blocks = 0
        self.is_fresh = True
        self._queue: deque[_Queued] = deque()
        self._mm_per_tick = 0.0
        self._serial = self._serial_at_start = self.report.playing

    def begin(self) -> None:
        """A new job: what an old brake left is undone, blocks are counted from here."""
        self._driver.flush()
        self.blocks = 0
        self._serial = self._serial_at_start = self.report.playing

    def push(self, block: Block) -> float | None:
        """Give a block to the driver; its planned duration, s, or None: there is no room."""
        if not self._driver.push(block):
            return None
        self._serial += 1
        self.blocks += 1
        self.is_fresh = False
        duration_s = planned_s(block)
        self._queue.append(
            _Queued(
                self._serial, block, max(1, block.ticks()), duration_s, mm_per_tick(block.weight)
            )
        )
        return duration_s

    def push_all(self, blocks: Iterable[Block]) -> None:
        """Give a few blocks to a driver that has just become empty."""
        for block in blocks:
            self.push(block)

    def take_back(self) -> list[Block]:
        """Take everything out of the queue; the block in hand without what was played of it."""
        blocks = [queued.block for queued in self._queue]
        if blocks and self._queue[0].serial == self.report.playing and self.report.tick:
            blocks[0] = remainder(blocks[0], self.report.tick)
        self._driver.flush()
        self.poll()
        return blocks

    # --- looking -------------------------------------------------------------------------------

    def poll(self, slice_s: float = 0.0) -> Report:
        """Let the driver play for so long, and see what it did."""
        self.report = self._driver.poll(slice_s)
        self.is_fresh = True
        self._position.lose_reference(self.report.torn)
        self._forget_played()
        return self.report

    def look_around(self, readings: int) -> None:
        """Poll until the inputs are known: so many equal readings in a row, after any bounce."""
        equal = 0
        for _ in range(_MOST_LOOKS):
            before = self.report.inputs
            equal = equal + 1 if self.poll().inputs == before else 0
            if equal >= readings:
                return

    def _forget_played(self) -> None:
        counted_steps = self.report.position_steps
        while self._queue and self._queue[0].serial < self.report.playing:
            self._position.played(self._queue.popleft().block.steps)
        if not self.report.queued:
            # The last one was played, or dropped half-way; what a driver drops it does not count.
            self._position.at_rest(counted_steps)
            self._queue.clear()
            self._serial = self.report.playing
        self._mm_per_tick = self._queue[0].mm_per_tick if self._queue else 0.0
        self._position.seen(counted_steps)

    # --- facts ---------------------------------------------------------------------------------

    @property
    def has_begun(self) -> bool:
        """A block of this job is being played or was."""
        return self.report.playing > self._serial_at_start

    @property
    def finished(self) -> int:
        """Blocks of this job that were played to their end, the one in hand left out."""
        return max(0, self.report.playing - self._serial_at_start - 1)

    def recount(self) -> None:
        """Blocks that were taken back and will be pushed again count once."""
        self.blocks = self.report.playing - self._serial_at_start

    def duration_s(self) -> float:
        """Motion in the queue, as planned, without what was played of the block in hand."""
        total_s = sum(queued.duration_s for queued in self._queue)
        if self._queue and self._queue[0].serial == self.report.playing:
            first = self._queue[0]
            total_s -= first.duration_s * self.report.tick / first.ticks
        return total_s

    def mm_s(self) -> float:
        """Speed along the path now; 0 at standstill. From any thread."""
        return self.report.rate_hz * self._mm_per_tick
