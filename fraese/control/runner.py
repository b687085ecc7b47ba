"""The inner half of the run loop: one job, one driver.

    job --blocks--> pending --push--> driver's queue --poll--> report --> job

Rule 1: the queue is kept filled to ``lead_s`` of motion, not to its capacity, so that what the
        operator changes is felt soon; to more only where stopping from what comes takes longer.
Rule 2: ``cancel``, ``stop``, ``hold``, ``resume`` and ``answer`` set flags, from any thread; the
        first two and ``hold`` reach the driver at once.
Rule 3: while a job waits for an answer, another one may be done: its guest. A cancel ends the guest
        only; whatever else goes wrong with it ends both.
Rule 4: a job ends in exactly one way: done, cancelled, stopped by a switch, or failed. However it
        ends, the queue is empty and the motors stand.
"""

from typing import NamedTuple

from fraese.anythread import any_thread
from fraese.blocks import Block
from fraese.control.bounds import Span
from fraese.control.jobs import TURN, Ask, Doing, Job, Standstill, Turn
from fraese.control.motionqueue import MotionQueue, span_of
from fraese.control.retract import Aside, Detour
from fraese.control.state import Status
from fraese.errors import FraeseError
from fraese.motor.seams import Ended, Report, StepDriver


class _Host(NamedTuple):
    """A job that waits for an answer while a guest is done."""

    job: Job
    wait: Ask
    aside: Aside | None
    tag: int


