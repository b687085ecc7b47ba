r"""Paths: what X4Load and X4MovePos ask for, as blocks.

    rate  |      ________ f
          |     /        \            ramp: t ms from standstill to f, so a = 1000 f / t
          |____/          \____       its first step is at sqrt(a / 2), as from rest
          +----------------------> ticks of the leader

Rule 1: both ramps are mirror images of each other, to the cycle.
Rule 2: between them are ``CREST_TICKS`` steps at one rate or more, on every path: also where the
        ramps alone would just reach the rate. For that the ramps are made shorter.
Rule 3: a path may be longer than a block may be. It is cut on the line; from cut to cut the other
        axes lie evenly, within a step of the whole line.
Rule 4: an endless path is a ramp and then blocks of the same rate, for as long as they are taken.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Final

from fraese.blocks import Q8, Block, Piece, accel_q_from_hz_s, steps_done
from fraese.planner.ramps import CREST_TICKS, interval_q8, mirrored, ramp_up

#: What every driver takes in one block; the bridge has 21 bits for it,
MOST_TICKS: Final = (1 << 21) - 1
#: and a kilobyte for all that waits.
MOST_PIECES: Final = 32
#: Of an endless path: a block is never shorter than 50 s.
ENDLESS_TICKS: Final = 1_000_000

#: What stands for "at once" where no ramp is wanted: the rate within a millisecond.
_NO_RAMP_MS: Final = 1

Law = list[Piece]


def acceleration_hz_s(freq_hz: int, ramp_ms: int) -> float:
    """Change of the leader's rate in a ramp, steps/s per second."""
    return 1000.0 * freq_hz / (ramp_ms or _NO_RAMP_MS)


def ramp_ticks(freq_hz: int, ramp_ms: int) -> int:
    """Steps of a whole ramp; a step slower than the level rate is one, however short the ramp."""
    length = freq_hz * ramp_ms / 2000
    if length < 0.5:
        return int(ramp_ms > 0 and _first_hz(freq_hz, ramp_ms) < freq_hz)
    return int(length + 0.5)


def time_law(ticks: int, freq_hz: int, ramp_ms: int) -> Law:
    """Up, level, down, over exactly so many steps of the leader.

    Args:
        ticks: length, at least 1.
        freq_hz: rate that is never exceeded.
        ramp_ms: time of a ramp from standstill to that rate.
    """
    whole = ramp_ticks(freq_hz, ramp_ms)
    ramp = min(whole, max(0, ticks - CREST_TICKS) // 2)
    twice_hz_s = 2 * acceleration_hz_s(freq_hz, ramp_ms)
    up = ramp_up(0.0, twice_hz_s, ramp)
    level_hz = float(freq_hz)
    if ramp < whole:
        level_hz = min(level_hz, math.sqrt(twice_hz_s * ramp) or _first_hz(freq_hz, ramp_ms))
    return [*up, Piece(ticks - 2 * ramp, interval_q8(level_hz)), *mirrored(up)]


def path(steps: tuple[int, ...], freq_hz: int, ramp_ms: int) -> Iterator[Block]:
    """The blocks of a path.

    Args:
        steps: signed steps of all axes, at least one not 0.
        freq_hz: rate of the axis with most steps.
        ramp_ms: time of its ramps.
    """
    ticks = max(abs(n) for n in steps)
    law = _cut(time_law(ticks, freq_hz, ramp_ms))
    limits = _Limits(freq_hz, ramp_ms)
    done = 0
    for pieces in law:
        until = done + sum(piece.ticks for piece in pieces)
        here, there = _on_line(steps, ticks, done), _on_line(steps, ticks, until)
        way = tuple(b - a for a, b in zip(here, there, strict=True))
        yield limits.block(way, pieces, ends_at_rest=until == ticks)
        done = until


def endless(motor: int, sign: int, freq_hz: int, ramp_ms: int, motors: int = 4) -> Iterator[Block]:
    """The blocks of an endless path of one axis; there is always another one.

    Args:
        motor: from 0.
        sign: +1 or -1.
        freq_hz: its rate.
        ramp_ms: time of the ramp.
        motors: how many there are.
    """
    limits = _Limits(freq_hz, ramp_ms)
    level = Piece(ENDLESS_TICKS, interval_q8(freq_hz))
    up = ramp_up(0.0, 2 * acceleration_hz_s(freq_hz, ramp_ms), ramp_ticks(freq_hz, ramp_ms))
    for pieces in _followed_by(_cut([*up, level]), (level,)):
        ticks = sum(piece.ticks for piece in pieces)
        way = tuple(sign * ticks if number == motor else 0 for number in range(motors))
        yield limits.block(way, pieces, ends_at_rest=False)


def _followed_by(first: Iterable[Law], then: tuple[Piece, ...]) -> Iterator[Law]:
    yield from first
    while True:
        yield list(then)


class _Limits:
    """What the throttle may do on a path: brake with its ramp, and stop at its first rate."""

    def __init__(self, freq_hz: int, ramp_ms: int) -> None:
        self._accel_q = accel_q_from_hz_s(acceleration_hz_s(freq_hz, ramp_ms))
        jump_hz = _first_hz(freq_hz, ramp_ms) if ramp_ms else float(freq_hz)
        self._jump_rate_q8 = _few_bits_up(math.ceil(jump_hz * Q8))

    def block(self, steps: tuple[int, ...], pieces: Law, *, ends_at_rest: bool) -> Block:
        return Block(
            steps=steps,
            pieces=tuple(pieces),
            accel_q=self._accel_q,
            jump_rate_q8=self._jump_rate_q8,
            weight=1,
            ends_at_rest=ends_at_rest,
        )


def _first_hz(freq_hz: int, ramp_ms: int) -> float:
    """Rate of the first step of a ramp from rest."""
    return math.sqrt(acceleration_hz_s(freq_hz, ramp_ms) / 2)


def _few_bits_up(value: int) -> int:
    """As ``blocks.few_bits``, to the other side: what is played must not be above it."""
    shift = max(0, value.bit_length() - 8)
    return -(-value >> shift) << shift


def _on_line(steps: tuple[int, ...], ticks: int, done: int) -> tuple[int, ...]:
    return tuple((1 if n > 0 else -1) * steps_done(abs(n), ticks, done) for n in steps)


def _cut(law: Law) -> Iterator[Law]:
    """The law in parts that fit into a block."""
    part: Law = []
    room = MOST_TICKS
    for piece in law:
        while piece.ticks:
            if not room or len(part) == MOST_PIECES:
                yield part
                part, room = [], MOST_TICKS
            taken = min(room, piece.ticks)
            part.append(piece._replace(ticks=taken))
            piece = Piece(
                piece.ticks - taken, piece.interval_q8 + taken * piece.add_q8, piece.add_q8
            )
            room -= taken
    yield part
