"""The recorder: the one place that says moving, reached, at rest, so that a crash finds it said.

    before the first step   "in motion, between these counts"     durable, before anything moves
    while it moves          the same, every 0.25 s, or when what is handed over leaves the bounds
    1 s after it stands     "at rest"; what changes at rest (a zero) likewise

Rule 1: nothing is handed to the driver that reaches outside of the bounds of a durable record.
        Who pushes asks first (``allows``): there is no room until wider bounds are durable.
Rule 2: where time passes by itself a thread writes, the latest record only; nobody waits for the
        disk while motors run. On a virtual clock nothing happens meanwhile: it is written at once,
        and durable at the mark and every 0.25 s. There a power cut takes the mill with it.
Rule 3: bounds that only hold for a time (``Box.is_whole``) are kept young: finds the run loop its
        record older than ``_OLD_S``, it brakes until there is a younger one (``is_late``).
Rule 4: motors that stopped without ramp have lost their reference: they do not move again before
        a record says so.
Rule 5: what cannot be written is told once: before motion it is refused, in motion it is an alarm.
"""

import math
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Final, Protocol

from fraese.control.bounds import Box, Span, box_of
from fraese.control.recordwriter import Writer
from fraese.control.savedstate import Motion, SavedState
from fraese.errors import ConfigError, FraeseError
from fraese.machine import Machine, Steps
from fraese.motor.seams import Report

_NS_PER_S: Final = 1_000_000_000
_EVERY_NS: Final = _NS_PER_S // 4
_REST_NS: Final = _NS_PER_S
_OLD_S: Final = 0.75
_MARGIN_S: Final = 0.25
#: On a virtual clock the place is that of the record itself, and a run is to be fast.
_AT_ONCE_MARGIN_S: Final = 2.0
#: A disk that takes longer than this for the mark before motion is not waited for.
_MARK_NS: Final = 5 * _NS_PER_S


class Ahead(Protocol):
    """What the driver was given; the motion queue."""

    report: Report

    def spans(self) -> tuple[Steps, Iterable[Span]]:
        """Counts where the first block begins, and the blocks."""


