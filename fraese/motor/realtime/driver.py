"""The driver whose steps are made by a process of its own: the app's side.

    push ------> ring of blocks --------> child
    brake, stop, override --> words ----> child, within a tick, from any thread
    poll ------> question ... answer <--- report that knows all that came before
    flush, idle, resume, ... -> mailbox, and its answer

Rule 1: as ``MotorCore``: a run begins in ``poll``, a report knows of everything before it, a block
        that cannot be played is refused here.
Rule 2: every call is a sign of life. Who calls nothing for ``silent_s`` while the motors run is
        taken for hung: the child brakes, drops the queue and switches off.
Rule 3: a child that died, or was killed because it did not answer, is told of once, as a PortError,
        after the motors were switched off. The next ``poll`` starts another one. Counts go on from
        what was known last, and all motors are torn until something moves again.
"""

import os
import time
from contextlib import suppress
from dataclasses import replace
from typing import Final

from fraese import alarms
from fraese.anythread import any_thread
from fraese.blocks import Q8, Block
from fraese.errors import PortError
from fraese.motor.blockqueue import require_sound
from fraese.motor.realtime import mailbox
from fraese.motor.realtime.memory import BRAKES, FIRST_EDGE, LAST_EDGE, OVERRIDE, STOPS
from fraese.motor.realtime.report import Told
from fraese.motor.realtime.session import Session
from fraese.motor.realtime.setup import Setup
from fraese.motor.seams import IdleLevel, Report, SwitchMode
from fraese.phrases import phrase

#: Between two looks at a run, s.
_LOOK_S: Final = 0.001_5
#: Between two attempts to start a child again, s.
_REVIVE_S: Final = 1.0


