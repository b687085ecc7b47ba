"""Whether every step of a long run was made once and in order, looked at piece by piece.

A log of ten million steps does not fit into memory as objects; so it is taken in slices, and what
was compared is forgotten.
"""

from collections import deque
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from fraese.motor.phases import MOTRUN
from fraese.motor.seams import DATA
from rigs.avr.board import Accesses, Decoder
from rigs.avr.simavr import Avr

Signs = npt.NDArray[np.int64]
#: What is no neighbour of the phase before it; no step is this.
_JUMP = 9


class Wanted:
    """Steps that one motor should make, as runs of a sign."""

    def __init__(self) -> None:
        self._runs: deque[tuple[int, int]] = deque()

    @property
    def left(self) -> int:
        """Steps that were not made yet."""
        return sum(count for _, count in self._runs)

    def add(self, steps: int) -> None:
        """So many more, signed."""
        if steps:
            self._runs.append((1 if steps > 0 else -1, abs(steps)))

    def begin_with(self, made: Signs) -> bool:
        """Whether the next steps are these; they are taken off."""
        at = 0
        while at < len(made):
            if not self._runs:
                return False
            sign, count = self._runs.popleft()
            part = made[at : at + count]
            if not bool(np.all(part == sign)):
                return False
            at += len(part)
            if len(part) < count:
                self._runs.appendleft((sign, count - len(part)))
        return True


class Made:
    """Steps that one motor of a phase card made, read off its data bytes."""

    def __init__(self, motor: int) -> None:
        self._motor = motor
        self._phase = 0
        self._index = np.full(64, -1)
        self._index[list(MOTRUN)] = range(len(MOTRUN))

    def steps(self, values: npt.NDArray[np.uint8]) -> Signs:
        """Signed steps in the next data bytes; one to a phase that is no neighbour is a 9."""
        phases = self._index[values[values >> 6 == self._motor] & 0x3F]
        phases = phases[phases >= 0]
        if not len(phases):
            return np.zeros(0, np.int64)
        turned = np.diff(phases, prepend=self._phase) % len(MOTRUN)
        self._phase = int(phases[-1])
        signs = np.select([turned == 1, turned == len(MOTRUN) - 1, turned == 0], [1, -1, 0], _JUMP)
        chosen: Signs = signs[signs != 0]
        return chosen


class DataBytes:
    """The data bytes of a chip, piece by piece; its log is taken.

    Args:
        avr: just switched on: which pins are outputs is told once, in the beginning.
    """

    def __init__(self, avr: Avr) -> None:
        self._avr = avr
        self._decoder = Decoder()

    def take(self) -> Accesses:
        """Those since the last call, in order, with their cycles."""
        accesses = self._decoder.decode(self._avr.take_log(), self._avr.cycle)
        chosen: Accesses = accesses[accesses["register"] == DATA]
        return chosen


class InOrder:
    """Compares what a chip makes with what it should, as both come.

    Args:
        source: of the data bytes; those so far are skipped.
        motors: of the phase card, standing at phase 0.

    Attributes:
        made: steps so far, of all motors.
        holds: every step so far was the next one of its motor.
    """

    def __init__(self, source: DataBytes, motors: int) -> None:
        self._source = source
        self._wanted = [Wanted() for _ in range(motors)]
        self._made = [Made(motor) for motor in range(motors)]
        self.made = 0
        self.holds = True
        source.take()

    def want(self, steps: Iterable[int]) -> None:
        """A block's steps, after all others."""
        for wanted, count in zip(self._wanted, steps, strict=True):
            wanted.add(count)

    @property
    def left(self) -> int:
        """Steps that are wanted and were not made yet."""
        return sum(wanted.left for wanted in self._wanted)

    def look(self) -> None:
        """Take what was made since the last look."""
        values = self._source.take()["value"]
        for wanted, motor in zip(self._wanted, self._made, strict=True):
            steps = motor.steps(values)
            self.made += len(steps)
            self.holds = wanted.begin_with(steps) and self.holds
