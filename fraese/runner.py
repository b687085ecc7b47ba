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
from typing import NamedTuple

from fraese.blocks import CYCLES_PER_S, Block
from fraese.errors import FraeseError
from fraese.jobs import Ask, Job, Standstill
from fraese.motor.seams import Ended, Report, StepDriver
from fraese.planner.lines import mm_per_tick
from fraese.state import Status


class _Ahead(NamedTuple):
    """What is remembered of a block in the queue."""

    serial: int
    ticks: int
    duration_s: float
    mm_per_tick: float


class Runner:
    """Feeds one job to the driver.

    Args:
        driver: what plays the blocks.
        lead_s: motion to keep in the queue.
        slice_s: how long one poll may take.

    Attributes:
        report: the driver's last word.
        blocks: blocks of this job pushed so far.
        failure: what the job failed with, if it did.
        question: what the operator is asked now; empty if nothing.
    """

    def __init__(self, driver: StepDriver, lead_s: float, slice_s: float) -> None:
        self._driver = driver
        self._lead_s = lead_s
        self._slice_s = slice_s
        self.report: Report = driver.poll(0)
        self.blocks = 0
        self.failure: FraeseError | None = None
        self.question = ""
        self._job: Job | None = None
        self._begun = False
        self._pending: Block | None = None
        self._wait: Standstill | Ask | None = None
        self._report_is_fresh = True
        self._ahead: deque[_Ahead] = deque()
        self._serial = self._serial_at_start = self.report.playing
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
        self._held = True
        self._driver.brake()

    def resume(self) -> None:
        """Go on after a hold."""
        self._resume = True

    def answer(self) -> None:
        """The operator has done what was asked."""
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

    def start(self, job: Job) -> None:
        """Take up a job; it begins at the next ``activate``. What an old brake left is undone."""
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
        return self.report

    def activate(self) -> Status:
        """One round: feed the queue, play a slice, see how it stands (ActivateMotoren)."""
        if self._resume:
            self._resume = self._held = False
            self._driver.resume()
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

    def _forget_played(self) -> None:
        if not self.report.queued:
            # Played, or dropped by a watch: then the driver has not counted them.
            self._ahead.clear()
            self._serial = self.report.playing
        while self._ahead and self._ahead[0].serial < self.report.playing:
            self._ahead.popleft()

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
        ahead_s = self.ahead_s()
        while self._job is not None and not self._held:
            if self._pending is not None:
                if ahead_s >= self._lead_s or not self._driver.push(self._pending):
                    return
                ahead_s += self._remember(self._pending)
            elif self._wait is not None and not self._is_over(self._wait):
                return
            self._pending = self._wait = None
            self._advance()

    def _remember(self, block: Block) -> float:
        self._serial += 1
        self.blocks += 1
        self._report_is_fresh = False
        cycles = sum(p.ticks * (p.interval_q8 + p.last_interval_q8()) // 512 for p in block.pieces)
        self._ahead.append(
            _Ahead(
                self._serial,
                max(1, block.ticks()),
                cycles / CYCLES_PER_S,
                mm_per_tick(block.weight),
            )
        )
        return cycles / CYCLES_PER_S

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
        if isinstance(wait, Ask) and not self._answered:
            self.question = wait.question
            return False
        self.question = ""
        self._answered = False
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
        if self._job is None and self._pending is None and not report.queued and not self._cancel:
            return self._end(Status.OK)
        return Status.RUN

    def _end(self, status: Status) -> Status:
        if self._job is not None:
            self._job.close()
        self._job = self._pending = self._wait = None
        self._ahead.clear()
        self.question = ""
        self.look()
        return status
