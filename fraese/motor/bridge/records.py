"""Blocks as records, the stream that fills the device's ring.

    record   length | dry point | body
    body     shape | law | (rare) | (count) | steps | limits ... | pieces

Rule 1: a record says what is different: limits that are those of the block before are left out,
        an interval that goes on where the piece before ended costs nothing.
Rule 2: what the device needs and the host knows already is sent worked out: the effective
        start/stop rate, the dry point, the shortest interval of a plan with an override.
"""

import struct
from math import isqrt
from typing import Final, NamedTuple

from fraese.blocks import Block, Piece, Power, ramps
from fraese.motor.bridge.constants import (
    DRY_NONE,
    LAW_ACCEL,
    LAW_JUMP,
    LAW_OVERRIDE,
    LAW_PIECES,
    MOST_PIECES,
    MOST_TICKS,
    PIECE_ADD_SHIFT,
    PIECE_INTERVAL_SHIFT,
    PIECE_RAMP,
    RARE_ACCEL,
    RARE_ENERGY,
    RARE_JUMP,
    RARE_OUTPUTS,
    RARE_SHARE,
    RARE_TOP,
    RARE_WATCH,
    SHAPE_RARE,
    SHAPE_RESTS,
    SHAPE_WIDTH_SHIFT,
    WATCH_ACTIONS,
)

#: ``isqrt(accel_q * this) >> 2`` is a start/stop rate as good as standing, see the throttle.
_FROM_REST: Final = 62_500
#: What a number of four bytes holds.
U32: Final = 0xFFFF_FFFF
#: What the device holds of a tick's energy, to eight bits.
_MOST_ENERGY: Final = 0xFF_0000
#: Bytes of a step count, by its code.
WIDTHS: Final = (1, 2, 4)


class Carried(NamedTuple):
    """What goes on from block to block, as it is at the beginning of an epoch.

    Attributes:
        accel_q, jump_q8, override_q8: limits.
        power: of a lamp, as it was sent: share and energy; None: the device has no lamp, and
            nothing is said of any.
    """

    accel_q: int = 1
    jump_q8: int = 1
    override_q8: int = 0
    power: tuple[int, int] | None = (0, 0)


class Dry(NamedTuple):
    """A dry point: so many blocks back from the record that carries it, after so many ticks."""

    back: int
    ticks_done: int


def effective_jump_q8(block: Block) -> int:
    """The start/stop rate that the throttle works with."""
    return max(1, block.jump_rate_q8, isqrt(block.accel_q * _FROM_REST) >> 2)


def carried_after(block: Block, carried: Carried) -> Carried:
    """What the next record can leave out after this block."""
    power = None if carried.power is None else sent_power(block.power)
    if not any(block.steps):
        return carried._replace(override_q8=block.override_q8, power=power)
    return Carried(block.accel_q, effective_jump_q8(block), block.override_q8, power)


def sent_power(power: Power) -> tuple[int, int]:
    """Share and energy, one of them 0, as they are sent.

    The energy of a tick is its share times its cycles / 256, to eight significant bits: half of one
    share more or less at full power.
    """
    if not power.share or not power.at_cycles:
        return power.share, 0
    energy = min(_MOST_ENERGY, power.share * power.at_cycles >> 8)
    shift = max(0, energy.bit_length() - 8)
    mantissa = energy + (1 << shift >> 1) >> shift
    if mantissa > 0xFF:
        mantissa, shift = mantissa >> 1, shift + 1
    return 0, max(1, mantissa) << shift


def record(block: Block, carried: Carried, dry: Dry | None) -> bytes:
    """A block as it goes into BLOCKS frames.

    Args:
        block: what is to be played.
        carried: limits of the block before, ``Carried()`` at the beginning of an epoch.
        dry: where braking must begin if nothing follows; None: it ends at rest.

    Raises:
        ValueError: if the device cannot hold it: too many ticks or pieces, or a number too large.
    """
    return with_dry_point(body(block, carried), dry)


def with_dry_point(text: bytes, dry: Dry | None) -> bytes:
    """The record around a body."""
    if len(text) >= 1 << 15:
        raise ValueError(f"a record of {len(text)} bytes; 32767 at most")
    if len(text) < 0x80:
        length = bytes((len(text),))
    else:
        length = bytes((0x80 | len(text) >> 8, len(text) & 0xFF))
    return length + _dry_point(dry) + text


def _dry_point(dry: Dry | None) -> bytes:
    if dry is None:
        return bytes((DRY_NONE,))
    if not 0 <= dry.back < DRY_NONE:
        raise ValueError(f"a dry point {dry.back} blocks back; {DRY_NONE - 1} at most")
    out, left = bytearray((dry.back,)), dry.ticks_done
    while left >= 0x80:
        out.append(0x80 | left & 0x7F)
        left >>= 7
    out.append(left)
    return bytes(out)


