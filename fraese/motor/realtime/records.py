"""Blocks as bytes: how they lie in the ring.

    header   18 numbers of 8 bytes
    steps    one number a motor
    pieces   three numbers a piece

Rule 1: plain signed 64-bit numbers, native order: both sides are the same machine.
Rule 2: a record is a multiple of eight bytes.
Rule 3: reading goes in small steps, for somebody who has only microseconds between two ticks. So
        where braking must begin if nothing more comes is computed by the writer, and sent along.
"""

import struct
from collections.abc import Iterator
from typing import Final

from fraese.blocks import Block, Outputs, Piece, Watch, WatchAction
from fraese.motor.horizon import DryPoint

_HEADER: Final = struct.Struct("=18q")
_PIECE: Final = struct.Struct("=3q")
_NUMBER_BYTES: Final = 8
#: Pieces that are read in one step.
_PIECES_A_STEP: Final = 4
_ACTIONS: Final = tuple(WatchAction)

_ENDS_AT_REST: Final = 1
_HAS_WATCH: Final = 2
_HAS_OUTPUTS: Final = 4
_MAY_RUN_DRY: Final = 8


def size_of(block: Block) -> int:
    """Bytes of its record."""
    return _HEADER.size + len(block.steps) * _NUMBER_BYTES + len(block.pieces) * _PIECE.size


def encode(block: Block, generation: int, dry_point: DryPoint | None) -> bytes:
    """A block as a record.

    Args:
        block: what to write.
        generation: how many ends of runs its maker knew of.
        dry_point: where braking must begin if it stays the last one, blocks counted from this one
            on (0, or less for one before it); None: nowhere.

    Raises:
        ValueError: if a number of it needs more than 64 bits.
    """
    watch = block.watch or Watch(0, 0, WatchAction.IGNORE)
    outputs = block.outputs or Outputs(0, 0)
    flags = (
        _ENDS_AT_REST * block.ends_at_rest
        | _HAS_WATCH * (block.watch is not None)
        | _HAS_OUTPUTS * (block.outputs is not None)
        | _MAY_RUN_DRY * (dry_point is not None)
    )
    motors, pieces = len(block.steps), len(block.pieces)
    dry = dry_point or DryPoint(0, 0)
    flat = [number for piece in block.pieces for number in piece]
    header = (
        size_of(block), generation, motors, pieces, flags,
        block.accel_q, block.jump_rate_q8, block.weight, block.override_q8, block.tag,
        watch.mask, watch.value, _ACTIONS.index(watch.action), outputs.mask, outputs.value,
        dry.serial, dry.ticks_done, 0,
    )  # fmt: skip
    try:
        return _HEADER.pack(*header) + struct.pack(f"={motors + 3 * pieces}q", *block.steps, *flat)
    except struct.error as error:
        raise ValueError("a block with a number of more than 64 bits") from error


def size_at(buffer: memoryview, at: int) -> int:
    """Bytes of the record that begins there."""
    size: int = struct.unpack_from("=q", buffer, at)[0]
    return size


class Decoder:
    """Reads one record, step by step.

    Attributes:
        generation: how many ends of runs its maker knew of.
        block: the block, when the steps are done.
        dry_point: where braking must begin if it stays the last one.
    """

    def __init__(self) -> None:
        self.generation = 0
        self.dry_point: DryPoint | None = None
        self.block: Block | None = None

    def steps(self, buffer: memoryview, at: int) -> Iterator[None]:
        """Read the record that begins there; every step takes a few microseconds."""
        self.block = None
        (
            _, self.generation, motors, pieces, flags,
            accel_q, jump_rate_q8, weight, override_q8, tag,
            watch_mask, watch_value, action, outputs_mask, outputs_value,
            dry_serial, dry_ticks, _,
        ) = _HEADER.unpack_from(buffer, at)  # fmt: skip
        at += _HEADER.size
        steps = struct.unpack_from(f"={motors}q", buffer, at)
        at += motors * _NUMBER_BYTES
        yield
        law: list[Piece] = []
        for first in range(0, pieces, _PIECES_A_STEP):
            for _ in range(first, min(first + _PIECES_A_STEP, pieces)):
                law.append(Piece._make(_PIECE.unpack_from(buffer, at)))
                at += _PIECE.size
            yield
        self.dry_point = DryPoint(dry_serial, dry_ticks) if flags & _MAY_RUN_DRY else None
        watch = Watch(watch_mask, watch_value, _ACTIONS[action]) if flags & _HAS_WATCH else None
        self.block = Block(
            steps=steps,
            pieces=tuple(law),
            accel_q=accel_q,
            jump_rate_q8=jump_rate_q8,
            weight=weight,
            ends_at_rest=bool(flags & _ENDS_AT_REST),
            watch=watch,
            outputs=Outputs(outputs_mask, outputs_value) if flags & _HAS_OUTPUTS else None,
            tag=tag,
            override_q8=override_q8,
        )


def decode(buffer: memoryview, at: int = 0) -> tuple[Block, int, DryPoint | None]:
    """The block of a record, its generation, its dry point, at once."""
    decoder = Decoder()
    for _ in decoder.steps(buffer, at):
        pass
    assert decoder.block is not None
    return decoder.block, decoder.generation, decoder.dry_point
