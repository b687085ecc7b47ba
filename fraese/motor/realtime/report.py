"""The report: taken in a moment, written in small steps, read without a lock.

    block part   way up to the block in hand, its steps and ticks: written when it changes
    now part     ticks done, flags, counts
    sequence     4       5                    6
                 whole   odd: being written   whole
    reader       reads, copies, reads again: both even and equal, or once more

Rule 1: all facts of a report are of one moment, between two ticks. They are taken in one step; what
        is done with them is done after it.
Rule 2: the child calculates nothing that the parent can: it has microseconds, the parent has time.
        So positions come as the way before the block in hand, its steps, and its ticks done.
Rule 3: a report carries the number of the last question that it answers, and how many runs ended
        before their target: what was pushed in ignorance of such an end is not played.
Rule 4: the child does not know what is still on its way. It says which block it has in hand, and
        the parent, which knows how many it has pushed, says how many wait.
Rule 5: a report that was begun is given up when another one is begun: the later one is true.
Rule 6: the motors run until they are at rest: a run that is just being ended still runs.
"""

import struct
from collections.abc import Iterable, Iterator
from typing import Final, NamedTuple

from fraese.blocks import CYCLES_PER_S, steps_done
from fraese.motor.core import MotorCore
from fraese.motor.realtime.memory import REPORT_SEQUENCE, Memory
from fraese.motor.seams import End, Ended, Report

#: More than any card drives.
MAX_MOTORS: Final = 8

_COUNTS_BYTES: Final = 8 * MAX_MOTORS
#: Ticks and tag of the block in hand; the counts follow: base, travelled, steps, latched.
_BLOCK: Final = struct.Struct("=2q")
_BLOCK_COUNTS: Final = 4
#: The other numbers, in the order of ``Reporter.steps``; the phases follow.
_NOW: Final = struct.Struct("=17q")
_NOW_AT: Final = _BLOCK.size + _BLOCK_COUNTS * _COUNTS_BYTES
_SIZE: Final = _NOW_AT + _NOW.size + _COUNTS_BYTES

_ENDS: Final = tuple(Ended)
_ENDED_NUMBER: Final = {ended: number for number, ended in enumerate(_ENDS)}

_MAY_PLAY: Final = 1
_HELD: Final = 2
_ENERGISED: Final = 4
_SWITCH_CLOSED: Final = 8
_LATCHED: Final = 16
_STANDING: Final = 32


class Told(NamedTuple):
    """A report as the child told it.

    Attributes:
        report: ``free`` is 0, and only the block in hand is ``queued``.
        echo: number of the last question that it answers.
        generation: how many runs ended before their target.
        base_steps: counts of all blocks before the one in hand.
    """

    report: Report
    echo: int
    generation: int
    base_steps: tuple[int, ...] = ()


