"""The recorder: the one place that says moving, reached, at rest, so that a crash finds it said.

    before the first step   "in motion, between these counts"     durable, before anything moves
    while it moves          the same, every 0.04 s, or when what is handed over leaves the bounds
    1 s after it stands     "at rest"; what changes at rest (a zero) likewise

Rule 1: nothing is handed to the driver that reaches outside of the bounds of a durable record.
        Who pushes asks first (``allows``): there is no room until wider bounds are durable.
Rule 2: where time passes by itself a thread writes, the latest record only; nobody waits for the
        disk while motors run. On a virtual clock nothing happens meanwhile: it is written at once,
        and durable at the mark and every 0.25 s. There a power cut takes the mill with it.
Rule 3: what is bounded is what can be played until the record's lease is over (``Lease``), braking
        included. Who makes the steps is granted it, and brakes then by himself; so does the run
        loop (``is_late``). What comes later in the queue may be handed over freely.
Rule 4: motors that stopped without ramp have lost their reference: they do not move again before
        a record says so.
Rule 5: what cannot be written is told once: before motion it is refused, in motion it is an alarm.
"""

import math
import time
from collections.abc import Callable, Sequence
from typing import Final, Protocol

from fraese.control.bounds import Box, Span, box_of, holds
from fraese.control.inforce import Asked, InForce
from fraese.control.lease import FOR_EVER_NS, Lease
from fraese.control.recordwriter import Writer
from fraese.control.savedstate import Motion, SavedState
from fraese.errors import ConfigError, FraeseError
from fraese.machine import Machine, Steps
from fraese.motor.seams import Report
from fraese.phrases import phrase

_NS_PER_S: Final = 1_000_000_000
_EVERY_NS: Final = _NS_PER_S // 4
#: While the motors run, where a thread writes: every other round of the run loop.
_RUNNING_NS: Final = _NS_PER_S // 25
_REST_NS: Final = _NS_PER_S
#: What is found to be needed is a bit less than what was asked for, whatever is rounded.
_GRACE_S: Final = 0.005
#: On a virtual clock the place is that of the record itself, and a run is to be fast.
_AT_ONCE_MARGIN_S: Final = 2.0
#: A disk that takes longer than this for the mark before motion is not waited for.
_MARK_NS: Final = 5 * _NS_PER_S


class Ahead(Protocol):
    """What the driver was given; the motion queue."""

    report: Report

    def spans(self) -> tuple[Steps, Sequence[Span]]:
        """Counts where the first block begins, and the blocks."""

    def duration_s(self) -> float:
        """How long they play, as planned."""


class Recorder:
    """Nothing is kept: what stands behind a machine without a state folder.

    Attributes:
        failure: why the last record could not be written, if it could not.
        lapses: how often the motors braked because a record was late.
    """

    failure: FraeseError | None = None
    lapses = 0

    def attach(self, queue: Ahead) -> None:
        """What the driver was given is known there."""

    def begin(self, facts: Callable[[], SavedState]) -> None:
        """From now on there is something to be kept; at standstill."""

    def before_motion(self, first: Sequence[Span] = ()) -> None:
        """Motors are to move: say so, durably.

        Args:
            first: what they will be given first, as far as it is known.

        Raises:
            ConfigError: if that cannot be said; nothing may move.
        """

    def allows(self, end: Steps, next_one: Span) -> bool:
        """Whether this block may follow those that the driver has.

        Args:
            end: what the driver will have counted when it was played, per motor.
            next_one: the block.
        """
        return True

    def require(self, more: Sequence[Span]) -> None:
        """Wait until these blocks may follow; at standstill.

        Raises:
            ConfigError: if that cannot be said.
        """

    def polls(self) -> None:
        """The driver is polled: what it reports is no older than now."""

    def follow(self) -> None:
        """The driver was polled in a run."""

    def rests(self) -> None:
        """A run is over."""

    def idle(self) -> None:
        """The driver was polled, and no job runs."""

    @property
    def is_late(self) -> bool:
        """The bounds hold no longer than it takes to brake."""
        return False

    @property
    def is_awaited(self) -> bool:
        """A record is on its way to the disk."""
        return False

    def wait(self, seconds: float) -> None:
        """Until it is there, or so long."""

    def close(self) -> None:
        """The last word. Safe to call twice.

        Raises:
            ConfigError: if it cannot be written.
        """