class Recorder:
    """Nothing is kept: what stands behind a machine without a state folder.

    Attributes:
        failure: why the last record could not be written, if it could not.
    """

    failure: FraeseError | None = None

    def attach(self, queue: Ahead) -> None:
        """What the driver was given is known there."""

    def begin(self, facts: Callable[[], SavedState]) -> None:
        """From now on there is something to be kept; at standstill."""

    def before_motion(self) -> None:
        """Motors are to move: say so, durably.

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
        settle_s: so long motors may go on after the run loop was heard last; None: they do not
            move by themselves, and the run loop's thread writes.
        now_ns: time as the disk has it.
    """

    def __init__(
        self,
        write: Callable[[SavedState, bool], None],
        machine: Machine,
        settle_s: float | None,
        now_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._write = write
        self._axes = machine.axes
        self._rates_hz = [axis.max_rate_hz for axis in machine.axes]
        # On a virtual clock any time may pass between two looks.
        self._horizon_s = math.inf if settle_s is None else _OLD_S + settle_s
        self._margin_s = _AT_ONCE_MARGIN_S if settle_s is None else _MARGIN_S
        self._is_threaded = settle_s is not None
        self._now_ns = now_ns
        self._writer = Writer(write)
        # Of the last record that was asked for, and of the last durable one.
        self._asked: Box | None = None
        self._box: Box | None = None
        self._asked_ns = self._box_ns = self._synced_ns = 0
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

    def before_motion(self) -> None:
        """Motors are to move: say so, durably."""
        self.failure = None
        self._still_ns = None
        self.require([])

    def require(self, more: Sequence[Span]) -> None:
        """Wait until these blocks may follow; at standstill."""
        until_ns = self._now_ns() + _MARK_NS
        while not self._may_follow(more):
            self.wait(_MARK_NS / _NS_PER_S)
            self._look()
            if self.failure is not None:
                failure, self.failure = self.failure, None
                raise failure
            if self._now_ns() > until_ns:
                raise ConfigError("The state cannot be written: the disk takes no record.")

    def allows(self, end: Steps, next_one: Span) -> bool:
        """Whether this block may follow those that the driver has."""
        box = self._box
        if self._queue.report.torn and not self._is_told():
            return self._may_follow([next_one])
        if box is not None and next_one.duration_s <= self._horizon_s and box.holds(end):
            return True
        return self._may_follow([next_one])

    def _may_follow(self, more: Sequence[Span]) -> bool:
        self._look()
        needed = self._needed(more)
        if self._is_told() and _holds(self._box, needed):
            return True
        is_asked = _holds(self._asked, needed) and self._asked_ns >= self._torn_ns
        if not self.is_awaited or not is_asked:
            self._say_moving(more)
            self._look()
        return _holds(self._box, needed) and self._is_told()

    def _is_told(self) -> bool:
        """See rule 4."""
        self._see_torn()
        return not self._torn or self._box_ns >= self._torn_ns

    def _see_torn(self) -> None:
        torn = self._queue.report.torn
        if torn != self._torn:
            self._torn, self._torn_ns = torn, self._now_ns()

    def _needed(self, more: Sequence[Span], margin_s: float = 0.0) -> Box:
        """Bounds of what the driver has, and of what is to follow."""
        start, spans = self._queue.spans()
        here = self._queue.report.position_steps
        return box_of(here, start, (*spans, *more), self._horizon_s, self._rates_hz, margin_s)

    def follow(self) -> None:
        """The driver was polled in a run."""
        self._look()
        self._see_torn()
        now_ns = self._now_ns()
        if self._queue.report.running:
            self._still_ns = None
        elif self._still_ns is None:
            self._still_ns = now_ns
        elif self._asked is not None and now_ns - self._still_ns >= _REST_NS:
            # Held, or asked something: for hours, perhaps.
            self._say_resting()
        if self._asked is not None and now_ns - self._asked_ns >= _EVERY_NS:
            self._say_moving([])

    def rests(self) -> None:
        """A run is over."""
        self._see_torn()
        if self._asked is not None:
            self._still_ns = self._now_ns()
            self._say_moving([])

    def idle(self) -> None:
        """The driver was polled, and no job runs."""
        self._look()
        self._see_torn()
        now_ns = self._now_ns()
        if self._queue.report.running or now_ns - self._asked_ns < _EVERY_NS:
            return
        if self._asked is not None:
            if self._still_ns is None:
                self._still_ns = now_ns
            if now_ns - self._still_ns >= _REST_NS:
                self._say_resting()
        elif self._facts() != self._kept:
            self._say_resting()

    # --- records -------------------------------------------------------------------------------

    def _say_moving(self, more: Sequence[Span]) -> None:
        facts, box = self._facts(), self._needed(more, self._margin_s)
        self._ask(facts.model_copy(update={"motion": self._motion(facts, box)}), box)

    def _motion(self, facts: SavedState, box: Box) -> Motion:
        """Carriages follow their motors or lag behind, so they stay within what those do."""
        low, high = [], []
        counted = self._queue.report.position_steps
        for axis, at, motor, least, most in zip(
            self._axes, facts.position_steps, counted, box.low, box.high, strict=True
        ):
            ways = sorted((axis.motor_sign * (least - motor), axis.motor_sign * (most - motor)))
            low.append(at + ways[0])
            high.append(at + ways[1])
        return Motion(low_steps=tuple(low), high_steps=tuple(high), counted_steps=counted)

    def _say_resting(self) -> None:
        self._kept = self._facts()
        self._ask(self._kept, None)

    def _ask(self, state: SavedState, box: Box | None) -> None:
        now_ns = self._now_ns()
        # Until it is durable a cut may leave the old one or the new one: both must hold.
        self._box = _common(self._box, box)
        self._asked, self._asked_ns = box, now_ns
        # Only the last word of all is that of a program that has closed the machine.
        state = state.model_copy(update={"in_hand": True})
        if self._is_threaded:
            self._writer.ask(state, box, now_ns)
            return
        marked = self._marked
        self._marked = box is not None
        durable = box is None or not marked or now_ns - self._synced_ns >= _EVERY_NS
        try:
            self._write(state, durable)
        except FraeseError as error:
            self.failure = error
            return
        if durable:
            self._synced_ns = now_ns
        self._box, self._box_ns = box, now_ns

    def _look(self) -> None:
        """What the thread has done since."""
        if not self._is_threaded:
            return
        done = self._writer.done()
        if done is not None:
            box, asked_ns = done
            # An older one than was asked for bounds only what both do.
            self._box = box if asked_ns == self._asked_ns else _common(box, self._asked)
            self._box_ns = asked_ns
        self.failure = self._writer.failure() or self.failure

    # --- waiting -------------------------------------------------------------------------------

    @property
    def is_late(self) -> bool:
        """The bounds hold no longer than it takes to brake."""
        box = self._box
        if not self._is_threaded or box is None or box.is_whole:
            return False
        return self._now_ns() - self._box_ns > _OLD_S * _NS_PER_S

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


def _holds(outer: Box | None, inner: Box) -> bool:
    return outer is not None and outer.holds(inner.low) and outer.holds(inner.high)


def _common(one: Box | None, other: Box | None) -> Box | None:
    """What both bound; None where one bounds nothing."""
    if one is None or other is None:
        return None
    return Box(
        tuple(map(max, one.low, other.low)),
        tuple(map(min, one.high, other.high)),
        one.is_whole and other.is_whole,
    )
