"""The run loop: the status, and what happens round a job from its start to motors at rest.

    full display
    while status is RUN:   poll the driver, feed its queue  ->  status
                           break-key callback
                           show-position callback
    full display, motors idle

Rule 1: everything runs in one thread, the one that calls ``run``; callbacks are called from it.
Rule 2: one job at a time. An error stays until it is acknowledged; nothing starts before.
Rule 3: however a job ends, outputs that must not outlast it are off, and what is said last names
        the place where the machine stands.
Rule 4: the motors keep their current for ``standstill.delay_s``, in case that another job follows.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Final

from fraese.anythread import any_thread
from fraese.config import Config
from fraese.control.about import PLAIN, About
from fraese.control.endings import alarm, not_kept
from fraese.control.endswitches import EndSwitches
from fraese.control.following import Following
from fraese.control.jobs import Job
from fraese.control.motionqueue import MotionQueue
from fraese.control.onlooker import Onlooker, lost_in_words
from fraese.control.patience import Patience, no_progress
from fraese.control.position import Position
from fraese.control.runner import Runner
from fraese.control.state import JobProgress, Status
from fraese.control.unfinished import Unfinished
from fraese.errors import (
    Alarm,
    FraeseError,
    PortError,
    StateError,
)
from fraese.log import write as log_line
from fraese.motor.seams import Clock, IdleLevel, StepDriver
from fraese.phrases import joined, phrase

_TORN: Final = phrase("Stopped without ramp: reference the axes before relying on it.")
_NS_PER_S: Final = 1_000_000_000


def _nothing() -> None:
    """No callback registered."""


def _unheard(message: str) -> None:
    """Nobody to tell."""


class RunLoop:
    """Works off jobs, one after the other.

    Args:
        config: standstill, outputs, lead.
        driver: what plays the blocks.
        clock: the driver's clock.
        queue: the driver's queue.
        position: where it ended; references are lost by a stop without ramp.
        switches: which end stopped it.
        slice_s: how long one poll of the driver may take, s.
        onlooker: asked for lost steps when a job ends.

    Attributes:
        runner: the inner half.
        status: OK, RUN, CANCEL or ERROR.
        message: the last thing that a person should know; empty if there is none.
        error: what the last job failed with, if it did.
        unfinished: the program that was cut short.
    """

    def __init__(
        self,
        config: Config,
        driver: StepDriver,
        clock: Clock,
        queue: MotionQueue,
        position: Position,
        switches: EndSwitches,
        slice_s: float,
        onlooker: Onlooker,
    ) -> None:
        self._config = config
        self._driver = driver
        self._clock = clock
        self._queue = queue
        self._position = position
        self._switches = switches
        self._onlooker = onlooker
        self._recorder = queue.recorder
        self._slice_ns = round(slice_s * _NS_PER_S)
        self._display: Callable[[], None] = _nothing
        self._show_pos: Callable[[], None] = _nothing
        self._break_key: Callable[[], None] = _nothing
        self._tell: Callable[[str], None] = _unheard
        self.status = Status.OK
        self.message = ""
        self.error: FraeseError | None = None
        self._following = Following(queue, clock)
        self.unfinished = Unfinished(queue, position)
        self._late_before = self._dry_before = self._lapses_before = 0
        self._travelled_before = queue.report.travelled_steps
        self._idle_at_ns: int | None = None
        self.runner = Runner(driver, queue, config.run.lead_s, slice_s)
        self._patience = Patience(clock, slice_s)

    # --- callbacks -----------------------------------------------------------------------------

    def set_display(self, procedure: Callable[[], None]) -> None:
        """Register the full display; called in the run loop's thread."""
        self._display = procedure

    def set_show_pos(self, procedure: Callable[[], None]) -> None:
        """Register the position display; likewise, after every slice."""
        self._show_pos = procedure

    def set_break_key(self, procedure: Callable[[], None]) -> None:
        """Register who may cancel or stop; called in the run loop's thread after every slice."""
        self._break_key = procedure

    def set_tell(self, procedure: Callable[[str], None]) -> None:
        """Register who is told every message; likewise."""
        self._tell = procedure

    # --- jobs ----------------------------------------------------------------------------------

    def run(self) -> Status:
        """Work off what was commanded; returns the status in which it ended."""
        if self.status is not Status.RUN:
            return self.status
        job = self._following.last
        log_line("controller", "run", "entry", job.name if job else "")
        self._mark()
        self._display()
        try:
            while self.status is Status.RUN:
                self.status = self._activate()
                self._follow()
                self._break_key()
                self._show_pos()
            self._conclude()
            self._display()
            self._halt_motors()
        except PortError as error:
            self._lose_port(error)
            self._display()
        except BaseException as error:
            self._give_up(error)
            raise
        self._recorder.rests()
        log_line("controller", "run", "exit", f"{self.status.value} {self._position.in_words()}")
        return self.status

    def idle(self, elapsed_s: float = 0.0) -> None:
        """Between jobs: look at the inputs, and switch the current off when its time has come.

        Args:
            elapsed_s: since the last call; a clock that moves by itself passes it by.
        """
        self._clock.pass_by(round(elapsed_s * _NS_PER_S))
        self._queue.poll()
        self._recorder.idle()
        if self._idle_at_ns is not None and self._clock.now_ns() >= self._idle_at_ns:
            self._idle_at_ns = None
            self._queue.idle(IdleLevel(self._config.standstill.current))
            self._queue.poll()

    def start(self, name: str, job: Job, about: About = PLAIN) -> None:
        """Take up a job; ``run`` works it off.

        Args:
            name: for people.
            job: what to do.
            about: what else is known of it.

        Raises:
            StateError: if another one runs, or an error has not been acknowledged.
        """
        if about.guest and self.is_open:
            self.runner.admit(job)
            return
        self.require_not_running()
        self.require_ready()
        self.message, self.error = "", None
        self._idle_at_ns = None
        self.unfinished.begin(about.note)
        progress = JobProgress(
            name, lines=about.lines, expected_s=about.expected_s, height_map=about.height_map
        )
        self._following.begin(progress, about.plan)
        self._late_before = self._queue.report.late_ticks
        self._dry_before = self._queue.report.dry_queues
        self._lapses_before = self._recorder.lapses
        self._travelled_before = self._queue.report.travelled_steps
        self._onlooker.begin()
        self.runner.start(job, about.detour)
        self._patience.begin()
        self.status = Status.RUN

    def acknowledge(self) -> None:
        """Take note of an error or cancel; back to OK."""
        if self.status in (Status.ERROR, Status.CANCEL):
            self.status = Status.OK

    def require_ready(self) -> None:
        """See that a command may be given; then the inputs are known.

        Raises:
            StateError: if a job runs that is not open to others, or an error has not been
                acknowledged.
        """
        if not self.is_open:
            self.require_not_running()
        if self.status is Status.ERROR:
            raise StateError(phrase("Acknowledge the error first: {message}", message=self.message))
        # Somebody may have moved a carriage, or pressed a switch, since the last look.
        self._queue.look_around(self._config.switches.readings, self._clock)

    @property
    @any_thread
    def is_open(self) -> bool:
        """A job waits for an answer, and somebody may move by hand meanwhile."""
        return self.status is Status.RUN and self.runner.is_open

    def require_not_running(self) -> None:
        """See that nothing runs.

        Raises:
            StateError: if a job does.
        """
        if self.status is Status.RUN:
            raise StateError(
                phrase("The machine runs: cancel or wait for the end of the job first.")
            )

    def say(self, message: str) -> None:
        """Show a message."""
        self.message = message
        self._tell(message)

    @any_thread
    def progress(self) -> JobProgress | None:
        """The job in hand, or the last one as it ended."""
        running = self.status is Status.RUN
        return self._following.now() if running else self._following.last

    @property
    @any_thread
    def alarm(self) -> Alarm | None:
        """What ended the job and waits to be acknowledged."""
        waits = self.status is Status.ERROR
        return self.error if waits and isinstance(self.error, Alarm) else None

    def _mark(self) -> None:
        """Before anything moves, say so."""
        try:
            self._recorder.before_motion(self.runner.first())
        except FraeseError:
            self.runner.give_up()
            self.status = Status.OK
            self._following.forget()
            self.unfinished.end(done=False)
            raise

    def _follow(self) -> None:
        """Let what was reached be put down; a place that is not kept ends the job."""
        self._recorder.follow()
        failure, self._recorder.failure = self._recorder.failure, None
        if failure is not None and self.status is Status.RUN:
            self.runner.fail(not_kept(failure))

    def _activate(self) -> Status:
        if self._recorder.is_awaited and not self._queue.report.running:
            # Nothing moves until the disk has taken it.
            self._recorder.wait(self._slice_ns / _NS_PER_S)
        before_ns, stood = self._clock.now_ns(), self.runner.waits
        status = self.runner.activate()
        if status is Status.RUN and self.runner.waits:
            # Nothing passes the time for us: the driver has nothing to play.
            self._clock.wait_until(self._clock.now_ns() + self._slice_ns)
        if stood:
            self._following.waited(before_ns)
        if status is Status.RUN and self._patience.is_over(
            self._queue.report, excused=self.runner.waits_for_person or self.runner.computes
        ):
            self._refuse_to_wait()
        return status

    def _refuse_to_wait(self) -> None:
        """Motors that should move do not, or nobody hears that they do.

        Raises:
            PortError: always; they were switched off, as far as they can be reached.
        """
        self.runner.abandon()
        with suppress(FraeseError):
            self._queue.poll()
            self._driver.idle(IdleLevel.OFF)
        raise no_progress(self._position.in_words())

    def _give_up(self, error: BaseException) -> None:
        """Something was raised that no job raises: the job is over, the motors stop."""
        self.runner.abandon()
        with suppress(Exception):
            # Where they stand is kept only if they were seen to stand.
            self._queue.poll(self._slice_ns / _NS_PER_S)
        self.status = Status.ERROR
        self.message = phrase("Stopped by an error: {error}.", error=repr(error))

    def _lose_port(self, error: PortError) -> None:
        """The metal went away under the job: nobody knows what the motors did last."""
        self.runner.abandon()
        self._queue.lose(error)
        self._idle_at_ns = None
        self.status = Status.ERROR
        self.error = error
        self.message = str(error)
        self._keep_progress()

    def _conclude(self) -> None:
        """Say how the job ended."""
        if self.status is Status.CANCEL:
            self.message = phrase("Cancelled at {in_words}.", in_words=self._position.in_words())
            if self._queue.report.torn:
                self.message = joined(" ", (self.message, _TORN))
        elif self.status is Status.ERROR:
            self.error = self.runner.failure or alarm(
                self._queue.report, self._position, self._switches
            )
            self.message = str(self.error)
        self._own_up()
        # Cutting ends with the job; what was cancelled or failed also leaves no spindle running.
        done = self.status is Status.OK
        if mask := self._config.outputs.off_after(done=done):
            self._driver.set_outputs(mask, 0)
        self._keep_progress()

    def _keep_progress(self) -> None:
        self.unfinished.end(done=self.status is Status.OK)
        self._following.end(done=self.status is Status.OK)

    def _own_up(self) -> None:
        """What the motors felt and nobody asked for: dry queues, late and lost steps."""
        report = self._queue.report
        late, dry = report.late_ticks - self._late_before, report.dry_queues - self._dry_before
        said: list[str] = []
        if dry:
            said.append(
                phrase("The queue ran dry {dry} times: the motors braked and waited.", dry=dry)
            )
        if lapses := self._recorder.lapses - self._lapses_before:
            said.append(
                phrase(
                    "The motors braked {lapses} times: the disk was late with their place.",
                    lapses=lapses,
                )
            )
        if late:
            said.append(
                phrase(
                    "{late} ticks came late by more than a quarter of their interval.", late=late
                )
            )
        lost = self.lost_in_words()
        # A job that failed for this reason has said so.
        if lost and lost not in self.message:
            said.append(lost)
        if said:
            self.say(joined(" ", [text for text in (self.message, *said) if text]))

    def lost_in_words(self) -> str:
        """Steps of this job that a simulated mill lost so far; empty if none. At standstill."""
        self._onlooker.rest()
        travelled = zip(self._queue.report.travelled_steps, self._travelled_before, strict=True)
        made_steps = [now - before for now, before in travelled]
        return lost_in_words(self._position.machine.names, self._onlooker.look(), made_steps)

    def _halt_motors(self) -> None:
        """HaltMotoren: current off or down, now or later."""
        delay_s = self._config.standstill.delay_s
        self._idle_at_ns = self._clock.now_ns() + round(delay_s * _NS_PER_S)
        if not delay_s:
            self.idle()
