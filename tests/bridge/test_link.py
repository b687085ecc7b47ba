"""The host's end of the line as a conversation: bytes, a clock that is a number, and a bad line.

At the other end stands a model of the device's frame layer.
"""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.motor.bridge import constants as c
from fraese.motor.bridge.link import ASK_NS, RESEND_NS, WISH_NS, Link
from tests.bridge.model import RING, SESSION, BadLine, Model

MS = 1_000_000


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


def test_after_a_loss_less_is_under_way_and_then_more_again() -> None:
    """A device that is busy with steps is not helped by more to read."""
    link, model = pair()
    for _n in range(100):
        link.command(c.KIND_PING, bytes(10))
    full = len(link.output(0))
    halved = link.output(RESEND_NS)
    assert full / 3 < len(halved) <= full / 2
    assert link.output(RESEND_NS + 1) == b""
    link.feed(model.feed(halved), RESEND_NS + MS)
    longer = link.output(RESEND_NS + MS)
    assert len(halved) < len(longer) <= full
    link.feed(model.feed(longer), RESEND_NS + 2 * MS)
    talk(link, model, RESEND_NS + 2 * MS)
    assert link.done == 100


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


def gaps(link: Link, model: Model, count: int) -> list[bytes]:
    """A frame is lost, so many follow it: the answers to those, each with its GAP."""
    link.command(c.KIND_RESUME)
    link.output(0)
    answers = []
    for _n in range(count):
        link.command(c.KIND_PING)
        answers.append(model.feed(link.output(MS)))
    return answers


def test_gaps_that_speak_of_one_loss_are_heard_once() -> None:
    """The answers to what was in flight behind it come within 8 ms at 250,000 baud."""
    link, model = pair()
    first, *others = gaps(link, model, 4)
    link.feed(first, 2 * MS)
    again = link.output(2 * MS)
    sent_again, window = link.resent, link._window
    for late_ms, answer in zip((4, 7, 10), others, strict=True):
        link.feed(answer, late_ms * MS)
        assert link.output(late_ms * MS) == b""
    assert (link.resent, link._window) == (sent_again, window)
    link.feed(model.feed(again), 11 * MS)
    assert link.is_quiet


def test_a_gap_much_later_speaks_of_another_loss() -> None:
    """What was sent again was lost too: that is mended well before the patience is at its end."""
    link, model = pair()
    first, second = gaps(link, model, 2)
    link.feed(first, 2 * MS)
    again = link.output(2 * MS)
    link.feed(second, 14 * MS)
    assert link.output(14 * MS)[: len(again)] == again
    assert 14 * MS < RESEND_NS


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


def test_an_answer_that_does_not_count_an_urgent_does_not_confirm_it() -> None:
    link, model = pair()
    first = link.wish(c.URGENT_STOP, 0)
    link.feed(model.status(), MS)
    model.brakes += 1
    link.feed(model.status(), 2 * MS)
    assert link.wants(c.URGENT_STOP)
    assert link.output(WISH_NS) == first


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
