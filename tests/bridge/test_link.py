"""The host's end of the line as a conversation: bytes, a clock that is a number, and a bad line.

At the other end stands a model of the device's frame layer, as the protocol describes it.
"""

import random
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import STATUS_LENGTH, Decoder, Frame, Urgent, frame
from fraese.motor.bridge.link import ASK_NS, RESEND_NS, WISH_NS, Link

SESSION = 77
RING = 300
MS = 1_000_000


@dataclass
class Model:
    """The device's frame layer: what it takes, and what it answers.

    Attributes:
        taken: commands that were carried out, in order.
        stream: bytes of the record stream.
        used: bytes in the ring.
    """

    session: int = SESSION
    refuses: int = -1
    taken: list[tuple[int, bytes]] = field(default_factory=list)
    stream: bytearray = field(default_factory=bytearray)
    used: int = 0
    next_seq: int = 0
    epoch: int = 0
    brakes: int = 0
    stops: int = 0
    refused: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        self._decoder = Decoder()
        self._counter = 0

    def feed(self, data: bytes) -> bytes:
        return b"".join(self._answers(data))

    def _answers(self, data: bytes) -> Iterator[bytes]:
        for item in self._decoder.feed(data):
            if isinstance(item, Frame):
                yield self._say(c.KIND_ACK, self._ack(self._take(item)))
            elif item == Urgent(c.URGENT_STATUS):
                yield self.status()
            elif item == Urgent(c.URGENT_BRAKE):
                self.brakes += 1
            elif item == Urgent(c.URGENT_STOP):
                self.stops += 1

    def _take(self, item: Frame) -> bool:
        """True: the frame lies ahead."""
        ahead = (item.sequence - self.next_seq) & 0xFF
        if ahead:
            return ahead < 0x80
        if item.kind == c.KIND_BLOCKS:
            if self.used + len(item.payload) - 1 > RING:
                return False
            if item.payload[0] != self.epoch:
                self.refused = (item.sequence, c.REFUSED_EPOCH)
            else:
                self.stream += item.payload[1:]
                self.used += len(item.payload) - 1
        elif item.kind == self.refuses:
            self.refused = (item.sequence, c.REFUSED_MOVING)
        else:
            self.taken.append((item.kind, item.payload))
        self.next_seq = (self.next_seq + 1) & 0xFF
        return False

    def status(self) -> bytes:
        rest = bytearray(STATUS_LENGTH - 9)
        rest[33:35] = bytes((self.brakes & 0xFF, self.stops & 0xFF))
        return self._say(c.KIND_STATUS, self._ack(False) + bytes(rest))

    def _ack(self, gap: bool) -> bytes:
        free = RING - self.used
        return struct.pack(
            "<BHBBHBB", self.next_seq, self.session, gap, self.epoch, free, *self.refused
        )

    def _say(self, kind: int, payload: bytes) -> bytes:
        self._counter = (self._counter + 1) & 0xFF
        return frame(kind, self._counter, payload)

    def play(self, count: int) -> None:
        self.used = max(0, self.used - count)


def pair() -> tuple[Link, Model]:
    return Link(SESSION, RING), Model()


def talk(link: Link, model: Model, now_ns: int = 0) -> None:
    """On a good line, until nobody has anything to say."""
    while out := link.output(now_ns):
        link.feed(model.feed(out), now_ns)


def test_commands_arrive_in_order_and_are_acknowledged() -> None:
    link, model = pair()
    commands = [(c.KIND_OUTPUTS, n.to_bytes(2, "big")) for n in range(300)]
    tickets = [link.command(*command) for command in commands]
    talk(link, model)
    assert model.taken == commands
    assert tickets == list(range(1, 301))
    assert link.done == 300
    assert link.is_quiet
    assert not link.expects


def test_no_more_than_the_window_is_under_way() -> None:
    link, _ = pair()
    for _n in range(100):
        link.command(c.KIND_PING, bytes(10))
    out = link.output(0)
    assert c.WINDOW - 20 < len(out) <= c.WINDOW
    assert link.output(1) == b""


def test_the_stream_waits_for_room_and_commands_do_not() -> None:
    link, model = pair()
    data = bytes(range(1, 201)) * 3
    link.stream(data)
    talk(link, model)
    assert link.is_full
    assert model.used <= RING
    assert bytes(model.stream) == data[: len(model.stream)]
    ticket = link.command(c.KIND_FLUSH)
    talk(link, model)
    assert link.done == ticket
    while link.backlog:
        model.play(90)
        link.ask()
        talk(link, model)
    assert bytes(model.stream) == data


def test_what_was_not_sent_can_be_dropped() -> None:
    link, model = pair()
    link.stream(bytes(1000))
    talk(link, model)
    sent = len(model.stream)
    link.drop_stream()
    assert link.backlog == 0
    model.play(RING)
    link.ask()
    talk(link, model)
    assert len(model.stream) == sent


def test_a_lost_frame_is_sent_again_after_a_while() -> None:
    link, model = pair()
    link.command(c.KIND_RESUME)
    assert link.output(0)
    assert link.output(RESEND_NS - 1) == b""
    link.feed(model.feed(link.output(RESEND_NS)), RESEND_NS)
    assert model.taken == [(c.KIND_RESUME, b"")]
    assert link.resent == 1


