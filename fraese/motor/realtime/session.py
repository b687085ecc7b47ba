"""One life of the child, spoken to: words, ring and mailbox, and what it answers.

    ask:      number -> ASKED ... look ... report with that number, or a later one
    command:  mailbox -> COMMAND ... look ... ANSWER

Rule 1: every call is a sign of life of the host.
Rule 2: numbers never come twice, from whatever thread: a word that differs is news.
Rule 3: who does not answer for a second is hung, and killed. That it is dead is told with what
        became of the motors. Only time in which we looked for an answer counts: where the whole
        machine stood still, the child could not answer either.
"""

import time
from collections.abc import Callable
from itertools import count
from typing import Final, NoReturn

from fraese import alarms
from fraese.blocks import Block
from fraese.errors import PortError, StateError
from fraese.motor.horizon import Horizon
from fraese.motor.realtime import mailbox
from fraese.motor.realtime.memory import (
    ANSWER,
    ASKED,
    HEARTBEAT,
    LEASE,
    PLACE,
    REPORT_SEQUENCE,
    RESULT,
    WISHES,
)
from fraese.motor.realtime.place import Bounds, Sent
from fraese.motor.realtime.process import ChildProcess
from fraese.motor.realtime.records import encode, size_of
from fraese.motor.realtime.report import Told, read
from fraese.motor.realtime.ring import RingWriter
from fraese.motor.realtime.setup import Setup
from fraese.phrases import phrase

#: Between two looks for an answer, s.
_ANSWER_S: Final = 0.000_1
#: Who does not answer for so long is hung, s.
HUNG_S: Final = 1.0
#: Two looks that are further apart than this were held up, s.
_HELD_UP_S: Final = 0.05
#: A report is written in a microsecond; who is in the middle of it for so many looks is dead.
_LOOKS: Final = 1000


class Session:
    """One child.

    Args:
        setup: what it is told.
        hung_s: who does not answer for so long is hung.

    Attributes:
        child: the process.
        pushed: blocks that it was given.
        generation: how many ends of runs the caller knows of (``know``).
        over: it is dead, and that was told.
        base_steps: what earlier children had counted; empty: there was none.

    Raises:
        PortError: from every method, if the child is dead.
    """

    def __init__(self, setup: Setup, hung_s: float = HUNG_S) -> None:
        self._capacity = setup.capacity
        self._hung_s = hung_s
        self._numbers = count(1)
        self.child = ChildProcess(setup)
        self._memory = self.child.memory
        self._words = self._memory.words
        self._ring = RingWriter(self._words, self._memory.ring)
        self._sequence = 0
        self._horizon = Horizon()
        self._sent = Sent()
        self.base_steps: tuple[int, ...] = ()
        self.pushed = 0
        self.generation = 0
        self.over = False
        self.beat()
        self._told = self.look()

    def beat(self) -> None:
        """A sign of life."""
        self._words[HEARTBEAT] = time.monotonic_ns()

    def wish(self, word: int, value: int | None = None) -> None:
        """Set a flag. From any thread; no error if the child is dead.

        Args:
            word: which.
            value: to this; None: to a new number.
        """
        self._words[word] = next(self._numbers) if value is None else value
        self._words[WISHES] = next(self._numbers)
        self.child.ring()

    def lease(self, until_ns: int) -> None:
        """Steps may be made until then. From any thread; no error if the child is dead."""
        self._words[LEASE] = until_ns

    def push(self, block: Block) -> bool:
        """Put a sound block on its way; False: full, nothing was taken.

        Raises:
            ValueError: if it does not fit into a record, or the ring.
        """
        if self.pushed - self.look().report.playing >= self._capacity:
            return False
        if not self._ring.has_room(size_of(block)):
            return False
        # Here there is time for it; the child would have to do it between two ticks.
        dry_point = self._horizon.add(self.pushed + 1, block)
        relative = dry_point and dry_point.moved(-self.pushed - 1)
        self._ring.put(encode(block, self.generation, relative))
        self.pushed += 1
        self._sent.forget(self._told.report.playing)
        self._sent.add(self.pushed, block)
        return True

    def know(self, generation: int) -> None:
        """The caller was told of so many ends of runs: what he pushed before is dropped."""
        if generation != self.generation:
            self.generation = generation
            self.forget()

    def forget(self) -> None:
        """The queue was dropped: what comes begins at rest."""
        self._horizon.reset()

    def look(self) -> Told:
        """The last report, as it is."""
        if self._words[REPORT_SEQUENCE] != self._sequence:
            for _ in range(_LOOKS):
                sequence = self._words[REPORT_SEQUENCE]
                told = read(self._memory)
                if told is not None:
                    self._told, self._sequence = told, sequence
                    break
        return self._told

    def ask(self) -> Told:
        """A report that knows of everything that was done before."""
        number = next(self._numbers)
        self._words[ASKED] = number
        self._wait_for(lambda: self.look().echo >= number)
        return self._told

    def command(self, kind: int, a: int = 0, b: int = 0) -> None:
        """Have something done.

        Raises:
            StateError: if it cannot be done now.
        """
        number = next(self._numbers)
        mailbox.post(self._words, number, kind, a, b)
        self._wait_for(lambda: self._words[ANSWER] == number)
        if self._words[RESULT] == mailbox.REFUSED:
            raise StateError(self._memory.text())

    def close(self) -> None:
        """Motors off, port given back.

        Raises:
            PortError: if the motors could not be switched off.
        """
        if self.over:
            return
        self.over = True
        mailbox.post(self._words, next(self._numbers), mailbox.CLOSE)
        self.child.ring()
        death = self.child.leave(self._hung_s)
        if death.error:
            raise PortError(death.sentence(), alarms.STEP_PROCESS_DIED)

    def bounds(self) -> Bounds:
        """Where the motors were at the child's death."""
        told = self.look()
        return self._sent.bounds(told.report, self._words[PLACE], told.base_steps)

    def require_life(self) -> None:
        """Tell a death, once the motors have been seen to."""
        if self.child.is_gone:
            self._tell_death()

    def _wait_for(self, answered: Callable[[], bool]) -> None:
        self.beat()
        self.child.ring()
        looked_s, waited_s = time.monotonic(), 0.0
        while not answered():
            if self.child.is_gone:
                self._tell_death()
            before_s, looked_s = looked_s, time.monotonic()
            waited_s += min(looked_s - before_s, _HELD_UP_S)
            if waited_s > self._hung_s:
                self.child.kill(
                    phrase(
                        "The step process did not answer for {hung_s:g} s and was killed",
                        hung_s=self._hung_s,
                    )
                )
                self._tell_death()
            time.sleep(_ANSWER_S)

    def _tell_death(self) -> NoReturn:
        self.over = True
        sentence = self.child.bury().sentence()
        bounds = self.bounds().after(self.base_steps)
        raise PortError(
            phrase(
                "{sentence} It was at steps {in_words}.",
                sentence=sentence,
                in_words=bounds.in_words(),
            ),
            alarms.STEP_PROCESS_DIED,
            at_steps=bounds.at_steps,
            low_steps=bounds.low_steps,
            high_steps=bounds.high_steps,
        )
