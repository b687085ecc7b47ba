"""The block in hand: where in its path and in its time law the player is.

Path and law are walked side by side and know nothing of each other. The core copies the few
numbers of its inner loop into locals and stores them back when it leaves the loop.
"""

from itertools import groupby
from math import isqrt
from operator import itemgetter
from typing import Final

from fraese.blocks import RATE_Q8_CYCLES, Block, first_accumulator, leader_of, steps_done

#: ``isqrt(accel_q * this)`` is the rate_q8 that is reached from rest within half a tick: 2**8 times
#: the square root of the acceleration in ticks/s**2.
_FROM_REST: Final = 62_500

#: A tick is divided into two to the power of this many beats at most.
MOST_DIVISIONS: Final = 3


def divisions(cycles: int, beat_cycles: int) -> int:
    """How often an interval is halved, up to three times, so that its beats stay long enough.

    Args:
        cycles: the interval.
        beat_cycles: the shortest beat that the card takes.
    """
    return min(MOST_DIVISIONS, max(0, (cycles // beat_cycles).bit_length() - 1))


class Cursor:
    """Position within one block.

    Attributes:
        block: the block in hand.
        ticks: its number of ticks.
        done: ticks played.
        leader_bit: bit mask of the leading motor, 0 in a dwell.
        minors: [accumulator, steps, bit] of every other motor that moves.
        moving: motors that step in the tick in hand, once that is settled; else 0.
        beats: beats of the tick in hand that come before its last, (number, motors), to be played.
        beats_cycles: the interval of the tick in hand, once a beat of it was played; else 0.
        moved: motors that have made their step of the tick in hand in an earlier beat,
        moving_now: and those that make it in the present one.
        piece_left: ticks left of the piece in hand, with ``interval_q8`` and ``add_q8``.
        is_ramp: the rate changes in it, as far as the drives are told so.
        entry_cycles: its first interval as planned.
        outputs: the block's change of outputs, until it is made.
        jump_rate_q8: the start/stop rate that counts: one of next to nothing would mean minutes for
            the first or last tick; a quarter of the rate that is reached within half a tick is as
            good as standing.
        jump_cycles: its interval.
    """

    def __init__(self, block: Block) -> None:
        self.block = block
        self.ticks = block.ticks()
        self.done = 0
        self.directions = tuple((n > 0) - (n < 0) for n in block.steps)
        self.leader = leader_of(block.steps) if any(block.steps) else 0
        self.leader_bit = 1 << self.leader if block.steps[self.leader] else 0
        self.minors = [
            [first_accumulator(abs(n), self.ticks), abs(n), 1 << motor]
            for motor, n in enumerate(block.steps)
            if n and motor != self.leader
        ]
        # Alone, the leader moves in every tick.
        self._settled = 0 if self.minors else self.leader_bit
        self.moving = self._settled
        self.moved = self.beats_cycles = 0
        self.moving_now = -1
        self.beats: list[tuple[int, int]] = []
        self.jump_rate_q8 = max(1, block.jump_rate_q8, isqrt(block.accel_q * _FROM_REST) >> 2)
        self.jump_cycles = RATE_Q8_CYCLES // self.jump_rate_q8
        self.entry_cycles = next((p.interval_q8 >> 8 for p in block.pieces if p.ticks), 0)
        self.outputs = block.outputs
        self._pieces = iter(block.pieces)
        self.piece_left = 0
        self.interval_q8 = 0
        self.add_q8 = 0
        self.is_ramp = False

    def next_piece(self) -> bool:
        """Take up the next piece; False when the law is at its end."""
        for piece in self._pieces:
            if piece.ticks:
                self.piece_left, self.interval_q8, self.add_q8 = piece
                return True
        return False

    def is_above_jump(self, cycles: int) -> bool:
        """An interval is shorter than that of the start/stop rate, or nothing.

        Intervals are cut to whole cycles: a sixteenth covers that.
        """
        return cycles < self.jump_cycles - (self.jump_cycles >> 4)

    def settle(self) -> int:
        """The motors that step in the coming tick; asked again, the same."""
        if not self.moving:
            moving, ticks = self.leader_bit, self.ticks
            for minor in self.minors:
                accumulator = minor[0] + minor[1]
                if accumulator >= ticks:
                    accumulator -= ticks
                    moving |= minor[2]
                minor[0] = accumulator
            self.moving = moving
        return self.moving

    def divide(self, exponent: int) -> None:
        """Spread the minors' steps of the tick in hand over ``2**exponent`` beats.

        What a motor's accumulator went beyond a whole tick tells how many beats ago that was.
        """
        beats: list[tuple[int, int]] = []
        for accumulator, steps, bit in self.minors:
            if self.moving & bit and (before_last := (accumulator << exponent) // steps):
                beats.append(((1 << exponent) - before_last, bit))
        if len(beats) > 1:
            beats.sort()
            beats = [
                (beat, sum(bit for _, bit in together))
                for beat, together in groupby(beats, key=itemgetter(0))
            ]
        self.beats = beats

    def made(self) -> None:
        """The tick in hand is done."""
        self.done += 1
        # Alone, the leader moves in every tick.
        self._settled = 0 if self.minors else self.leader_bit
        self.moving = self._settled
        self.moved = self.beats_cycles = 0

    def steps_at(self, done: int) -> tuple[int, ...]:
        """Signed steps of every motor after ``done`` ticks of this block."""
        return tuple(
            direction * steps_done(abs(n), self.ticks, done) if n else 0
            for n, direction in zip(self.block.steps, self.directions, strict=True)
        )

    def steps_after(self, done: int, moved: int) -> tuple[int, ...]:
        """The same, when the motors in a bit mask have made their step of the next tick too."""
        steps = self.steps_at(done)
        return tuple(
            n + direction if moved >> motor & 1 else n
            for motor, (n, direction) in enumerate(zip(steps, self.directions, strict=True))
        )

    def steps_within_beat(self, last_motor: int) -> tuple[int, ...]:
        """The same in the middle of a beat: motors up to ``last_motor`` have made their step.

        The order is the leader first, then motor order; ``EVERY_MOTOR`` (-1) means all have.
        """
        moving = self.moving & self.moving_now
        if last_motor == self.leader and moving & self.leader_bit:
            moving = self.leader_bit
        elif last_motor >= 0:
            moving &= self.leader_bit | (2 << last_motor) - 1
        return self.steps_after(self.done, self.moved | moving)
