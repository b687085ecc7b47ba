"""How far the job in hand is: line, time, share; the override is in it, what was waited is not."""

from dataclasses import replace
from typing import Final

from fraese.anythread import any_thread
from fraese.control.jobs import Plan, line_of, move_of
from fraese.control.motionqueue import MotionQueue
from fraese.control.state import JobProgress
from fraese.motor.seams import Clock

_NS_PER_S: Final = 1_000_000_000


class Following:
    """Follows one job after the other.

    Args:
        queue: what is being played.
        clock: the driver's clock.
    """

    def __init__(self, queue: MotionQueue, clock: Clock) -> None:
        self._queue = queue
        self._clock = clock
        self._job: JobProgress | None = None
        self._from_ns = self._waited_ns = 0
        self._plan: Plan | None = None

    def begin(self, job: JobProgress, plan: Plan | None) -> None:
        """A job begins.

        Args:
            job: its name and what is known of it.
            plan: when it comes to which move; None: nobody knows.
        """
        self._job, self._plan = job, plan
        self._from_ns, self._waited_ns = self._clock.now_ns(), 0

    def waited(self, since_ns: int) -> None:
        """Since then it waited for a person."""
        self._waited_ns += self._clock.now_ns() - since_ns

    def forget(self) -> None:
        """It has not begun."""
        self._job = None

    def end(self, *, done: bool) -> None:
        """It is over: this is how far it came."""
        self._job = job = self.now()
        if done and job is not None and job.share is not None:
            self._job = replace(job, share=1.0, left_s=0.0)

    @property
    @any_thread
    def last(self) -> JobProgress | None:
        """The job as it was told last."""
        return self._job

    @any_thread
    def now(self) -> JobProgress | None:
        """The job in hand as it stands."""
        job, queue = self._job, self._queue
        if job is None:
            return None
        tag = queue.tag
        share = left_s = None
        if self._plan is not None:
            share, left_s = self._plan.progress(
                move_of(tag),
                queue.in_move_s() if tag else 0.0,
                feed=queue.handling.feed,
                rapid=queue.handling.rapid,
            )
        return replace(
            job,
            line=line_of(tag),
            move=move_of(tag),
            blocks=queue.blocks,
            elapsed_s=(self._clock.now_ns() - self._from_ns - self._waited_ns) / _NS_PER_S,
            share=share,
            left_s=left_s,
        )
