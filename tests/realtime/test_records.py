"""Blocks as bytes, and the ring that they travel in."""

from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Block, Outputs, Piece, Watch, WatchAction
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.records import Decoder, decode, encode, size_at
from fraese.motor.realtime.ring import RingReader, RingWriter

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
)


@given(BLOCKS, st.integers(0, 2**62))
def test_what_is_read_is_what_was_written(block: Block, generation: int) -> None:
    record = encode(block, generation)
    assert decode(memoryview(record)) == (block, generation)
    assert size_at(memoryview(record), 0) == len(record)
    assert len(record) % 8 == 0


@given(BLOCKS)
def test_a_long_law_is_read_in_many_small_steps(block: Block) -> None:
    steps = list(Decoder().steps(memoryview(encode(block, 0)), 0))
    assert len(steps) >= 1 + len(block.pieces) / 4


def test_a_number_that_is_too_long_is_refused() -> None:
    with pytest.raises(ValueError, match="64 bits"):
        encode(Block((1,), (Piece(1, 256),), weight=2**63), 0)


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