def test_a_gap_is_mended_at_once_and_once() -> None:
    link, model = pair()
    link.command(c.KIND_RESUME)
    link.output(0)
    for _n in range(3):
        link.command(c.KIND_PING)
    answers = model.feed(link.output(MS))
    assert not model.taken
    link.feed(answers, 2 * MS)
    again = link.output(2 * MS)
    assert link.output(2 * MS) == b""
    link.feed(model.feed(again), 3 * MS)
    assert [kind for kind, _ in model.taken] == [c.KIND_RESUME] + 3 * [c.KIND_PING]
    assert link.is_quiet


def test_a_refusal_is_told_once_and_not_mistaken_later() -> None:
    link, model = pair()
    model.refuses = c.KIND_IDLE
    refused = link.command(c.KIND_IDLE, b"\x00")
    talk(link, model)
    assert link.refusal(refused) == c.REFUSED_MOVING
    assert link.refusal(refused) == 0
    # The same sequence number comes again 256 commands later; the report still shows the refusal.
    later = [link.command(c.KIND_PING) for _ in range(600)]
    talk(link, model)
    assert link.done == later[-1]
    assert [link.refusal(ticket) for ticket in later] == [0] * 600


def test_an_urgent_is_repeated_until_it_counts() -> None:
    link, model = pair()
    first = link.wish(c.URGENT_BRAKE, 0)
    assert first == bytes((c.URGENT_BRAKE,) * 2)
    assert link.output(WISH_NS - 1) == b""
    assert link.output(WISH_NS) == first
    assert link.wants(c.URGENT_BRAKE)
    model.feed(first)
    link.ask()
    talk(link, model, WISH_NS)
    assert not link.wants(c.URGENT_BRAKE)
    assert not link.output(10 * WISH_NS)


def test_a_question_is_repeated_until_it_is_answered() -> None:
    link, model = pair()
    link.ask()
    asked = bytes((c.URGENT_STATUS,))
    assert link.output(0) == asked
    link.ask()
    assert link.output(ASK_NS - 1) == b""
    assert link.output(ASK_NS) == asked
    assert len(link.feed(model.status(), ASK_NS)) == 1
    assert not link.expects


def test_an_answer_knows_of_the_commands_before_it() -> None:
    link, model = pair()
    old = model.status()
    ticket = link.command(c.KIND_PING)
    link.feed(old, 0)
    assert link.answered < ticket
    link.ask()
    talk(link, model)
    assert link.answered == ticket


def test_another_session_is_noticed_and_not_believed() -> None:
    link, model = pair()
    model.session = 0
    link.command(c.KIND_RESUME)
    link.feed(model.feed(link.output(0)), 0)
    assert link.stranger == 0
    assert link.done == 0
    assert link.feed(model.status(), 0) == []


class BadLine:
    """Loses, flips, doubles and delays; both ways."""

    def __init__(self, seed: int, badness: float) -> None:
        self._random = random.Random(seed)
        self._badness = badness
        self._late = b""

    def carry(self, data: bytes) -> bytes:
        out, self._late = bytearray(self._late), b""
        for part in self._parts(data):
            what = self._random.random() / self._badness if self._badness else 9
            if what < 0.25:
                continue
            if what < 0.5:
                at = self._random.randrange(len(part))
                part = (
                    part[:at] + bytes((part[at] ^ 1 << self._random.randrange(8),)) + part[at + 1 :]
                )
            elif what < 0.75:
                out += part
            elif what < 1:
                self._late += part
                continue
            out += part
        return bytes(out)

    def _parts(self, data: bytes) -> Iterator[bytes]:
        """Frames, more or less: what stands between two FLAGs."""
        at = 0
        while at < len(data):
            end = data.find(bytes((c.FLAG, c.FLAG)), at)
            end = len(data) if end < 0 else end + 1
            yield data[at:end]
            at = end


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    badness=st.sampled_from([0.0, 0.02, 0.1, 0.3]),
    parts=st.lists(st.binary(min_size=1, max_size=120), min_size=1, max_size=20),
)
def test_every_byte_and_command_arrives_once_in_order(
    seed: int, badness: float, parts: list[bytes]
) -> None:
    link, model = pair()
    there, back = BadLine(seed, badness), BadLine(seed + 1, badness)
    for number, part in enumerate(parts):
        link.stream(part)
        link.command(c.KIND_OUTPUTS, bytes((number, 0)))
    now_ns = 0
    while link.backlog or not link.is_quiet:
        now_ns += MS
        assert now_ns < 60_000 * MS, "it never came to an end"
        link.ask()
        link.feed(back.carry(model.feed(there.carry(link.output(now_ns)))), now_ns)
        model.play(7)
    assert bytes(model.stream) == b"".join(parts)
    assert model.taken == [(c.KIND_OUTPUTS, bytes((n, 0))) for n in range(len(parts))]


@pytest.mark.parametrize("lost", range(6))
def test_any_one_frame_may_be_lost(lost: int) -> None:
    link, model = pair()
    for number in range(6):
        link.command(c.KIND_OUTPUTS, bytes((number, 0)))
    frames = [link.output(0)]
    whole = frames[0]
    parts = [part + bytes((c.FLAG,)) for part in whole.split(bytes((c.FLAG, c.FLAG)))]
    for part in parts[:lost] + parts[lost + 1 :]:
        link.feed(model.feed(bytes((c.FLAG,)) + part), 0)
    now_ns = 0
    while link.done < 6:
        now_ns += MS
        link.feed(model.feed(link.output(now_ns)), now_ns)
    assert model.taken == [(c.KIND_OUTPUTS, bytes((n, 0))) for n in range(6)]