class JournalRecorder(Recorder):
    """Keeps the place of a machine.

    Args:
        write: puts a state down, durably or not.
        machine: its axes.
        settle_s: so long motors may go on after a lease is over, before they brake; None: they do
            not move by themselves, and the run loop's thread writes.
        now_ns: time as the disk, and who makes the steps, have it.
        grant: who makes the steps may play until then.
        lead_s: motion that is to be in the driver's queue.
    """

    def __init__(
        self,
        write: Callable[[SavedState, bool], None],
        machine: Machine,
        settle_s: float | None,
        now_ns: Callable[[], int] = time.monotonic_ns,
        grant: Callable[[int], None] | None = None,
        lead_s: float = 0.0,
    ) -> None:
        self._write = write
        self._axes = machine.axes
        self._rates_hz = [axis.max_rate_hz for axis in machine.axes]
        # Braking goes as far as the rate in so long; the limits of blocks are rounded.
        braking_s = (axis.max_rate_hz / axis.acceleration_hz_s for axis in machine.axes)
        self._braking_s = 1.02 * max(braking_s) / 2
        # On a virtual clock any time may pass between two looks.
        self._settle_s = math.inf if settle_s is None else settle_s
        self._margin_s = _AT_ONCE_MARGIN_S if settle_s is None else math.inf
        self._is_threaded = settle_s is not None
        self._now_ns = now_ns
        self._lease = Lease(lead_s)
        self._writer = Writer(write, grant, lambda: self._now_ns())
        self._records = InForce()
        self._synced_ns = self._seen_ns = 0
        self._marked = False
        self._torn: frozenset[int] = frozenset()
        self._torn_ns = 0
        self._still_ns: int | None = None
        self._kept: SavedState | None = None
        self._closed = False

    def attach(self, queue: Ahead) -> None:
        """What the driver was given is known there."""
        self._queue = queue

    def begin(self, facts: Callable[[], SavedState]) -> None:
        """From now on there is something to be kept; at standstill."""
        self._facts = facts

    # --- the three words -----------------------------------------------------------------------

    def before_motion(self, first: Sequence[Span] = ()) -> None:
        """Motors are to move: say so, durably."""
        self.failure = None
        self._still_ns = None
        self.require(first)

    def require(self, more: Sequence[Span]) -> None:
        """Wait until these blocks may follow; at standstill."""
        until_ns = self._now_ns() + _MARK_NS
        while not self._may_follow(more, to_start=True):
            self.wait(_MARK_NS / _NS_PER_S)
            self._look()
            if self.failure is not None:
                failure, self.failure = self.failure, None
                raise failure
            if self._now_ns() > until_ns:
                raise ConfigError(phrase("The state cannot be written: the disk takes no record."))

    def allows(self, end: Steps, next_one: Span) -> bool:
        """Whether this block may follow those that the driver has."""
        self._look()
        if self._records.box is not None and self._is_told():
            if not self._is_threaded:
                is_fine = self._records.box.holds(end)
            else:
                # It is not begun before the lease is over.
                is_fine = 0.99 * self._queue.duration_s() > self._left_s() + self._braking_s
            if is_fine:
                return True
        is_first = not (self._queue.report.running or self._queue.report.queued)
        return self._may_follow([next_one], to_start=is_first)

    def _may_follow(self, more: Sequence[Span], *, to_start: bool = False) -> bool:
        """See ``allows``.

        Args:
            more: the blocks.
            to_start: the motors are to start, so the lease must not be over at once.
        """
        self._look()
        records, needed = self._records, self._needed(more, self._left_s())
        is_young = not to_start or self._is_young(records.durable.over_ns)
        if is_young and self._is_told() and holds(records.box, needed):
            return True
        is_asked = holds(records.asked.box, needed) and records.asked.at_ns >= self._torn_ns
        if is_asked and self.is_awaited and (not to_start or self._is_young(records.over_ns)):
            return False
        runs = self._is_threaded and self._queue.report.running
        if runs and self._is_recent(_RUNNING_NS):
            return False
        self._still_ns = None  # it is to move, however long it stood
        self._say_moving(more)
        return not self._is_threaded and holds(records.box, needed) and self._is_told()

    def _is_young(self, over_ns: int) -> bool:
        """A third of a lease is left, if there are any."""
        left_ns = over_ns - self._now_ns()
        return not self._is_threaded or left_ns >= self._lease.seconds / 3 * _NS_PER_S

    def _is_recent(self, within_ns: int) -> bool:  # since the last record was asked for
        return self._now_ns() - self._records.asked.at_ns < within_ns

    def _left_s(self) -> float:
        """What was seen last may have been played on for so long before the motors brake."""
        if not self._is_threaded or self._records.over_ns == FOR_EVER_NS:
            return math.inf
        return max(0, self._records.over_ns - self._seen_ns) / _NS_PER_S + self._settle_s

    def _is_told(self) -> bool:
        """See rule 4."""
        self._see_torn()
        return not self._torn or self._records.durable.at_ns >= self._torn_ns

    def _see_torn(self) -> None:
        torn = self._queue.report.torn
        if torn != self._torn:
            self._torn, self._torn_ns = torn, self._now_ns()

    def _needed(self, more: Sequence[Span], horizon_s: float, margin_s: float = 0.0) -> Box:
        """Bounds of what the driver has, and of what is to follow."""
        start, spans = self._queue.spans()
        here = self._queue.report.position_steps
        return box_of(here, start, (*spans, *more), horizon_s, self._rates_hz, margin_s)

    def polls(self) -> None:
        """The driver is polled: what it reports is no older than now."""
        self._seen_ns = self._now_ns()

    def follow(self) -> None:
        """The driver was polled in a run."""
        self._look()
        self._see_torn()
        now_ns = self._now_ns()
        if self._queue.report.running:
            self._still_ns = None
        elif self._still_ns is None:
            self._still_ns = now_ns
        elif self._records.asked.box is not None and now_ns - self._still_ns >= _REST_NS:
            # Held, or asked something: for hours, perhaps.
            self._say_resting()
        runs = self._is_threaded and self._queue.report.running
        is_recent = self._is_recent(_RUNNING_NS if runs else _EVERY_NS)
        if self._records.asked.box is not None and not is_recent:
            self._say_moving([])

    def rests(self) -> None:
        """A run is over."""
        self._see_torn()
        if self._records.asked.box is not None:
            self._still_ns = self._now_ns()
            self._say_moving([])

    def idle(self) -> None:
        """The driver was polled, and no job runs."""
        self._look()
        self._see_torn()
        now_ns = self._now_ns()
        if self._queue.report.running or self._is_recent(_EVERY_NS):
            return
        if self._records.asked.box is not None:
            self._still_ns = self._still_ns or now_ns
            if now_ns - self._still_ns >= _REST_NS:
                self._say_resting()
        elif self._facts() != self._kept:
            self._say_resting()

    # --- records -------------------------------------------------------------------------------

    def _say_moving(self, more: Sequence[Span]) -> None:
        facts, now_ns = self._facts(), self._now_ns()
        horizon_s = self._settle_s
        # What was seen last is as old as that.
        horizon_s += self._lease.seconds + (now_ns - self._seen_ns) / _NS_PER_S + _GRACE_S
        box = self._needed(more, horizon_s, self._margin_s)
        has_more = more or self._queue.spans()[1]
        over_ns = self._lease.over_ns(now_ns) if has_more else FOR_EVER_NS
        motion = Motion.of(self._axes, facts.position_steps, self._queue.report, box)
        self._ask(facts.model_copy(update={"motion": motion}), box, over_ns)

    def _say_resting(self) -> None:
        self._kept = self._facts()
        self._ask(self._kept, None, 0)

    def _ask(self, state: SavedState, box: Box | None, over_ns: int) -> None:
        asked = Asked(box, self._now_ns(), over_ns, self._queue.report.running)
        self._records.ask(asked)
        # Only the last word of all is that of a program that has closed the machine.
        state = state.model_copy(update={"in_hand": True})
        if self._is_threaded:
            self._writer.ask(state, asked)
            return
        marked = self._marked
        self._marked = box is not None
        durable = box is None or not marked or asked.at_ns - self._synced_ns >= _EVERY_NS
        try:
            self._write(state, durable)
        except FraeseError as error:
            self.failure = error
            return
        if durable:
            self._synced_ns = asked.at_ns
        self._records.take(asked)

    def _look(self) -> None:
        """What the thread has done since."""
        if not self._is_threaded:
            return
        done = self._writer.done()
        if done is not None:
            self._records.take(done.asked)
            self.lapses = self._lease.saw(done)
        self.failure = self._writer.failure() or self.failure

    # --- waiting -------------------------------------------------------------------------------

    @property
    def is_late(self) -> bool:
        """The bounds hold no longer than it takes to brake."""
        if not self._is_threaded or self._records.box is None or not self._queue.report.queued:
            return False
        return self._now_ns() > self._records.durable.over_ns

    @property
    def is_awaited(self) -> bool:
        """A record is on its way to the disk."""
        return self._is_threaded and self._writer.is_busy

    def wait(self, seconds: float) -> None:
        """Until it is there, or so long."""
        if self._is_threaded:
            self._writer.wait(seconds)

    def close(self) -> None:
        """The last word. Safe to call twice."""
        if self._closed:
            return
        self._closed = True
        self._writer.close()
        if self._queue.report.running:
            # Nobody saw it stand: the last bounds hold.
            return
        self._write(self._facts(), True)
