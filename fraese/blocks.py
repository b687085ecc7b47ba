r"""Blocks: what the world of millimetres hands to the world of steps.

A block is a straight line in step space with its time law. It is final once pushed, and every
player of blocks (the polled core, its real-time child, the microcontroller) plays the very same
integers:

    tick      one beat of the leading axis; on a tick the leader always steps
    cycle     1/16 us, the unit of step time
    q8        a fixed-point integer with eight fraction bits: interval_q8 counts 1/256 cycle,
              rate_q8 counts 1/256 tick per second

    interval  ^
              |\                            pieces of (ticks, interval, add):
              | \___                    /   every tick comes one interval after its
              |     \______      ______/    predecessor, then interval += add
              |            \____/
              +-----------------------------> ticks

Whole cycles are too coarse for ``add``: at 20 kHz and 100,000 steps/s^2 an interval of 800 cycles
shrinks by 0.2 cycles a tick. Eight fraction bits make a whole ramp a dozen pieces. A tick is
played after ``interval_q8 >> 8`` cycles; the fraction is carried in the interval only.

A dwell is a block whose ticks move no motor. A change of outputs rides on the first tick of a
block and may be the only thing in it.
"""

from collections.abc import Sequence
from enum import Enum
from typing import Final, NamedTuple

CYCLES_PER_S: Final = 16_000_000
Q8: Final = 256
#: Lowest and highest feed override, factors.
OVERRIDES: Final = (0.1, 2.0)
#: The same of rapids, which are as fast as the axes can already.
RAPID_OVERRIDES: Final = (0.1, 1.0)

#: ``rate_q8 == RATE_Q8_CYCLES // interval_cycles``; fits 32 bits without sign.
RATE_Q8_CYCLES: Final = CYCLES_PER_S * Q8

#: A dwell is cut into ticks of this length, so that a brake is seen soon.
DWELL_TICK_CYCLES: Final = CYCLES_PER_S // 100


class Piece(NamedTuple):
    """A run of ticks whose interval changes by the same amount each time."""

    ticks: int
    interval_q8: int
    add_q8: int = 0

    def last_interval_q8(self) -> int:
        """Interval before the last tick of the piece, in 1/256 cycle."""
        return self.interval_q8 + (self.ticks - 1) * self.add_q8

    def duration_cycles(self) -> int:
        """Exactly how long the piece plays, in cycles, each tick cut to whole cycles."""
        if not self.add_q8:
            return self.ticks * (self.interval_q8 >> 8)
        return sum((self.interval_q8 + k * self.add_q8) >> 8 for k in range(self.ticks))

    def mirrored(self) -> "Piece":
        """The same intervals in opposite order, to the cycle."""
        return Piece(self.ticks, self.last_interval_q8(), -self.add_q8)


def ramps(pieces: Sequence[Piece], moves: bool) -> tuple[bool, ...]:
    """For every piece that has ticks: whether it belongs to a ramp, as drives are told.

    A ramp is cut into pieces, some of a single tick, which says nothing of the rate before and
    after it. So a piece is level if it keeps one interval, none beside it in the block is shorter,
    and it is more than one tick, or one that goes on at the rate beside it, or all there is.

    Args:
        pieces: the time law of a block.
        moves: a motor moves in it; a dwell has no rate.
    """
    played = [piece for piece in pieces if piece.ticks]
    if not moves:
        return (False,) * len(played)
    befores = [None, *(piece.last_interval_q8() for piece in played[:-1])]
    afters = [*(piece.interval_q8 for piece in played[1:]), None]
    return tuple(
        not _is_level(piece, [q8 for q8 in beside if q8 is not None])
        for piece, *beside in zip(played, befores, afters, strict=True)
    )


def _is_level(piece: Piece, beside_q8: list[int]) -> bool:
    if any(q8 < piece.interval_q8 for q8 in beside_q8):
        return False
    if piece.ticks > 1:
        return not piece.add_q8
    return not beside_q8 or piece.interval_q8 in beside_q8


class WatchAction(Enum):
    """What a fulfilled watch does, besides latching the step counts."""

    #: Nothing; from then on the end switches count as usual again.
    IGNORE = "ignore"
    #: Stop at once at or below the start/stop rate, else brake; then drop the queue.
    STOP = "stop"
    #: Brake and hold; the queue stays.
    BRAKE = "brake"


class Watch(NamedTuple):
    """A condition on the status register, for as long as a block plays.

    Fulfilled when ``status & mask == value`` for the configured number of consecutive readings.
    Until then the end-switch mode does not act on a watched input.
    """

    mask: int
    value: int
    action: WatchAction


class Outputs(NamedTuple):
    """Free outputs to change: bits of ``mask`` take their value from ``value``."""

    mask: int
    value: int


class Power(NamedTuple):
    """Power of a lamp (a laser) while a block plays.

    Attributes:
        share: of its full power, 0 to ``FULL_POWER``.
        at_cycles: interval at which it has that share: played slower, it has less in proportion;
            0: the share is constant.
    """

    share: int = 0
    at_cycles: int = 0


FULL_POWER: Final = 255
DARK: Final = Power()


