"""The stream of records taken apart again: a model of the device's end of it.

What comes back is the block as the device plays it: without weight and tag, its start/stop rate the
effective one.
"""

from typing import Final, NamedTuple

from fraese.blocks import Block, Outputs, Piece, Power, Watch
from fraese.motor.bridge.constants import (
    DRY_NONE,
    LAW_ACCEL,
    LAW_JUMP,
    LAW_OVERRIDE,
    LAW_PIECES,
    PIECE_ADD_SHIFT,
    PIECE_INTERVAL_SHIFT,
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
from fraese.motor.bridge.records import U32, WIDTHS, Carried, Dry, carried_after

_ACTIONS: Final = {number: action for action, number in WATCH_ACTIONS.items()}


class Received(NamedTuple):
    """A record as the device understands it.

    Attributes:
        block: without weight and tag, with the effective start/stop rate.
        top_cycles: shortest interval of the plan, in cycles; 0: none was sent.
        dry: its dry point.
    """

    block: Block
    top_cycles: int
    dry: Dry | None


class RecordReader:
    """Takes the stream in pieces of any size and gives the blocks in it.

    Args:
        motors: of the card.
    """

    def __init__(self, motors: int) -> None:
        self._motors = motors
        self._carried = Carried()
        self._data = bytearray()

    def feed(self, data: bytes) -> list[Received]:
        """All records that came to their end with these bytes."""
        self._data += data
        found = []
        while (whole := self._whole_record()) is not None:
            dry, text, used = whole
            block, top_cycles = self._block(_Bytes(text))
            self._carried = carried_after(block, self._carried)
            found.append(Received(block, top_cycles, dry))
            del self._data[:used]
        return found

    def _whole_record(self) -> tuple[Dry | None, bytes, int] | None:
        """Dry point, body, and bytes used; None: it has not come wholly."""
        take = _Bytes(bytes(self._data))
        try:
            length = take.unsigned(1)
            if length & 0x80:
                length = (length & 0x7F) << 8 | take.unsigned(1)
            back, ticks_done, shift = take.unsigned(1), 0, 0
            more = back != DRY_NONE
            while more:
                byte = take.unsigned(1)
                ticks_done |= (byte & 0x7F) << shift
                shift += 7
                more = bool(byte & 0x80)
            text = take.some(length)
        except IndexError:
            return None
        return (None if back == DRY_NONE else Dry(back, ticks_done)), text, take.at

    def _block(self, take: "_Bytes") -> tuple[Block, int]:
        shape, law = take.unsigned(1), take.unsigned(1)
        rare = take.unsigned(1) if shape & SHAPE_RARE else 0
        count = law & LAW_PIECES
        if count == LAW_PIECES:
            count = take.unsigned(1)
        width = WIDTHS[shape >> SHAPE_WIDTH_SHIFT & 3]
        steps = tuple(
            take.signed(width) if shape >> motor & 1 else 0 for motor in range(self._motors)
        )
        before = self._carried
        accel_q = take.limit(law & LAW_ACCEL, rare & RARE_ACCEL, before.accel_q)
        jump_q8 = take.limit(law & LAW_JUMP, rare & RARE_JUMP, before.jump_q8)
        override_q8 = take.unsigned(2) if law & LAW_OVERRIDE else before.override_q8
        top_cycles = take.unsigned(3) if rare & RARE_TOP else 0
        watch = outputs = None
        if rare & RARE_WATCH:
            watch = Watch(take.unsigned(1), take.unsigned(1), _ACTIONS[take.unsigned(1)])
        if rare & RARE_OUTPUTS:
            packed = take.unsigned(1)
            outputs = Outputs(packed >> 4, packed & 15)
        power = self._power(take, rare)
        pieces = _read_pieces(take, count, max(abs(n) for n in steps))
        moves = any(steps)
        block = Block(
            steps=steps,
            pieces=pieces,
            accel_q=accel_q if moves else 0,
            jump_rate_q8=jump_q8 if moves else 0,
            ends_at_rest=bool(shape & SHAPE_RESTS),
            watch=watch,
            outputs=outputs,
            override_q8=override_q8,
            power=power,
        )
        return block, top_cycles

    def _power(self, take: "_Bytes", rare: int) -> Power:
        """An energy comes back as a share of 1 at so many cycles."""
        share, energy = self._carried.power or (0, 0)
        if rare & RARE_SHARE:
            share, energy = take.unsigned(1), 0
        if rare & RARE_ENERGY:
            share, energy = 0, take.limit(1, 0, 0)
        return Power(1, energy << 8) if energy else Power(share)


def _read_pieces(take: "_Bytes", count: int, longest: int) -> tuple[Piece, ...]:
    pieces: list[Piece] = []
    goes_on_q8 = done = 0
    for _ in range(count):
        head = take.unsigned(1)
        form = head & 3
        ticks = take.unsigned((0, 1, 2, 4)[form]) if form else longest - done
        form = head >> PIECE_INTERVAL_SHIFT & 7
        if form >= 3:
            interval_q8 = take.unsigned(form - 1)
        else:
            interval_q8 = goes_on_q8 + (take.signed(form) if form else 0)
        form = head >> PIECE_ADD_SHIFT & 3
        add_q8 = take.signed((0, 1, 2, 4)[form]) if form else 0
        pieces.append(Piece(ticks, interval_q8, add_q8))
        done += ticks
        goes_on_q8 = interval_q8 + ticks * add_q8 & U32
    return tuple(pieces)


class _Bytes:
    """Numbers out of bytes, one after the other.

    Raises:
        IndexError: from every method, when there are not enough.
    """

    def __init__(self, data: bytes) -> None:
        self._data = data
        self.at = 0

    def some(self, count: int) -> bytes:
        if self.at + count > len(self._data):
            raise IndexError(count)
        self.at += count
        return self._data[self.at - count : self.at]

    def unsigned(self, size: int) -> int:
        return int.from_bytes(self.some(size), "little")

    def signed(self, size: int) -> int:
        return int.from_bytes(self.some(size), "little", signed=True)

    def limit(self, short: int, long: int, before: int) -> int:
        if short:
            mantissa = self.unsigned(1)
            return mantissa << self.unsigned(1)
        return self.unsigned(4) if long else before