class Reporter:
    """The child's side.

    Args:
        core: what is reported on.
        memory: where to.

    Attributes:
        echo: number of the last question that was answered.
        generation: how many runs ended before their target.
    """

    def __init__(self, core: MotorCore, memory: Memory) -> None:
        self._run = core.run
        self._card = core.card
        self._motors = core.card.motors
        self._words = memory.words
        self._target = memory.report[:_SIZE]
        self._buffer = bytearray(_SIZE)
        self._counts = struct.Struct(f"={self._motors}q")
        self._none = (0,) * self._motors
        self._block_part: tuple[object, ...] = ()
        self._begun = 0
        self.echo = 0
        self.generation = 0

    def steps(self, echo: int, due_ns: int) -> Iterator[None]:
        """Write a report; every step takes a few microseconds.

        Args:
            echo: number of the question that is answered with it.
            due_ns: when the next edge is due.
        """
        self._begun = number = self._begun + 1
        run, inputs = self._run, self._run.inputs
        track, generation, playing = run.track, self.generation, run.queue.serial
        way, tag, last_cycles, torn = track.way(), track.tag, track.last_cycles, track.torn
        finished = track.finished
        may_play, held, energised = run.may_play, run.governor.held, run.wires.energised
        standing, switch_closed, status = run.standing, inputs.switch_closed, inputs.status
        candidates, latched, ended = inputs.candidates, inputs.latched_steps, run.ended
        late_ticks, dry_queues = run.ticks.late_ticks, run.governor.dry_queues
        phases, cursor = self._card.phases(), way.cursor
        yield
        if number != self._begun:
            return
        part = (way.base_steps, way.base_travelled_steps, cursor, tag, latched)
        if part != self._block_part:
            self._block_part = part
            steps = cursor.block.steps if cursor else self._none
            self._pack_block(cursor.ticks if cursor else 1, tag, part[0], part[1], steps, latched)
            yield
            if number != self._begun:
                return
        flags = (
            _MAY_PLAY * may_play
            | _HELD * held
            | _ENERGISED * energised
            | _SWITCH_CLOSED * switch_closed
            | _LATCHED * (latched is not None)
            | _STANDING * standing
        )
        moving = cursor is not None and cursor.leader_bit
        _NOW.pack_into(
            self._buffer, _NOW_AT, self._motors, way.done, playing, cursor is not None,
            0 if standing or cursor is None else due_ns, late_ticks, dry_queues, status,
            last_cycles if moving else 0, flags, _ENDED_NUMBER[ended],
            _bits(2 * motor + (sign > 0) for motor, sign in candidates) if candidates else 0,
            _bits(torn) if torn else 0, echo, generation, way.moved,
            finished,
        )  # fmt: skip
        self._counts.pack_into(self._buffer, _NOW_AT + _NOW.size, *phases)
        yield
        if number != self._begun:
            return
        self._publish()
        self.echo = echo

    def _pack_block(self, ticks: int, tag: int, *counts: tuple[int, ...] | None) -> None:
        _BLOCK.pack_into(self._buffer, 0, ticks, tag)
        for number, count in enumerate(counts):
            at = _BLOCK.size + number * _COUNTS_BYTES
            self._counts.pack_into(self._buffer, at, *(count or self._none))

    def _publish(self) -> None:
        sequence = self._words[REPORT_SEQUENCE]
        self._words[REPORT_SEQUENCE] = sequence + 1
        self._target[:] = self._buffer
        self._words[REPORT_SEQUENCE] = sequence + 2

    def write(self, echo: int, due_ns: int = 0) -> None:
        """Write a report at once: nothing is waiting."""
        for _ in self.steps(echo, due_ns):
            pass


def read(memory: Memory) -> Told | None:
    """The report that is in the memory; None: it is being written just now."""
    before = memory.words[REPORT_SEQUENCE]
    data = bytes(memory.report[:_SIZE])
    if before & 1 or before != memory.words[REPORT_SEQUENCE]:
        return None
    return _unpack(data)


def _unpack(data: bytes) -> Told:
    (
        motors, done, playing, in_hand, due_ns, late_ticks, dry_queues, status,
        cycles, flags, ended, candidates, torn, echo, generation, in_tick, finished,
    ) = _NOW.unpack_from(data, _NOW_AT)  # fmt: skip
    ticks, tag = _BLOCK.unpack_from(data, 0)
    counts = struct.Struct(f"={motors}q")
    base, travelled, steps, latched = (
        counts.unpack_from(data, _BLOCK.size + number * _COUNTS_BYTES)
        for number in range(_BLOCK_COUNTS)
    )
    moved = [
        steps_done(abs(n), ticks, done) + (in_tick >> motor & 1) if n else 0
        for motor, n in enumerate(steps)
    ]
    report = Report(
        position_steps=tuple(
            b + (m if n > 0 else -m) for b, m, n in zip(base, moved, steps, strict=True)
        ),
        travelled_steps=tuple(b + m for b, m in zip(travelled, moved, strict=True)),
        playing=playing,
        finished=finished,
        tag=tag,
        tick=done,
        free=0,
        queued=in_hand,
        due_ns=due_ns,
        rate_hz=CYCLES_PER_S / cycles if cycles else 0.0,
        running=bool(flags & _MAY_PLAY) or not flags & _STANDING,
        held=bool(flags & _HELD),
        energised=bool(flags & _ENERGISED),
        inputs=status,
        switch_closed=bool(flags & _SWITCH_CLOSED),
        candidates=frozenset(End(bit // 2, 1 if bit & 1 else -1) for bit in _bits_set(candidates)),
        latched_steps=latched if flags & _LATCHED else None,
        ended=_ENDS[ended],
        torn=frozenset(_bits_set(torn)),
        late_ticks=late_ticks,
        dry_queues=dry_queues,
        phases=counts.unpack_from(data, _NOW_AT + _NOW.size),
    )
    return Told(report, echo, generation, base)


def _bits(numbers: Iterable[int]) -> int:
    """A set of small numbers as bits of one."""
    return sum(1 << number for number in numbers)


def _bits_set(value: int) -> list[int]:
    """The small numbers of such a set."""
    return [bit for bit in range(value.bit_length()) if value >> bit & 1]
