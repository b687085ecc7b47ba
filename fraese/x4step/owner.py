"""Who owns the driver: one thread, or the caller where time is virtual.

    caller   do(...) ----monitor----> owner: feeds, polls, reads keys, publishes
             facts   <---published--- owner
             brake, stop ------------> driver's flag, past everybody

Rule 1: everything but brake and stop goes through the monitor. The owner holds it for a few
        milliseconds at a time and gives way to whoever waits.
Rule 2: what is asked is answered from what was published; nobody disturbs the driver for it.
Rule 3: whoever asks again and again is made to wait a moment: a tight loop must not starve the
        owner, which may be making the steps of a simulation itself.
Rule 4: on a virtual clock there is no thread. Time passes when the same question is asked again, a
        millisecond each time, as in a loop that waits; so a program runs the same every time.
"""

import threading
import time
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from typing import Final, TypeVar

from fraese.blocks import Block
from fraese.errors import PortError
from fraese.motor.seams import Clock
from fraese.phrases import phrase
from fraese.x4step.keys import KeyReader
from fraese.x4step.motion import Motion

R = TypeVar("R")

#: On a virtual clock a question that is asked again takes so long, s.
ASK_S: Final = 0.001
#: Questions that follow sooner than this are a loop, ns;
_LOOP_NS: Final = 200_000
#: and are slowed down by so much, s.
_BREATH_S: Final = 0.000_5
#: Time for one who waits for the monitor, s.
_WAY_S: Final = 0.001
_PATIENCE_S: Final = 5.0


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of the axes at one moment.

    Attributes:
        moving: one or more axes move.
        steps: signed steps of every axis since the last start.
        inputs: the status register as last read.
        late_ticks: steps that came late by more than a quarter of their interval, since X4Init.
        brake_code: key that ended the motion; 0: none.
    """

    moving: bool
    steps: tuple[int, ...]
    inputs: int
    late_ticks: int
    brake_code: int


class Owner:
    """Owns a motion, in the caller's thread; see ``ThreadedOwner`` for one of its own.

    Args:
        motion: what is owned.
        clock: its time.
        keys: what was typed.
        complain: where to say that the port was lost.

    Attributes:
        facts: as published last.
        brake_codes: scan codes that brake.
    """

    def __init__(
        self, motion: Motion, clock: Clock, keys: KeyReader, complain: Callable[[str], None]
    ) -> None:
        self.motion = motion
        self.brake_codes: frozenset[int] = frozenset()
        self._clock = clock
        self._keys = keys
        self._complain = complain
        self._reads_keys = False
        self._brake_code = 0
        self._asked: set[Hashable] = set()
        self._attending = False
        self.facts = self._seen()

    def do(self, action: Callable[[], R]) -> R:
        """Have something done that needs the driver, and publish what came of it."""
        result = action()
        self._publish()
        return result

    def forget(self, question: Hashable) -> None:
        """The answer has changed by what the caller did: asked again, it is no loop."""
        self._asked.discard(question)

    def start(self, path: Iterator[Block]) -> None:
        """Begin a motion; it moves when this returns, or has moved.

        Raises:
            PortError: if the port cannot be reached.
        """
        self.do(lambda: self._start(path))

    def _start(self, path: Iterator[Block]) -> None:
        self._asked.clear()
        self._brake_code = 0
        self._reads_keys = True
        self._keys.begin()
        try:
            self.motion.start(path)
        finally:
            self._leave_keys()

    def brake(self) -> bool:
        """Brake; False: the axes stand. From any thread."""
        return self.motion.brake()

    def stop(self) -> bool:
        """Stop; False: the axes stand. From any thread."""
        stopped = self.motion.stop()
        if not self._attending:
            self.do(lambda: self._attend(0.0))
        return stopped

    def ask(self, question: Hashable) -> Facts:
        """The facts, for one who may be asking in a loop.

        Args:
            question: what the caller wants to know; the same again is the same loop.
        """
        if question in self._asked:
            self.pass_time(ASK_S)
        self._asked.add(question)
        return self.facts

    def pass_time(self, seconds: float) -> None:
        """Let so much time pass."""
        self._asked.clear()
        until_ns = self._clock.now_ns() + round(seconds * 1e9)
        while (left_ns := until_ns - self._clock.now_ns()) > 0:
            if not self.motion.moving:
                self._clock.wait_until(until_ns)
            self._attend(min(left_ns * 1e-9, ASK_S))
        self._publish()

    def close(self) -> None:
        """Nothing is owned any more; the axes stand."""
        self._leave_keys()

    def _attend(self, budget_s: float) -> None:
        """One look at everything. What is done meanwhile, in a wait of the clock, comes next."""
        self._attending = True
        try:
            self._hear()
            self._look(budget_s)
        finally:
            self._attending = False
        self._leave_keys()

    def _hear(self) -> None:
        for code in self._keys.codes():
            if code in self.brake_codes and self.motion.moving and not self.motion.cut_short:
                self.motion.brake()
                self._brake_code = code

    def _look(self, budget_s: float) -> None:
        was_lost = self.motion.lost is not None
        try:
            self.motion.look(budget_s)
        except PortError as error:
            if not was_lost:
                self._complain(str(error))

    def _leave_keys(self) -> None:
        """The axes stand: what is typed is the program's again."""
        if self._reads_keys and not self.motion.moving:
            self._reads_keys = False
            self._keys.end()

    def _seen(self) -> Facts:
        motion = self.motion
        report = motion.report
        return Facts(
            motion.moving, motion.steps, report.inputs, report.late_ticks, self._brake_code
        )

    def _publish(self) -> None:
        self.facts = self._seen()