def body(block: Block, carried: Carried) -> bytes:
    """What the device stores of a block.

    Raises:
        ValueError: if the device cannot hold it: too many ticks or pieces, or a number too large.
    """
    pieces = [piece for piece in block.pieces if piece.ticks]
    moves = any(block.steps)
    ticks = sum(piece.ticks for piece in pieces)
    if ticks > MOST_TICKS or len(pieces) > MOST_PIECES:
        raise ValueError(
            f"a block of {ticks} ticks in {len(pieces)} pieces; "
            f"the bridge plays {MOST_TICKS} in {MOST_PIECES}"
        )
    shape, steps = _steps(block.steps)
    law, rare, numbers = _limits(block, carried) if moves else (0, 0, b"")
    if block.override_q8 != carried.override_q8:
        law |= LAW_OVERRIDE
        numbers += struct.pack("<H", block.override_q8)
    if block.override_q8 and (top_cycles := _unexpected_top(pieces)):
        rare |= RARE_TOP
        numbers += top_cycles.to_bytes(3, "little")
    if block.watch:
        rare |= RARE_WATCH
        numbers += bytes((block.watch.mask, block.watch.value, WATCH_ACTIONS[block.watch.action]))
    if block.outputs:
        rare |= RARE_OUTPUTS
        numbers += bytes(((block.outputs.mask & 15) << 4 | block.outputs.value & 15,))
    if carried.power is not None and (power := sent_power(block.power)) != carried.power:
        form, number = _power(*power)
        rare |= form
        numbers += number
    head = bytearray((shape | (SHAPE_RARE if rare else 0), law | min(len(pieces), LAW_PIECES)))
    if block.ends_at_rest:
        head[0] |= SHAPE_RESTS
    if rare:
        head.append(rare)
    if len(pieces) >= LAW_PIECES:
        head.append(len(pieces))
    return bytes(head) + steps + numbers + _pieces(pieces, moves)


def _steps(steps: tuple[int, ...]) -> tuple[int, bytes]:
    """Moving motors and width for the shape, and the numbers."""
    longest = max(n if n >= 0 else -n - 1 for n in steps)
    code = 0 if longest < 0x80 else 1 if longest < 0x8000 else 2
    moving = sum(1 << motor for motor, n in enumerate(steps) if n)
    numbers = b"".join(n.to_bytes(WIDTHS[code], "little", signed=True) for n in steps if n)
    return moving | code << SHAPE_WIDTH_SHIFT, numbers


def _limits(block: Block, carried: Carried) -> tuple[int, int, bytes]:
    """Acceleration and start/stop rate, where they have changed."""
    law = rare = 0
    numbers = b""
    for value, before, short, long in (
        (block.accel_q, carried.accel_q, LAW_ACCEL, RARE_ACCEL),
        (effective_jump_q8(block), carried.jump_q8, LAW_JUMP, RARE_JUMP),
    ):
        if value == before:
            continue
        shift = max(0, value.bit_length() - 8)
        if value >> shift << shift == value:
            law |= short
            numbers += bytes((value >> shift, shift))
        else:
            rare |= long
            numbers += value.to_bytes(4, "little")
    return law, rare, numbers


def _power(share: int, energy: int) -> tuple[int, bytes]:
    if not energy:
        return RARE_SHARE, bytes((share,))
    shift = max(0, energy.bit_length() - 8)
    return RARE_ENERGY, bytes((energy >> shift, shift))


def _unexpected_top(pieces: list[Piece]) -> int:
    """The shortest interval of a plan, in cycles; 0: it is the first."""
    if not pieces:
        return 0
    shortest = min(min(p.interval_q8, p.last_interval_q8()) for p in pieces) >> 8
    return 0 if shortest == pieces[0].interval_q8 >> 8 else max(1, shortest)


def _pieces(pieces: list[Piece], moves: bool) -> bytes:
    out = bytearray()
    goes_on_q8 = 0
    for number, (piece, is_ramp) in enumerate(zip(pieces, ramps(pieces, moves), strict=True)):
        is_rest = moves and number == len(pieces) - 1
        ticks_form, ticks = (0, b"") if is_rest else _ticks(piece.ticks)
        form, interval = _interval(piece.interval_q8, goes_on_q8)
        add_form, add = _add(piece.add_q8)
        forms = ticks_form | form << PIECE_INTERVAL_SHIFT | add_form << PIECE_ADD_SHIFT
        out.append(forms | PIECE_RAMP * is_ramp)
        out += ticks + interval + add
        goes_on_q8 = piece.interval_q8 + piece.ticks * piece.add_q8 & U32
    return bytes(out)


def _ticks(ticks: int) -> tuple[int, bytes]:
    for form, size in ((1, 1), (2, 2), (3, 4)):
        if not ticks >> 8 * size:
            return form, ticks.to_bytes(size, "little")
    raise ValueError(f"a piece of {ticks} ticks")


def _interval(interval_q8: int, goes_on_q8: int) -> tuple[int, bytes]:
    change = interval_q8 - goes_on_q8
    if not change:
        return 0, b""
    if -0x80 <= change < 0x80:
        return 1, change.to_bytes(1, "little", signed=True)
    if -0x8000 <= change < 0x8000:
        return 2, change.to_bytes(2, "little", signed=True)
    size = max(2, (interval_q8.bit_length() + 7) // 8)
    if size > 4:
        raise ValueError(f"an interval of {interval_q8}/256 cycles; {U32} at most")
    return size + 1, interval_q8.to_bytes(size, "little")


def _add(add_q8: int) -> tuple[int, bytes]:
    if not add_q8:
        return 0, b""
    for form, size in ((1, 1), (2, 2), (3, 4)):
        if -1 << 8 * size - 1 <= add_q8 < 1 << 8 * size - 1:
            return form, add_q8.to_bytes(size, "little", signed=True)
    raise ValueError(f"an interval that changes by {add_q8}/256 cycles a tick")
