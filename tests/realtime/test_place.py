"""Where a step process was when it died: of the last report, the last note, and what was sent."""

from dataclasses import replace

import pytest

from fraese.motor.cursor import Cursor
from fraese.motor.realtime.place import Sent, noted
from tests.helpers import plant
from tests.motor.workbench import steady

BLOCKS = (steady(10, -4), steady(-3, 6, 2), steady(5))
WAYS = [(0, 0, 0), (10, -4, 0), (7, 2, 2), (12, 2, 2)]


def at(number: int, done: int) -> tuple[int, ...]:
    steps = Cursor(BLOCKS[number - 1]).steps_at(done)
    return tuple(a + b for a, b in zip(WAYS[number - 1], steps, strict=True))


@pytest.mark.parametrize("report_at", [(1, 0), (1, 4), (1, 10), (2, 3), (3, 5)])
@pytest.mark.parametrize("note_at", [(0, 0), (1, 3), (1, 9), (2, 0), (2, 6), (3, 2)])
def test_the_later_of_report_and_note_counts(
    report_at: tuple[int, int], note_at: tuple[int, int]
) -> None:
    sent = Sent()
    for number, block in enumerate(BLOCKS, 1):
        sent.add(number, block)
    playing, tick = report_at
    report = replace(
        plant().controller._loop._queue.report, position_steps=at(playing, tick),
        playing=playing, tick=tick, queued=1, running=True,
    )  # fmt: skip
    bounds = sent.bounds(report, noted(*note_at), WAYS[playing - 1])
    number, done = max(report_at, note_at)
    assert bounds.at_steps == at(number, done)
    more = done + 1 <= BLOCKS[number - 1].ticks()
    after = at(number, done + 1) if more else at(min(number + 1, 3), 1 if number < 3 else 5)
    for low, true, high in zip(bounds.low_steps, after, bounds.high_steps, strict=True):
        assert low <= true <= high
        assert high - low <= 2


def test_motors_that_stand_are_where_the_report_says() -> None:
    sent = Sent()
    sent.add(1, BLOCKS[0])
    report = replace(
        plant().controller._loop._queue.report,
        position_steps=(10, -4, 0), playing=1, tick=0, queued=0, running=False,
    )  # fmt: skip
    bounds = sent.bounds(report, noted(1, 9), (10, -4, 0))
    assert bounds.at_steps == bounds.low_steps == bounds.high_steps == (10, -4, 0)
    assert bounds.in_words() == "motor 1 10, motor 2 -4, motor 3 0"