class ThreadedOwner(Owner):
    """Owns a motion in a thread of its own, so that the caller may do what it likes.

    Args:
        motion: what is owned.
        clock: its time.
        keys: what was typed.
        complain: where to say that the port was lost.
        slice_s: how long one poll of the driver may take, s.
        idle_s: between two looks at the driver while the axes stand, s.
    """

    def __init__(
        self,
        motion: Motion,
        clock: Clock,
        keys: KeyReader,
        complain: Callable[[str], None],
        slice_s: float,
        idle_s: float,
    ) -> None:
        self._monitor = threading.Condition(threading.RLock())
        #: One for each who waits. A count would not do: += is not one step, append is.
        self._waiting: list[None] = []
        self._still = threading.Event()
        self._still.set()
        self._closing = self._has_failed = False
        self._slice_s = slice_s
        self._idle_s = idle_s
        self._asked_ns = 0
        self._rested_ns = time.monotonic_ns()
        super().__init__(motion, clock, keys, complain)
        self._thread = threading.Thread(target=self._live, name="x4step", daemon=True)
        self._thread.start()

    def do(self, action: Callable[[], R]) -> R:
        """Have something done that needs the driver, and publish what came of it."""
        self._waiting.append(None)
        try:
            with self._monitor:
                result = action()
                self._publish()
                self._monitor.notify_all()
                return result
        finally:
            self._waiting.pop()

    def stop(self) -> bool:
        """Stop; False: the axes stand. From any thread."""
        return self.motion.stop()

    def ask(self, question: Hashable) -> Facts:
        """The facts, for one who may be asking in a loop."""
        now_ns = time.monotonic_ns()
        if now_ns - self._asked_ns < _LOOP_NS:
            if self.facts.moving:
                self._still.wait(_BREATH_S)
            else:
                time.sleep(_BREATH_S)
            now_ns = time.monotonic_ns()
        self._asked_ns = now_ns
        return self.facts

    def pass_time(self, seconds: float) -> None:
        """Let so much time pass."""
        time.sleep(seconds)

    def close(self) -> None:
        """Nothing is owned any more; the axes stand."""
        with self._monitor:
            self._closing = True
            self._monitor.notify_all()
        self._thread.join(_PATIENCE_S)
        super().close()

    def _start(self, path: Iterator[Block]) -> None:
        if self._has_failed:
            raise PortError(
                phrase(
                    "Nobody looks after the motors any more, since that error; X4Init begins anew."
                )
            )
        super()._start(path)

    def _live(self) -> None:
        with self._monitor:
            try:
                while not self._closing:
                    self._turn()
            except Exception as error:
                # Else the motors would run, or be said to run, for ever.
                self._complain(
                    phrase("Stopped by an error in the program itself: {error}.", error=repr(error))
                )
                self._has_failed = True
                self.motion.give_up()
                self._publish()

    def _turn(self) -> None:
        if self.motion.moving:
            self._attend(self._slice_s)
            self._rested_ns = time.monotonic_ns()
        else:
            self._rest()
        self._publish()
        if self._waiting:
            self._monitor.wait(_WAY_S)

    def _rest(self) -> None:
        """The axes stand: time passes, inputs are read, the driver hears from us."""
        self._monitor.wait(self._idle_s)
        now_ns = time.monotonic_ns()
        elapsed_ns, self._rested_ns = now_ns - self._rested_ns, now_ns
        if not self.motion.moving and not self._closing:
            self._clock.pass_by(elapsed_ns)
            self._attend(0.0)

    def _publish(self) -> None:
        super()._publish()
        if self.facts.moving:
            self._still.clear()
        else:
            self._still.set()
