"""The child plays as long as its lease holds, and stands within what was bounded for it."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import Block
from fraese.control.bounds import Box, Span, box_of
from fraese.motor.realtime import mailbox
from fraese.motor.realtime import memory as shared
from fraese.planner.lines import plan_line, planned_s
from tests.helpers import plant
from tests.motor.workbench import line
from tests.realtime.room import Room

MACHINE = plant().controller.machine
RATES_HZ = [axis.max_rate_hz for axis in MACHINE.axes]
#: As the assembly says it of a step process.
SETTLE_S = 0.03


def leased(room: Room, at_s: float, until_s: float) -> None:
    """The host puts its lease off at that moment."""
    room.at(at_s, lambda: room.words.__setitem__(shared.LEASE, round(until_s * 1e9)))


def test_a_lease_that_is_over_brakes_and_one_that_is_put_off_goes_on() -> None:
    room = Room()
    leased(room, 0.0, 0.5)
    room.play(line(9000))
    seen = []
    room.at(0.45, lambda: seen.append(room.report))
    room.at(0.8, lambda: seen.append(room.report))
    leased(room, 0.9, 60.0)
    # The host looks after it as ever.
    for k in range(300):
        room.at(0.01 * k, room.ask)
    report = room.until(2.5)
    assert [one.running for one in seen] == [True, False]
    assert seen[1].held
    assert report.position_steps == (9000, 0, 0)
    assert report.torn == frozenset()
    assert room.bench.carriages() == (9000, 0, 0)


@pytest.mark.parametrize("braked_s", [0.3, 0.505, 0.7])
def test_what_the_host_has_braked_stays_so(braked_s: float) -> None:
    """Before, just when and after its lease is over; it resumes when it wants to."""
    room = Room()
    leased(room, 0.0, 0.5)
    room.play(line(9000))
    room.at(braked_s, room.brake)
    leased(room, 0.9, 60.0)
    for k in range(400):
        room.at(0.01 * k, room.ask)
    seen = []
    room.at(1.5, lambda: seen.append(room.report))
    room.at(1.6, lambda: room.post(mailbox.RESUME))
    report = room.until(3.5)
    assert (seen[0].running, seen[0].held) == (False, True)
    assert report.position_steps == (9000, 0, 0)


def test_without_a_lease_it_plays() -> None:
    room = Room()
    room.play(line(3000))
    assert room.until(1.5).position_steps == (3000, 0, 0)


ways = st.lists(st.tuples(*[st.integers(-4000, 4000)] * 3).filter(any), min_size=1, max_size=6)


@given(ways, st.floats(0.03, 1.5), st.floats(0.0, 0.4), st.floats(60, 1200))
@settings(max_examples=60)
def test_where_it_stands_is_bounded_by_what_was_seen_when_it_was_asked_for(
    made: list[tuple[int, ...]], asked_s: float, lease_s: float, feed_mm_min: float
) -> None:
    planned = [plan_line(MACHINE, way, feed_mm_min) for way in made]
    blocks = [block for block in planned if block is not None]
    room = Room()
    room.push(*blocks)
    room.ask()
    boxes: list[Box] = []

    def ask() -> None:
        run = room.bench.core.run
        serial, cursor = run.queue.serial, run.track.cursor
        left = blocks[max(serial - 1, 0) :]
        done = 0 if cursor is None else cursor.done
        before = [block.steps for block in blocks[: max(serial - 1, 0)]]
        start = tuple(map(sum, zip((0, 0, 0), *before, strict=True)))
        spans = [whole(block, done if block is left[0] else 0) for block in left]
        if run.standing and serial == len(blocks):
            start, spans = run.track.position_steps(), []
        here = run.track.position_steps()
        boxes.append(box_of(here, start, spans, lease_s + SETTLE_S, RATES_HZ, 0.0))
        room.words[shared.LEASE] = room.time.now + round(lease_s * 1e9) + 1

    room.at(asked_s, ask)
    report = room.until(asked_s + lease_s + 1.0)
    assert not report.running
    assert boxes[0].holds(report.position_steps)
    assert boxes[0].holds(tuple(map(round, room.bench.carriages())))


def whole(block: Block, done: int) -> Span:
    """What is left of a block."""
    return Span(block, block.ticks(), done, planned_s(block))