class RealtimeDriver:
    """The peer behind the StepDriver seam that has a child make the steps.

    Args:
        setup: what the child is told: the arguments of ``MotorCore``, and how to open the port. The
            file for its last words is closed with the driver.

    Raises:
        PortError: if the child does not start; with the port's own sentence if it was that.
    """

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._motors = setup.card.motors
        self._mode = SwitchMode.STOP
        self._override_q8 = 0
        self._before: Report | None = None
        self._pushed_before = 0
        self._revive_at_s = 0.0
        self._closed = False
        try:
            self._session = Session(setup)
        except BaseException:
            self._close_words()
            raise

    @property
    def notes(self) -> tuple[str, ...]:
        """What the system granted and refused, a sentence each."""
        return tuple(self._session.child.notes)

    @property
    def pid(self) -> int:
        """The child's process number."""
        return self._session.child.pid

    def push(self, block: Block) -> bool:
        """Take a final block; False: the queue is full and nothing was taken.

        Raises:
            ValueError: if the block cannot be played as it says; nothing was taken.
        """
        self._beat()
        require_sound(block, self._motors)
        return self._session.push(block)

    def poll(self, budget_s: float) -> Report:
        """Let it play for at most that long, and say where things stand.

        Raises:
            PortError: if the child has died since the last call, or cannot be started again.
        """
        until_s = time.monotonic() + budget_s
        if self._session.over:
            self._revive()
        session = self._session
        told = session.ask()
        while told.report.running and (left_s := until_s - time.monotonic()) > 0:
            time.sleep(min(_LOOK_S, left_s))
            self._beat()
            told = session.look()
        session.know(told.generation)
        return self._report(told)

    @any_thread
    def brake(self) -> None:
        """Close the throttle; the queue stays."""
        self._session.wish(BRAKES)

    @any_thread
    def stop(self) -> None:
        """Finish the tick in hand, drop the rest."""
        self._session.wish(STOPS)

    @any_thread
    def set_override(self, factor: float) -> None:
        """Play what was planned with a higher feed override no faster."""
        self._override_q8 = round(factor * Q8)
        self._session.wish(OVERRIDE, self._override_q8)

    @any_thread
    def lease(self, until_ns: int) -> None:
        """Motors may play until then, monotonic ns; it is put off, or they brake by themselves."""
        self._session.lease(until_ns)

    def resume(self) -> None:
        """Open the throttle again; not while braking for a watch that ends the run."""
        self._command(mailbox.RESUME)

    def flush(self) -> None:
        """Drop the queue at standstill, and open the throttle for what comes next.

        Raises:
            StateError: while steps are being made.
        """
        self._command(mailbox.FLUSH)
        # Whatever run it ended, the caller knows now that nothing of it is left.
        self._session.know(self._session.ask().generation)
        self._session.forget()

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current.

        Raises:
            StateError: while steps are being made.
        """
        self._command(mailbox.IDLE, mailbox.IDLE_LEVELS.index(level))

    def set_outputs(self, mask: int, value: int) -> None:
        """Change free outputs now; those that must be safe at standstill, at the next start."""
        self._command(mailbox.OUTPUTS, mask, value)

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Choose what an end switch does to blocks that do not watch it."""
        self._mode = mode
        self._command(mailbox.SWITCH_MODE, mailbox.SWITCH_MODES.index(mode))

    def close(self) -> None:
        """Motors and outputs off, port given back, child gone. Safe to call twice.

        Raises:
            PortError: if the motors could not be switched off.
        """
        is_first, self._closed = not self._closed, True
        try:
            self._session.close()
        finally:
            if is_first:
                self._close_words()

    def _close_words(self) -> None:
        if self._setup.last_words is not None:
            os.close(self._setup.last_words.fd)

    def samples(self) -> tuple[bytes, float]:
        """What the child has measured, if it does.

        Returns:
            How late each edge was, as 32-bit numbers in ns, and from the first to the last, s.
        """
        memory = self._session.child.memory
        return memory.measured(), (memory.words[LAST_EDGE] - memory.words[FIRST_EDGE]) * 1e-9

    # --- lives -----------------------------------------------------------------------------------

    def _beat(self) -> None:
        """A sign of life, to one who lives."""
        self._require_open()
        if self._session.over:
            raise PortError(phrase("The step process is dead."), alarms.STEP_PROCESS_DIED)
        self._session.require_life()
        self._session.beat()

    def _require_open(self) -> None:
        if self._closed:
            raise PortError(phrase("The port is closed."))

    def _command(self, kind: int, a: int = 0, b: int = 0) -> None:
        self._beat()
        self._session.command(kind, a, b)

    def _revive(self) -> None:
        """Another child, that goes on where the last one was seen last."""
        self._require_open()
        now_s = time.monotonic()
        if now_s < self._revive_at_s:
            raise PortError(
                phrase("The step process is dead; it is started again in a moment."),
                alarms.STEP_PROCESS_DIED,
            )
        self._revive_at_s = now_s + _REVIVE_S
        died = self._session
        told = died.look()
        where = told.report.found_at(died.bounds().at_steps)
        last = self._report(told._replace(report=where))
        self._setup.card.set_phases(last.phases)
        session = Session(self._going_on(last.position_steps))
        session.base_steps = last.position_steps
        self._before = last
        self._pushed_before += died.pushed
        self._session = session
        if self._override_q8:
            session.wish(OVERRIDE, self._override_q8)
        session.command(mailbox.SWITCH_MODE, mailbox.SWITCH_MODES.index(self._mode))

    def _going_on(self, base_steps: tuple[int, ...]) -> Setup:
        """For a child that counts from there."""
        words = self._setup.last_words
        if words is None:
            return self._setup
        # What the last one may have left holds no more as soon as this one moves.
        with suppress(OSError):
            os.ftruncate(words.fd, 0)
            os.fsync(words.fd)
        return replace(self._setup, last_words=replace(words, base_steps=base_steps))

    def _report(self, told: Told) -> Report:
        """With what is on its way, and what was before this child's life."""
        report, pushed = told.report, self._session.pushed
        waiting = pushed - report.playing
        report = replace(
            report, free=self._setup.capacity - waiting, queued=waiting + report.queued
        )
        before = self._before
        if before is None:
            return report
        untouched = not report.playing and not report.running
        return replace(
            report,
            position_steps=_sum(before.position_steps, report.position_steps),
            travelled_steps=_sum(before.travelled_steps, report.travelled_steps),
            latched_steps=report.latched_steps
            and _sum(before.position_steps, report.latched_steps),
            playing=self._pushed_before + report.playing,
            finished=before.finished + report.finished,
            torn=frozenset(range(self._motors)) if untouched else report.torn,
            late_ticks=before.late_ticks + report.late_ticks,
            dry_queues=before.dry_queues + report.dry_queues,
        )


def _sum(before: tuple[int, ...], now: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(a + b for a, b in zip(before, now, strict=True))