class Block(NamedTuple):
    """A straight line in step space with its time law.

    Attributes:
        steps: signed steps of every motor, in motor order; all zero for a dwell.
        pieces: the time law; the ticks of a moving block add up to ``max(abs(steps))``.
        accel_q: what the throttle may do to this block's rate: 1/256 tick/s per 2**16 cycles.
        jump_rate_q8: the leader's start/stop rate, from which it may stop dead.
        weight: path energy of one (tick/s)**2 of this block. In this unit the squares of the
            rates of different blocks compare: ``weight * rate**2`` is what must be shed to stop,
            ``weight * 2 * acceleration`` is what one tick of braking sheds.
        ends_at_rest: the plan is at or below the start/stop rate at the last tick.
        watch: condition while this block plays.
        outputs: change of free outputs at the first tick.
        override_q8: override that it was planned with, 256 for 100 %; 0: none acts on it.
        tag: whatever the maker wants to see in reports while the block plays (a line number).
        is_rapid: the override is that of rapids; of no interest to whoever plays it.
        power: of a lamp, where its player can set one.
    """

    steps: tuple[int, ...]
    pieces: tuple[Piece, ...]
    accel_q: int = 0
    jump_rate_q8: int = 0
    weight: int = 0
    ends_at_rest: bool = True
    watch: Watch | None = None
    outputs: Outputs | None = None
    tag: int = 0
    override_q8: int = 0
    is_rapid: bool = False
    power: Power = DARK

    def ticks(self) -> int:
        """Number of ticks, over all pieces."""
        return sum(piece.ticks for piece in self.pieces)

    def top_rate_q8(self) -> int:
        """The highest rate of its plan."""
        ends = (q8 for p in self.pieces if p.ticks for q8 in (p.interval_q8, p.last_interval_q8()))
        return RATE_Q8_CYCLES // max(1, min(ends) >> 8)

    def braking_s(self) -> float:
        """How long it takes to stop from the highest rate of its plan."""
        return self.top_rate_q8() / self.accel_q * 65536 / CYCLES_PER_S if self.accel_q else 0.0

    def duration_cycles(self) -> int:
        """Time of the plan, in cycles, if nothing throttles it."""
        return sum(piece.duration_cycles() for piece in self.pieces)


def leader_of(steps: tuple[int, ...]) -> int:
    """The motor with most steps; of equals, the first in motor order."""
    longest = max(abs(n) for n in steps)
    return next(motor for motor, n in enumerate(steps) if abs(n) == longest)


def steps_done(total_steps: int, ticks: int, done: int) -> int:
    """Unsigned steps that a motor has made after ``done`` of ``ticks`` ticks (Bresenham).

    The steps lie evenly between both ends of the line, and an axis with as many steps as the leader
    steps with it. The closed form and the running sum agree at every tick.
    """
    return (first_accumulator(total_steps, ticks) + done * total_steps) // ticks


def first_accumulator(total_steps: int, ticks: int) -> int:
    """Where the running sum of a motor starts; it grows by ``total_steps`` a tick."""
    return (ticks - total_steps) // 2


def remainder(block: Block, done: int) -> Block:
    """What is left of a block after ``done`` of its ticks, as a block of its own.

    The same steps in all; the minor axes' beat begins anew. It goes on watching; outputs have
    had their time.

    Raises:
        ValueError: if nothing is left.
    """
    ticks = block.ticks()
    if not 0 <= done < ticks:
        raise ValueError("nothing is left of this block")
    pieces = []
    skip = done
    for piece in block.pieces:
        if skip < piece.ticks:
            first_q8 = piece.interval_q8 + skip * piece.add_q8
            pieces.append(Piece(piece.ticks - skip, first_q8, piece.add_q8))
        skip = max(0, skip - piece.ticks)
    left = tuple(
        (1 if n > 0 else -1) * (abs(n) - steps_done(abs(n), ticks, done)) if n else 0
        for n in block.steps
    )
    return block._replace(steps=left, pieces=tuple(pieces), outputs=None)


def few_bits(value: int) -> int:
    """A limit with at most eight significant bits, rounded down: it travels as a byte and a shift.

    Half a per cent less than a motor could do is nothing; four bytes in every block of a queue of
    one kilobyte are much.
    """
    shift = max(0, value.bit_length() - 8)
    return value >> shift << shift


def accel_q_from_hz_s(acceleration_hz_s: float) -> int:
    """Acceleration in ticks/s**2 as the integer that the throttle works with, at least 1."""
    return max(1, few_bits(round(acceleration_hz_s * Q8 * 65536 / CYCLES_PER_S)))


def rate_q8_from_hz(rate_hz: float) -> int:
    """Start/stop rate in ticks/s as the throttle's integer."""
    return few_bits(round(rate_hz * Q8))


def dwell(motors: int, duration_s: float, tag: int = 0) -> Block:
    """A block that waits: ticks in which no motor steps.

    Raises:
        ValueError: if ``duration_s`` is negative.
    """
    if duration_s < 0:
        raise ValueError("a dwell cannot be negative")
    whole, rest = divmod(round(duration_s * CYCLES_PER_S), DWELL_TICK_CYCLES)
    pieces = [Piece(whole, DWELL_TICK_CYCLES * Q8)] if whole else []
    if rest or not whole:
        pieces.append(Piece(1, rest * Q8))
    return Block(steps=(0,) * motors, pieces=tuple(pieces), tag=tag)
