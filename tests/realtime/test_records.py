"""Blocks as bytes, and the ring that they travel in."""

from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import DARK, Block, Outputs, Piece, Watch, WatchAction
from fraese.motor.blockqueue import BlockQueue
from fraese.motor.horizon import DryPoint, Horizon
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.records import Decoder, decode, encode, size_at, size_of
from fraese.motor.realtime.ring import RingReader, RingWriter
from tests.motor.workbench import steady

WORD = st.integers(-(2**63), 2**63 - 1)
SMALL = st.integers(0, 255)

BLOCKS = st.builds(
    Block,
    steps=st.lists(WORD, min_size=1, max_size=4).map(tuple),
    pieces=st.lists(st.builds(Piece, WORD, WORD, WORD), max_size=20).map(tuple),
    accel_q=WORD,
    jump_rate_q8=WORD,
    weight=WORD,
    ends_at_rest=st.booleans(),
    watch=st.none() | st.builds(Watch, SMALL, SMALL, st.sampled_from(WatchAction)),
    outputs=st.none() | st.builds(Outputs, WORD, WORD),
    tag=WORD,
    override_q8=WORD,
    # Of no interest to whoever plays it.
    is_rapid=st.just(False),
    # Wires have no power in parts.
    power=st.just(DARK),
)


DRY_POINTS = st.none() | st.builds(DryPoint, st.integers(-256, 0), st.integers(0, 2**62))


@given(BLOCKS, st.integers(0, 2**62), DRY_POINTS)
def test_what_is_read_is_what_was_written(
    block: Block, generation: int, dry_point: DryPoint | None
) -> None:
    record = encode(block, generation, dry_point)
    assert decode(memoryview(record)) == (block, generation, dry_point)
    assert size_at(memoryview(record), 0) == len(record) == size_of(block)
    assert len(record) % 8 == 0


@given(st.lists(st.tuples(st.integers(1, 400), st.integers(500, 5000), st.booleans()), min_size=1))
def test_a_dry_point_that_was_sent_is_the_one_that_the_core_would_find(
    lines: list[tuple[int, int, bool]],
) -> None:
    """Blocks of so many ticks at such a rate; some are played, before the next is pushed."""
    motors = len(steady(1).steps)
    alone, told, horizon = BlockQueue(motors, 1000), BlockQueue(motors, 1000), Horizon()
    for number, (ticks, rate_hz, played) in enumerate(lines, 1):
        block = steady(ticks, rate_hz=rate_hz, ends_at_rest=False)
        found = horizon.add(number, block)
        record = encode(block, 0, found and found.moved(-number))
        _, _, point = decode(memoryview(record))
        told.accept(block, point and point.moved(told.next_serial))
        alone.push(block)
        assert told.dry_point == alone.dry_point
        if played:
            assert told.take() == alone.take()


@given(BLOCKS)
def test_a_long_law_is_read_in_many_small_steps(block: Block) -> None:
    steps = list(Decoder().steps(memoryview(encode(block, 0, None)), 0))
    assert len(steps) >= 1 + len(block.pieces) / 4


def test_a_number_that_is_too_long_is_refused() -> None:
    with pytest.raises(ValueError, match="64 bits"):
        encode(Block((1,), (Piece(1, 256),), weight=2**63), 0, None)


def record(size: int, name: int) -> bytes:
    """Bytes that begin as a record does."""
    return size.to_bytes(8, "little") + bytes([name]) * (size - 8)


class Pipe:
    """A small ring with both its ends."""

    def __init__(self, size: int) -> None:
        self.words = memoryview(bytearray(8 * shared.WORDS)).cast("Q")
        self.bytes = memoryview(bytearray(size))
        self.writer = RingWriter(self.words, self.bytes)
        self.reader = RingReader(self.words, self.bytes)

    @property
    def empty(self) -> bool:
        return self.words[shared.RING_HEAD] == self.words[shared.RING_TAIL]

    def take(self) -> bytes:
        at = self.reader.first()
        data = bytes(self.bytes[at : at + size_at(self.bytes, at)])
        self.reader.drop_first()
        return data


@given(st.lists(st.none() | st.integers(2, 16), max_size=200))
def test_a_ring_gives_in_order_what_it_took(moves: list[int | None]) -> None:
    """None takes one out, a number puts one of so many words in."""
    pipe = Pipe(256)
    waiting: deque[bytes] = deque()
    for name, words in enumerate(moves):
        if words is None:
            if waiting:
                assert pipe.take() == waiting.popleft()
        elif pipe.writer.put(data := record(8 * words, name % 256)):
            waiting.append(data)
        else:
            # What it refuses would have written over something, the skipped rest included.
            assert sum(map(len, waiting)) + 2 * 8 * words > 256
        assert pipe.empty == (not waiting)
    while waiting:
        assert pipe.take() == waiting.popleft()


def test_what_would_never_fit_is_an_error_not_a_full_ring() -> None:
    with pytest.raises(ValueError, match="too long"):
        Pipe(256).writer.put(record(136, 1))
