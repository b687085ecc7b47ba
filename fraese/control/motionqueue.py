"""What lies ahead of the motors: the driver's queue, and what is remembered of each block in it.

    push --> | block 9 | block 8 | block 7 (in hand, tick 120) | --> played: told to position

Rule 1: every block goes to the driver through ``push``, every report comes through ``poll``: so
        that what is remembered here is what the driver holds.
Rule 2: a block that was played to its end is told once; of one that was dropped half-way, what the
        driver counted. A drop takes all that is in the queue, and is reported before anything that
        was pushed after it is played: so what is finished is always the first in the queue.
Rule 3: a job's blocks are counted, pushed and finished. What is pushed for a way aside is none of
        them, and one that is taken back and given back counts once.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from operator import add, sub
from typing import Final, NamedTuple

from fraese import alarms
from fraese.anythread import any_thread
from fraese.blocks import Q8, Block, remainder
from fraese.control.bounds import Span
from fraese.control.endswitches import EndSwitches
from fraese.control.handling import Handling
from fraese.control.position import Position
from fraese.control.recorder import Recorder
from fraese.errors import PortError, StateError
from fraese.machine import Steps
from fraese.motor.seams import Clock, IdleLevel, Report, StepDriver
from fraese.phrases import phrase
from fraese.planner.lines import mm_per_tick, planned_s

#: Of a place that is known from what was left of what made the steps,
DIED: Final = phrase("what made the steps died in the middle of a job")
#: and from what it had been given.
LOST: Final = phrase("what makes the steps was lost in the middle of a job")
#: An input that still changes after so many readings, or so long, is a matter for a person.
_MOST_LOOKS: Final = 1000
_LONGEST_LOOK_NS: Final = 500_000_000


class _Queued(NamedTuple):
    """What is remembered of a block."""

    block: Block
    of_job: bool
    ticks: int
    duration_s: float
    mm_per_tick: float
    braking_s: float

    @property
    def nominal_s(self) -> float:
        """Its duration at an override of 100 %, as near as that can be told."""
        override_q8 = self.block.override_q8
        return self.duration_s * override_q8 / Q8 if override_q8 else self.duration_s


def span_of(block: Block) -> Span:
    """All of a block."""
    return Span(block, max(1, block.ticks()), 0, planned_s(block))


class MotionQueue:
    """The driver's queue as seen from this side.

    Args:
        driver: what plays the blocks.
        position: told what was played.
        switches: told what was read.
        recorder: asked before anything is handed over; see its rule 1.
        handling: see the attribute.

    Attributes:
        handling: overrides; told what lies in the queue.
        report: the driver's last word.
        blocks: blocks of this job pushed so far, without what was taken back.
        finished: blocks of this job that were played to their end.
        is_fresh: nothing was pushed since that report.
        speed_unit: what the speed along the path is in, "mm" or "°"; a second.
    """

    report: Report

    def __init__(
        self,
        driver: StepDriver,
        position: Position,
        switches: EndSwitches,
        recorder: Recorder,
        handling: Handling | None = None,
    ) -> None:
        self._driver = driver
        self.handling = handling or Handling(driver)
        # What was finished of the move in hand: its tag, and how long that took at 100 %.
        self._move_tag, self._move_s = 0, 0.0
        # Of the question at which the job waited last.
        self._asked_tag = 0
        self.recorder = recorder
        recorder.attach(self)
        # What the driver will have counted when all was played.
        self._end_steps: Steps = ()
        self._position = position
        self._switches = switches
        self.blocks = self.finished = 0
        self.is_fresh = True
        self._queue: deque[_Queued] = deque()
        self._mm_per_tick = 0.0
        self.speed_unit = "mm"
        self._finished_before = self._serial_at_start = 0

    def open(self) -> None:
        """The first word with the driver: what it counted and played so far was before our time."""
        self.report = self._driver.poll(0)
        self._switches.see(self.report)
        self._position.count_from(self.report.position_steps)
        self._end_steps = self.report.position_steps
        self._finished_before = self.report.finished
        self._serial_at_start = self.report.playing

    def begin(self) -> None:
        """A new job: what an old brake left is undone, blocks are counted from here."""
        self.drop()
        self._position.aim_steps = None
        self.blocks = self.finished = self._asked_tag = 0
        self._serial_at_start = self.report.playing

    def drop(self) -> None:
        """Drop what is queued; at standstill.

        Raises:
            StateError: while steps are being made.
        """
        self._driver.flush()
        self.poll()

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current; the last report said that the motors stand.

        Raises:
            PortError: if they move by now: what makes the steps does not do what it is told.
        """
        try:
            self._driver.idle(level)
        except StateError as error:
            raise PortError(
                phrase(
                    "The motors move, though they had come to rest and nothing was asked of"
                    " them: they were stopped; cut their power if they do not."
                ),
                alarms.BRIDGE_STUCK,
            ) from error

    def push(self, block: Block, *, of_job: bool = True) -> float | None:
        """Give a block to the driver; its planned duration, s, or None: there is no room.

        Args:
            block: what to play.
            of_job: it counts as one of the job's blocks.
        """
        span = span_of(block)
        end_steps = tuple(map(add, self._end_steps, block.steps))
        if not self.recorder.allows(end_steps, span):
            return None
        self.handling.expect(block, is_first=not self._queue)
        if not self._driver.push(block):
            return None
        self._end_steps = end_steps
        self.blocks += of_job
        self.is_fresh = False
        self._queue.append(
            _Queued(
                block=block,
                of_job=of_job,
                ticks=span.ticks,
                duration_s=span.duration_s,
                mm_per_tick=mm_per_tick(block.weight),
                braking_s=block.braking_s(),
            )
        )
        return span.duration_s

    def push_aside(self, blocks: Iterable[Block]) -> None:
        """Give a few blocks of no job to a driver that has just become empty."""
        blocks = list(blocks)
        self.recorder.require([span_of(block) for block in blocks])
        for block in blocks:
            self.push(block, of_job=False)

    def take_back(self) -> list[Block]:
        """Take the job's blocks out of the queue; the one in hand without what was played of it."""
        blocks = [queued.block for queued in self._queue]
        if self.report.tick:
            blocks[0] = remainder(blocks[0], self.report.tick)
        self.blocks -= len(blocks)
        self.drop()
        return blocks

    # --- looking -------------------------------------------------------------------------------

    def poll(self, slice_s: float = 0.0) -> Report:
        """Let the driver play for so long, and see what it did."""
        self.recorder.polls()
        self.report = self._driver.poll(slice_s)
        self.is_fresh = True
        self._switches.see(self.report)
        self._position.lose_reference(self.report.torn)
        self._forget_played()
        if self.handling.may_be_over:
            self.handling.follow([queued.block for queued in self._queue])
        return self.report

    def look_around(self, readings: int, clock: Clock) -> None:
        """Poll until the inputs are known: so many equal readings in a row, after any bounce."""
        equal, until_ns = 0, clock.now_ns() + _LONGEST_LOOK_NS
        for _ in range(_MOST_LOOKS):
            if clock.now_ns() > until_ns:
                return
            before = self.report.inputs
            equal = equal + 1 if self.poll().inputs == before else 0
            if equal >= readings:
                return

    def _forget_played(self) -> None:
        counted_steps, finished = self.report.position_steps, self.report.finished
        for _ in range(min(len(self._queue), finished - self._finished_before)):
            queued = self._queue.popleft()
            self.finished += queued.of_job
            self._position.played(queued.block.steps)
            if queued.block.tag != self._move_tag:
                self._move_tag, self._move_s = queued.block.tag, 0.0
            self._move_s += queued.nominal_s
        self._finished_before = finished
        if not self.report.queued:
            # What is left was dropped, the first of it perhaps half-way.
            self._position.at_rest(counted_steps)
            self._queue.clear()
            self._end_steps = counted_steps
        self._mm_per_tick = self._queue[0].mm_per_tick if self._queue else 0.0
        if self._queue:
            self.speed_unit = self._position.machine.unit_of_way(self._queue[0].block.steps)
        self._position.seen(counted_steps)

    def lose(self, error: PortError) -> None:
        """The metal went away: no axis is referenced, and the place is as far known as it says.

        Args:
            error: with the driver's counts, if they are known: ``at_steps``, and that they are not
                below ``low_steps`` and not above ``high_steps``. Else what was seen last, and what
                was given since then, says so, and is added to it.
        """
        where = self._position
        where.lose_reference(range(len(where.machine.axes)))
        known = [error.facts.get(name) for name in ("at_steps", "low_steps", "high_steps")]
        at, low, high = (tuple(steps) if isinstance(steps, tuple) else () for steps in known)
        why = DIED
        if not (at and low and high):
            why, at, (low, high) = LOST, self.report.position_steps, self._reach()
            error.facts.update(at_steps=at, low_steps=low, high_steps=high)
        self._queue.clear()
        self._end_steps = at
        self.report = replace(
            self.report.found_at(at), queued=0, tick=0, due_ns=0, rate_hz=0.0, running=False
        )
        where.at_rest(at)
        where.seen(at)
        where.doubt_between(why, low, high)

    def _reach(self) -> tuple[Steps, Steps]:
        """All that was given may be played to its end: between which counts that is."""
        at, spans = self.spans()
        ends = [self.report.position_steps]
        for span in spans:
            at = tuple(map(add, at, span.block.steps))
            ends.append(at)
        return tuple(map(min, *ends, at)), tuple(map(max, *ends, at))

    # --- facts ---------------------------------------------------------------------------------

    def spans(self) -> tuple[Steps, list[Span]]:
        """Counts where the first block begins, and what is left of the blocks."""
        start, done, spans = list(self._end_steps), self.report.tick, []
        for queued in self._queue:
            start = list(map(sub, start, queued.block.steps))
            spans.append(Span(queued.block, queued.ticks, done, queued.duration_s))
            done = 0
        return tuple(start), spans

    @property
    @any_thread
    def left(self) -> int:
        """Blocks that were given to the driver and are not through yet."""
        return len(self._queue)

    @property
    def has_begun(self) -> bool:
        """A block of this job was taken in hand or dropped: why the motors stand is about it."""
        return self.report.playing > self._serial_at_start

    @property
    @any_thread
    def tag(self) -> int:
        """Of the block in hand, the last one of this job, or a question behind it; 0: of none."""
        return max(self.report.tag if self.has_begun else 0, self._asked_tag)

    def asks(self, tag: int) -> None:
        """All was played up to a question with this tag; 0: it has none."""
        self._asked_tag = tag

    @property
    @any_thread
    def obeys_feed(self) -> bool:
        """The feed override acts on the block in hand; also where there is none."""
        try:
            return bool(self._queue[0].block.override_q8)
        except IndexError:
            return True

    def duration_s(self) -> float:
        """Motion in the queue, as planned, without what was played of the block in hand."""
        total_s = sum(queued.duration_s for queued in self._queue)
        if self._queue and self.report.tick:
            first = self._queue[0]
            total_s -= first.duration_s * self.report.tick / first.ticks
        return total_s

    @any_thread
    def in_move_s(self) -> float:
        """How much of the move in hand was made, s as planned at 100 %."""
        report, queue = self.report, self._queue
        before_s = self._move_s if self.tag == self._move_tag else 0.0
        try:
            first = queue[0]
        except IndexError:
            return before_s
        return before_s + first.nominal_s * report.tick / first.ticks

    def braking_s(self) -> float:
        """How long it takes to stop from the highest rate in the queue."""
        return max([queued.braking_s for queued in self._queue], default=0.0)

    @any_thread
    def mm_s(self) -> float:
        """Speed along the path now, in ``speed_unit``; 0 at standstill."""
        return self.report.rate_hz * self._mm_per_tick