class Runner:
    """Feeds one job to the driver.

    Args:
        driver: what plays the blocks.
        queue: its queue.
        lead_s: motion to keep in the queue at least.
        slice_s: how long one poll may take.

    Attributes:
        failure: what the job failed with, if it did.
        question: what the operator is asked now; empty if nothing.
        doing: what the job says that it does; empty: it says nothing.
        computes: the job does not wait for motors: it has more to compute.
    """

    def __init__(
        self, driver: StepDriver, queue: MotionQueue, lead_s: float, slice_s: float
    ) -> None:
        self._driver = driver
        self._queue = queue
        self._lead_s = lead_s
        self._slice_s = slice_s
        self.failure: FraeseError | None = None
        self.question = self.doing = ""
        self.computes = False
        self._job: Job | None = None
        self._host: _Host | None = None
        self._begun = False
        self._aside: Aside | None = None
        self._pending: Block | None = None
        self._wait: Standstill | Ask | Turn | None = None
        self._cancel = False
        self._stop = False
        self._held = False
        self._resume = False
        self._answered = False
        self._brakes_for_record = False
        self._cuts = False

    # --- from any thread -----------------------------------------------------------------------

    @any_thread
    def cancel(self) -> None:
        """Brake, then drop the rest."""
        self._cancel = True
        self._driver.brake()

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest: no ramp."""
        self._stop = True
        self._driver.stop()

    @any_thread
    def hold(self) -> None:
        """Brake and wait."""
        self._resume = False
        self._held = True
        self._driver.brake()

    @any_thread
    def resume(self) -> None:
        """Go on after a hold."""
        self._resume = True

    @any_thread
    def answer(self) -> None:
        """The operator has done what was asked; nothing without a question."""
        if self.question:
            self._answered = True

    @property
    @any_thread
    def cancelling(self) -> bool:
        """A cancel or stop of this job was asked for."""
        return self._cancel or self._stop

    @property
    @any_thread
    def holding(self) -> bool:
        """A hold of this job was asked for and not lifted."""
        return self._held and not self._resume

    # --- from the run loop's thread ------------------------------------------------------------

    def start(self, job: Job, detour: Detour | None = None) -> None:
        """Take up a job; it begins at the next ``activate``.

        Args:
            job: what to do.
            detour: where to go while it is held; None: stay.
        """
        # Before the first word to the driver: an order that comes from now on is about this job.
        self._cancel = self._stop = self._held = self._resume = self._answered = False
        self._queue.begin()
        self._aside = Aside(self._driver, self._queue, detour) if detour is not None else None
        self._job = job
        self._begun = self._cuts = False
        self.doing = ""
        self.failure = None

    @property
    @any_thread
    def waits_for(self) -> str:
        """What the job waits for while it asks, in a word; empty: nothing, or the operator."""
        wait = self._wait
        return wait.waits_for if self.question and isinstance(wait, Ask) else ""

    @property
    @any_thread
    def is_open(self) -> bool:
        """The job waits for an answer, and nothing else is done."""
        admits = isinstance(self._wait, Ask) and self._wait.admits
        return bool(self.question) and admits and not self._answered and not self.cancelling

    def admit(self, guest: Job) -> None:
        """Do another job while this one waits for its answer."""
        assert self._job is not None
        assert isinstance(self._wait, Ask)
        self._host = _Host(self._job, self._wait, self._aside, self._queue.tag)
        self._job, self._begun, self._cuts = guest, False, False
        self._aside = self._wait = None
        self.question = ""

    def _see_off(self) -> Status:
        """The guest is over: the question is asked again."""
        host, self._host = self._host, None
        assert host is not None
        if self._job is not None:
            self._job.close()
        self._job, self._wait, self._aside = host.job, host.wait, host.aside
        self._begun, self._pending = True, None
        self._cancel = self._held = self._resume = False
        self._queue.poll()
        # What the guest pushed and somebody stopped will never be finished.
        self._queue.blocks = self._queue.finished
        return Status.RUN

    def first(self) -> list[Span]:
        """What the job begins with, as far as it is known before anything has moved."""
        if not self._begun and self._job is not None:
            try:
                self._advance(self._job)
            except FraeseError as error:
                self.fail(error)
        return [] if self._pending is None else [span_of(self._pending)]

    def activate(self) -> Status:
        """One round: feed the queue, play a slice, see how it stands (ActivateMotoren)."""
        if self._held and self._aside is not None:
            ends = self._cancel or self._stop
            if not ends and self._aside.step(go_on=self._resume):
                self._go_on()
        elif self._resume:
            self._go_on()
        self._mind_the_record()
        try:
            self._feed()
        except FraeseError as error:
            self.fail(error)
        self._remind()
        return self._judge(self._queue.poll(self._slice_s))

    def fail(self, error: FraeseError) -> None:
        """Brake, and let the job end with this error."""
        if self.failure is None:
            self.failure = error
            self._job = None
            self.cancel()

    def _mind_the_record(self) -> None:
        """Brake while the record of where the machine is grows too old, see the recorder."""
        late = self._queue.recorder.is_late
        if late and not self._brakes_for_record:
            self._driver.brake()
        elif self._brakes_for_record and not late and not (self._held or self.cancelling):
            # It may have stood for so long that the record says "at rest".
            self._queue.recorder.require([])
            self._driver.resume()
        self._brakes_for_record = late

    def _remind(self) -> None:
        """A flush on the way aside may have wiped the driver's flag just after it was set."""
        if self._stop:
            self._driver.stop()
        elif self._cancel:
            self._driver.brake()

    def abandon(self) -> None:
        """Something unforeseen happened: the job is dropped, the motors stop at the next poll."""
        self._job = self._pending = self._wait = self._host = None
        self.question = ""
        self._driver.stop()

    def give_up(self) -> None:
        """Nothing has moved yet, and nothing is to: the job is dropped."""
        if self._job is not None:
            self._job.close()
        self._job = self._pending = self._wait = None

    @property
    def waits(self) -> bool:
        """Nothing moves until a person does something."""
        return self.held or bool(self.question)

    @property
    def waits_for_person(self) -> bool:
        """It was held by somebody, stands aside for him, or asks him something."""
        away = self._aside is not None and self._aside.is_away
        return bool(self.question) or (self._held and self.held) or away

    @property
    @any_thread
    def held(self) -> bool:
        """The motors stand, on the path or aside, and the job waits."""
        return self._queue.report.held or (self._aside is not None and self._aside.is_away)

    def _go_on(self) -> None:
        """Resume, unless somebody has cancelled since; also if he does it at this moment."""
        self._queue.recorder.require([])
        self._resume = self._held = False
        if not self._cancel:
            self._driver.resume()
        if self._cancel or self._held:
            self._driver.brake()

    def _feed(self) -> None:
        self.computes = False
        if not self._held and self._aside is not None and not self._aside.give_back():
            return
        ahead_s, fastest_s = self._queue.duration_s(), self._queue.braking_s()
        while self._job is not None and not (self._held or self._cancel or self._stop):
            if self._pending is not None:
                fastest_s = max(fastest_s, self._pending.braking_s())
                if ahead_s >= max(self._lead_s, fastest_s + 2 * self._slice_s):
                    return
                added_s = self._queue.push(self._pending)
                if added_s is None:
                    return
                ahead_s += added_s
            elif self._wait is not None and not self._is_over(self._wait):
                return
            self._pending = self._wait = None
            self._advance(self._job)
            if self._wait is TURN:
                self._wait, self.computes = None, True
                return

    def _advance(self, job: Job) -> None:
        try:
            demand = job.send(self._queue.report) if self._begun else next(job)
            self._begun = True
            while isinstance(demand, Doing):
                self.doing = demand.what
                demand = job.send(self._queue.report)
        except StopIteration:
            self._job = None
            return
        if isinstance(demand, Block):
            # A guest's blocks belong to the place where its host waits.
            self._pending = demand._replace(tag=self._host.tag) if self._host else demand
        else:
            self._wait = demand

    def _is_over(self, wait: Standstill | Ask | Turn) -> bool:
        if isinstance(wait, Standstill) and wait.cut is not None and (self._cuts or wait.cut()):
            return self._is_cut()
        if not self._queue.is_fresh or self._queue.report.queued:
            return False
        if isinstance(wait, Ask):
            if not self.question:
                self._answered = False
                self._queue.asks(wait.tag)
                self.question = wait.question
            if not self._answered:
                return False
        self.question = ""
        return True

    def _is_cut(self) -> bool:
        """Brake, and at rest drop what is left; True: that is done."""
        begins, self._cuts = not self._cuts, True
        # Again and again: going on after a hold would have undone it.
        self._driver.brake()
        if begins or self._queue.report.running:
            return False
        self._cuts = False
        self._queue.drop()
        return True

    def _judge(self, report: Report) -> Status:
        if self._queue.has_begun and self._is_alarm(report.ended):
            return self._end(Status.ERROR)
        if self._stop and not report.running:
            return self._end(Status.CANCEL)
        if self._cancel and not report.running:
            self._queue.drop()
            if self._host is not None and self.failure is None:
                return self._see_off()
            return self._end(Status.ERROR if self.failure else Status.CANCEL)
        owed = self._pending is not None or (self._aside is not None and self._aside.is_owed)
        if self._job is None and not owed and not report.queued and not self._cancel:
            return self._end(Status.OK) if self._host is None else self._see_off()
        return Status.RUN

    def _is_alarm(self, ended: Ended) -> bool:
        # What follows a stop that nobody asked for would be made from the wrong place.
        stray = ended is Ended.STOP and not self._stop
        return stray or ended in (Ended.SWITCH, Ended.SILENCE)

    def _end(self, status: Status) -> Status:
        if self._job is not None:
            self._job.close()
        if self._host is not None:
            self._host.job.close()
        self._job = self._pending = self._wait = self._host = None
        self.question = ""
        self._queue.poll()
        return status
