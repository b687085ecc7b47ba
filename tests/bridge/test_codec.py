"""Codec and records: what goes in comes out again, and damage never does."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import FULL_POWER, Block, Outputs, Piece, Power, Watch, WatchAction
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CardFacts, card_commands, card_payload
from fraese.motor.bridge.codec import (
    Ack,
    Decoder,
    Frame,
    Hello,
    Status,
    Urgent,
    frame,
    stuffed,
)
from fraese.motor.bridge.records import (
    Carried,
    Dry,
    carried_after,
    effective_jump_q8,
    record,
    sent_power,
)
from fraese.motor.cursor import Cursor
from tests.bridge.model import STATUS_LENGTH
from tests.bridge.recordreader import RecordReader

bytes_ = st.integers(0, 255)
frames = st.builds(Frame, bytes_, bytes_, st.binary(max_size=c.PAYLOAD_MAX))
limits = st.one_of(
    st.integers(0, 0xFFFF_FFFF), st.builds(lambda m, s: m << s, bytes_, st.integers(0, 24))
)


@st.composite
def pieces(draw: st.DrawFn, ticks: int) -> tuple[Piece, ...]:
    out: list[Piece] = []
    while ticks:
        count = draw(st.integers(1, ticks)) if len(out) < 20 else ticks
        goes_on = out[-1].interval_q8 + out[-1].ticks * out[-1].add_q8 if out else 300_000
        near = min(0xFFFF_FFFF, max(256, goes_on + draw(st.integers(-300, 300))))
        interval_q8 = draw(st.one_of(st.just(near), st.integers(256, 0xFFFF_FFFF)))
        # What an interval changes by has 32 bits with sign.
        down = min((interval_q8 - 256) // count, 0x7FFF_FFFF)
        up = min((0xFFFF_FFFF - interval_q8) // count, 0x7FFF_FFFF)
        add_q8 = draw(st.integers(-down, up))
        out.append(Piece(count, interval_q8, draw(st.sampled_from([0, add_q8]))))
        ticks -= count
    return tuple(out)


@st.composite
def blocks(draw: st.DrawFn) -> Block:
    most = draw(st.sampled_from([1, 127, 128, 40_000, c.MOST_TICKS]))
    steps = draw(st.tuples(*[st.integers(-most, most)] * 3))
    ticks = max(map(abs, steps))
    law = draw(pieces(ticks or draw(st.integers(0, 1000))))
    return Block(
        steps=steps,
        pieces=law,
        accel_q=draw(limits) if ticks else 0,
        jump_rate_q8=draw(limits) if ticks else 0,
        ends_at_rest=draw(st.booleans()),
        watch=draw(st.none() | st.builds(Watch, bytes_, bytes_, st.sampled_from(WatchAction))),
        outputs=draw(st.none() | st.builds(Outputs, st.integers(0, 15), st.integers(0, 15))),
        override_q8=draw(st.sampled_from([0, 256, 512])),
        power=draw(st.builds(Power, st.integers(0, FULL_POWER), st.integers(0, 1 << 16))),
    )


dry_points = st.none() | st.builds(Dry, st.integers(0, 254), st.integers(0, c.MOST_TICKS))


def as_played(block: Block) -> Block:
    """What the device makes of it: the effective start/stop rate, a power as it is sent."""
    share, energy = sent_power(block.power)
    power = Power(1, energy << 8) if energy else Power(share)
    if not any(block.steps):
        return block._replace(power=power)
    return block._replace(jump_rate_q8=effective_jump_q8(block), power=power)


@given(share=st.integers(1, FULL_POWER), at_cycles=st.integers(1, 60_000))
def test_an_energy_is_sent_to_a_share_at_full_power(share: int, at_cycles: int) -> None:
    """Of a tick of 300 cycles and more: the shortest of a bridge."""
    none, energy = sent_power(Power(share, at_cycles + 300))
    assert none == 0
    assert energy * 256 / (at_cycles + 300) == pytest.approx(share, abs=1.1)


def test_nothing_is_said_of_power_to_a_device_without_a_lamp() -> None:
    """Firmware before 1.3 would take it for something else."""
    block = Block((5, 0, 0), (Piece(5, 1 << 20),), 240 << 4, 128 << 11)
    lit = block._replace(power=Power(FULL_POWER))
    unknown = Carried(-1, -1, -1, None)
    assert record(lit, unknown, None) == record(block, unknown, None)
    assert carried_after(lit, unknown).power is None


@given(sent=st.lists(frames, max_size=5), cut=st.integers(1, 9))
def test_frames_come_back(sent: list[Frame], cut: int) -> None:
    data = b"".join(frame(*f) for f in sent)
    decoder = Decoder()
    found = [item for at in range(0, len(data), cut) for item in decoder.feed(data[at : at + cut])]
    assert found == sent
    assert decoder.damaged == 0


@given(content=st.binary())
def test_nothing_reserved_within_a_frame(content: bytes) -> None:
    assert not any(byte & c.RESERVED_MASK == c.RESERVED and byte != c.ESCAPE
                   for byte in stuffed(content))  # fmt: skip


@given(sent=frames, at=st.integers(0, 200), byte=bytes_)
def test_a_damaged_byte_makes_neither_frame_nor_urgent(sent: Frame, at: int, byte: int) -> None:
    """But right behind a flag, where an urgent byte may stand: there nobody can see it."""
    data = bytearray(frame(*sent))
    at = 1 + at % (len(data) - 2)
    data[at] = byte
    changed = bytes(data) != frame(*sent)
    found = Decoder().feed(bytes(data))
    is_urgent = byte & c.RESERVED_MASK == c.RESERVED and byte not in (c.FLAG, c.ESCAPE)
    if at == 1 and is_urgent:
        assert found == [Urgent(byte)]
    elif changed and byte != c.FLAG:
        assert found == []


def test_urgents_count_between_frames_or_doubled() -> None:
    whole = frame(c.KIND_PING, 3, b"x")
    stop = bytes((c.URGENT_STOP,))
    assert Decoder().feed(stop + whole + stop) == [
        Urgent(c.URGENT_STOP),
        Frame(c.KIND_PING, 3, b"x"),
        Urgent(c.URGENT_STOP),
    ]
    assert Decoder().feed(whole[:4] + stop + whole[4:]) == []
    assert Decoder().feed(whole[:4] + stop + stop) == [Urgent(c.URGENT_STOP)]


@given(sent=st.lists(st.tuples(blocks(), dry_points), max_size=4), cut=st.integers(1, 40))
def test_records_come_back(sent: list[tuple[Block, Dry | None]], cut: int) -> None:
    data, carried = b"", Carried()
    for block, dry in sent:
        data += record(block, carried, dry)
        carried = carried_after(block, carried)
    reader = RecordReader(3)
    found = [item for at in range(0, len(data), cut) for item in reader.feed(data[at : at + cut])]
    assert [(r.block, r.dry) for r in found] == [(as_played(b), d) for b, d in sent]


def test_a_block_of_a_stream_is_short() -> None:
    """Curves at constant feed: 63 of them fit into the ring of an Uno."""
    before = Block((90, -43, 12), (Piece(90, 182_000),), 100 << 7, 200 << 12, ends_at_rest=False)
    block = Block((88, -45, 14), (Piece(88, 186_123),), 101 << 7, 201 << 12, ends_at_rest=False)
    data = record(block, carried_after(before, Carried()), Dry(3, 60))
    assert len(data) == 16
    assert len(data) - 3 == 13


@pytest.mark.parametrize("jump_rate_q8", [0, 1, 256, 300_000])
@pytest.mark.parametrize("accel_q", [1, 3840, 10_000_000])
def test_limits_are_those_that_the_throttle_works_with(jump_rate_q8: int, accel_q: int) -> None:
    """A start/stop rate of next to nothing would mean minutes for the last tick of a hold."""
    block = Block((5, 0, 0), (Piece(5, 1 << 20),), accel_q=accel_q, jump_rate_q8=jump_rate_q8)
    (received,) = RecordReader(3).feed(record(block, Carried(), None))
    assert received.block.jump_rate_q8 == Cursor(block).jump_rate_q8


def test_too_many_ticks_are_refused() -> None:
    ticks = c.MOST_TICKS + 1
    with pytest.raises(ValueError, match="ticks"):
        record(Block((ticks,), (Piece(ticks, 1000),)), Carried(), None)


def test_reports() -> None:
    ack = struct.pack("<BHBBHBB", 7, 4711, c.ACK_GAP, 2, 900, 5, c.REFUSED_MOVING)
    assert Ack.parse(ack) == Ack(7, 4711, True, 2, 900, 5, c.REFUSED_MOVING)
    status = Status.parse(ack + bytes(STATUS_LENGTH - len(ack)))
    assert status.ack.free == 900
    with pytest.raises(ValueError, match="STATUS"):
        Status.parse(ack)
    with pytest.raises(ValueError, match="HELLO"):
        Hello.parse(b"\x01")


def test_the_card_in_commands() -> None:
    facts = CardFacts(c.CARD_PHASES, 3, bytes(8), hold=bytes(8))
    assert [kind for kind, _ in card_commands(facts)] == [c.KIND_TABLE] * 2 + [c.KIND_CARD]
    assert len(card_payload(facts)) == c.CARD_LENGTH
    with pytest.raises(ValueError, match="phase table of 1"):
        card_payload(CardFacts(c.CARD_PHASES, 3, b"x"))


def test_no_flipped_bit_makes_a_command_of_what_stands_between_frames() -> None:
    between = (c.FLAG, c.URGENT_STATUS, c.URGENT_BRAKE, c.URGENT_STOP)
    flipped = {byte ^ 1 << bit for byte in between for bit in range(8)}
    assert flipped.isdisjoint(between)
