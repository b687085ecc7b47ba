"""The inner half of the run loop: one job, one driver.

    job --blocks--> pending --push--> driver's queue --poll--> report --> job

Rule 1: the queue is kept filled to ``lead_s`` of motion, not to its capacity, so that what the
        operator changes is felt soon.
Rule 2: ``cancel``, ``stop``, ``hold``, ``resume`` and ``answer`` set flags, from any thread; the
        first two and ``hold`` reach the driver at once.
Rule 3: a job ends in exactly one way: done, cancelled, stopped by a switch, or failed. However it
        ends, the queue is empty and the motors stand.
"""

from collections import deque
from collections.abc import Sequence
from enum import Enum, auto
from typing import Final, NamedTuple, Protocol

from fraese.blocks import Block, remainder
from fraese.errors import FraeseError
from fraese.jobs import Ask, Job, Standstill
from fraese.machine import Steps
from fraese.motor.seams import Ended, Report, StepDriver
from fraese.planner.backlash import Carriages
from fraese.planner.lines import mm_per_tick, planned_s
from fraese.state import Status

#: An input that still changes after so many readings is a matter for a person.
_MOST_LOOKS: Final = 1000


class Detour(Protocol):
    """A way aside while a job is held, and back again to the very step."""

    def away(self) -> Sequence[Block]:
        """From where the hold came to rest; nothing: stay there."""

    def back(self) -> Sequence[Block]:
        """From there, with the backlash as it was."""


class _Aside(Enum):
    """Where a held job is."""

    ON_PATH = auto()
    AWAY = auto()
    COMING_BACK = auto()


class _Ahead(NamedTuple):
    """What is remembered of a block in the queue."""

    serial: int
    block: Block
    ticks: int
    duration_s: float
    mm_per_tick: float


class Runner:
    """Feeds one job to the driver.

    Args:
        driver: what plays the blocks.
        carriages: told every block that was played, in order; nobody else tells them.
        lead_s: motion to keep in the queue.
        slice_s: how long one poll may take.

    Attributes:
        report: the driver's last word.
        seen_steps: axis positions at that moment; may be read from any thread.
        blocks: blocks of this job pushed so far.
        failure: what the job failed with, if it did.
        question: what the operator is asked now; empty if nothing.
    """

    def __init__(
        self, driver: StepDriver, carriages: Carriages, lead_s: float, slice_s: float
    ) -> None:
        self._driver = driver
        self._carriages = carriages
        self._lead_s = lead_s
        self._slice_s = slice_s
        self.report: Report = driver.poll(0)
        self.blocks = 0
        self.failure: FraeseError | None = None
        self.question = ""
        self._job: Job | None = None
        self._begun = False
        self._detour: Detour | None = None
        self._aside = _Aside.ON_PATH
        self._kept: deque[Block] = deque()
        self._pending: Block | None = None
        self._wait: Standstill | Ask | None = None
        self._report_is_fresh = True
        self._ahead: deque[_Ahead] = deque()
        self._serial = self._serial_at_start = self.report.playing
        # Motor steps that the carriages have been told of.
        self._told_steps = self.report.position_steps
        self.seen_steps = self.position_steps()
        self._cancel = False
        self._stop = False
        self._held = False
        self._resume = False
        self._answered = False

    # --- from any thread -----------------------------------------------------------------------

    def cancel(self) -> None:
        """Brake, then drop the rest."""
        self._cancel = True
        self._driver.brake()

    def stop(self) -> None:
        """Finish the tick in hand, drop the rest: no ramp."""
        self._stop = True
        self._driver.stop()

    def hold(self) -> None:
        """Brake and wait."""
        self._resume = False
        self._held = True
        self._driver.brake()

    def resume(self) -> None:
        """Go on after a hold."""
        self._resume = True

    def answer(self) -> None:
        """The operator has done what was asked; nothing without a question."""
        if self.question:
            self._answered = True

    @property
    def cancelling(self) -> bool:
        """A cancel or stop of this job was asked for."""
        return self._cancel or self._stop

    @property
    def holding(self) -> bool:
        """A hold of this job was asked for and not lifted."""
        return self._held and not self._resume

    # --- from the run loop's thread ------------------------------------------------------------

    def start(self, job: Job, detour: Detour | None = None) -> None:
        """Take up a job; it begins at the next ``activate``. What an old brake left is undone.

        Args:
            job: what to do.
            detour: where to go while it is held; None: stay.
        """
        self._detour = detour
        self._aside = _Aside.ON_PATH
        self._kept.clear()
        self._driver.flush()
        self._job = job
        self._begun = False
        self.blocks = 0
        self.failure = None
        self._cancel = self._stop = self._held = self._resume = self._answered = False
        self._serial = self._serial_at_start = self.report.playing

    def look(self) -> Report:
        """Poll at standstill."""
        self.report = self._driver.poll(0)
        self._forget_played()
        return self.report

    def look_around(self, readings: int) -> None:
        """Poll until the inputs are known: so many equal readings in a row, after any bounce."""
        equal = 0
        for _ in range(_MOST_LOOKS):
            before = self.report.inputs
            equal = equal + 1 if self.look().inputs == before else 0
            if equal >= readings:
                return

    def activate(self) -> Status:
        """One round: feed the queue, play a slice, see how it stands (ActivateMotoren)."""
        if self._held and self._detour is not None:
            self._step_aside(self._detour)
        elif self._resume:
            self._go_on()
        try:
            self._feed()
        except FraeseError as error:
            self.failure = error
            self._job = None
            self.cancel()
        self.report = self._driver.poll(self._slice_s)
        self._report_is_fresh = True
        self._forget_played()
        return self._judge(self.report)

    def abandon(self) -> None:
        """Something unforeseen happened: the job is dropped, the motors stop at the next poll."""
        self._job = self._pending = self._wait = None
        self.question = ""
        self._driver.stop()

    @property
    def finished(self) -> int:
        """Blocks of this job that were played to their end, the one in hand left out."""
        return max(0, self.report.playing - self._serial_at_start - 1)

    @property
    def waits(self) -> bool:
        """Nothing moves until a person does something."""
        return self.held or bool(self.question)

    @property
    def held(self) -> bool:
        """The motors stand, on the path or aside, and the job waits."""
        return self.report.held or (self._aside is _Aside.AWAY and not self.report.queued)

    def _go_on(self) -> None:
        """Resume, unless somebody has cancelled since; also if he does it at this moment."""
        self._resume = self._held = False
        if not self._cancel:
            self._driver.resume()
        if self._cancel or self._held:
            self._driver.brake()

    def position_steps(self) -> Steps:
        """Axis positions at the last report."""
        return self._carriages.seen(self._untold())

    def _untold(self) -> Steps:
        now = self.report.position_steps
        return tuple(a - b for a, b in zip(now, self._told_steps, strict=True))

    def _tell(self, motor_steps: Steps) -> None:
        self._carriages.advance(motor_steps)
        self._told_steps = tuple(a + b for a, b in zip(self._told_steps, motor_steps, strict=True))

    def _forget_played(self) -> None:
        while self._ahead and self._ahead[0].serial < self.report.playing:
            self._tell(self._ahead.popleft().block.steps)
        if not self.report.queued:
            # The last one was played, or dropped half-way; what a driver drops it does not count.
            self._tell(self._untold())
            self._ahead.clear()
            self._serial = self.report.playing
        self.seen_steps = self.position_steps()

    def mm_per_tick(self) -> float:
        """Path length of one tick of the block in hand, mm; 0 at standstill."""
        if not self.report.rate_hz or not self._ahead:
            return 0.0
        return self._ahead[0].mm_per_tick

    def ahead_s(self) -> float:
        """Motion in the queue, as planned, without what is played of the block in hand."""
        total_s = sum(block.duration_s for block in self._ahead)
        if self._ahead and self._ahead[0].serial == self.report.playing:
            first = self._ahead[0]
            total_s -= first.duration_s * self.report.tick / first.ticks
        return total_s

    def _feed(self) -> None:
        if not self._held and not self._give_back():
            return
        ahead_s = self.ahead_s()
        while self._job is not None and not (self._held or self._cancel or self._stop):
            if self._pending is not None:
                if ahead_s >= self._lead_s or not self._driver.push(self._pending):
                    return
                ahead_s += self._remember(self._pending)
            elif self._wait is not None and not self._is_over(self._wait):
                return
            self._pending = self._wait = None
            self._advance()

    def _step_aside(self, detour: Detour) -> None:
        """Away from the path once the hold stands, and back when it is to go on."""
        report = self.report
        if self._cancel or self._stop:
            return
        if self._aside is _Aside.ON_PATH:
            if report.held:
                self._go_away(detour)
        elif not self._resume:
            return
        elif report.queued:
            if report.held:
                # Held once more, on the way.
                self._driver.resume()
        elif self._aside is _Aside.AWAY:
            self._push_all(detour.back())
            self._aside = _Aside.COMING_BACK
        else:
            self._rejoin()

    def _go_away(self, detour: Detour) -> None:
        self._kept.extendleft(reversed(self._unplayed()))
        self._driver.flush()
        self.look()
        self._push_all(detour.away())
        self._aside = _Aside.AWAY

    def _rejoin(self) -> None:
        """Back on the path, what was taken out of the queue is given back."""
        # Behind a closed throttle: what was planned at speed starts from the start/stop rate.
        self._driver.brake()
        self.look()
        self.blocks = self.report.playing - self._serial_at_start
        self._give_back()
        self._aside = _Aside.ON_PATH
        self._go_on()

    def _give_back(self) -> bool:
        """True when all of it is in the queue."""
        while self._kept:
            if not self._driver.push(self._kept[0]):
                return False
            self._remember(self._kept.popleft())
        return True

    def _unplayed(self) -> list[Block]:
        """What is queued, the block in hand without what was played of it."""
        blocks = [ahead.block for ahead in self._ahead]
        if blocks and self._ahead[0].serial == self.report.playing and self.report.tick:
            blocks[0] = remainder(blocks[0], self.report.tick)
        return blocks

    def _push_all(self, blocks: Sequence[Block]) -> None:
        for block in blocks:
            self._driver.push(block)
            self._remember(block)

    def _remember(self, block: Block) -> float:
        self._serial += 1
        self.blocks += 1
        self._report_is_fresh = False
        duration_s = planned_s(block)
        self._ahead.append(
            _Ahead(
                self._serial,
                block,
                max(1, block.ticks()),
                duration_s,
                mm_per_tick(block.weight),
            )
        )
        return duration_s

    def _advance(self) -> None:
        if self._job is None:
            return
        try:
            demand = self._job.send(self.report) if self._begun else next(self._job)
            self._begun = True
        except StopIteration:
            self._job = None
            return
        if isinstance(demand, Block):
            self._pending = demand
        else:
            self._wait = demand

    def _is_over(self, wait: Standstill | Ask) -> bool:
        if not self._report_is_fresh or self.report.queued:
            return False
        if isinstance(wait, Ask):
            if not self.question:
                self._answered = False
                self.question = wait.question
            if not self._answered:
                return False
        self.question = ""
        return True

    def _judge(self, report: Report) -> Status:
        played = report.playing > self._serial_at_start
        if played and report.ended is Ended.SWITCH:
            return self._end(Status.ERROR)
        if self._stop and not report.running:
            return self._end(Status.CANCEL)
        if self._cancel and not report.running:
            self._driver.flush()
            return self._end(Status.ERROR if self.failure else Status.CANCEL)
        done = self._job is None and self._pending is None and not self._kept
        if done and not report.queued and not self._cancel:
            return self._end(Status.OK)
        return Status.RUN

    def _end(self, status: Status) -> Status:
        if self._job is not None:
            self._job.close()
        self._job = self._pending = self._wait = None
        self.question = ""
        self.look()
        return status
