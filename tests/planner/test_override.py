"""A lowered feed override acts at once, through the throttle; no step is changed by it."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import Q8, Block
from fraese.motor.seams import CONTROL, Report
from tests.planner.test_playing import MACHINES, PATHS, Bench, bench, planned, strokes

LONG = [(20.0, 0.0, 0.0), (20.0, 10.0, 0.0)]


def loaded(blocks: list[Block], name: str = "built-in") -> Bench:
    made = bench(MACHINES[name])
    for block in blocks:
        assert made.core.push(block)
    return made


@settings(max_examples=12)
@given(
    st.sampled_from(sorted(MACHINES)),
    PATHS,
    st.lists(st.sampled_from([0.1, 0.3, 0.5, 0.9, 1.0, 2.0]), max_size=6),
)
def test_overrides_change_no_step_and_lose_none(
    name: str, points: list[tuple[float, float, float]], factors: list[float]
) -> None:
    blocks = planned(MACHINES[name], points, 900.0)
    plain, varied = loaded(blocks, name), loaded(blocks, name)
    plain.play()
    polls = 0

    def vary(_: Report) -> None:
        nonlocal polls
        polls += 1
        if polls % 4 == 0 and factors:
            varied.core.set_override(factors.pop())

    report = varied.play(vary)
    assert not report.torn
    assert varied.lost() == (0, 0, 0)
    assert strokes(varied.port) == strokes(plain.port)


@pytest.mark.parametrize("factor", [0.1, 0.25, 0.5, 0.8])
def test_what_is_queued_is_slowed_with_the_acceleration_and_no_further(factor: float) -> None:
    blocks = planned(MACHINES["built-in"], LONG, 900.0)
    made = loaded(blocks)
    for _ in range(40):
        made.core.poll(0.01)
    before = made.core.poll(0).rate_hz
    assert before == pytest.approx(3000, rel=0.01)
    made.core.set_override(factor)
    for _ in range(25):
        report = made.core.poll(0.01)
    # An override is a whole number of 256ths.
    assert report.rate_hz == pytest.approx(factor * before, rel=0.02)
    edges_ns = [
        at for at, register, value in made.port.accesses if register == CONTROL and value & 1
    ]
    rates = [1e9 / (b - a) for a, b in pairwise(edges_ns[3:]) if b > a]
    # A slice of a millisecond of 20,000 steps/s^2; below 800 steps/s a motor may jump.
    falls = [a - b for a, b in pairwise(rates) if a > 900]
    assert max(falls) < 60 if factor > 0.3 else max(falls) < 160
    made.core.set_override(1.0)
    for _ in range(25):
        report = made.core.poll(0.01)
    assert report.rate_hz == pytest.approx(before, rel=0.01)


def test_rapids_and_feeds_have_overrides_of_their_own() -> None:
    machine = MACHINES["built-in"]

    def marks(feed_mm_min: float | None, *factors: float) -> set[tuple[bool, int]]:
        blocks = planned(machine, LONG, feed_mm_min, factors=factors)
        return {(block.is_rapid, block.override_q8) for block in blocks}

    assert marks(None) == {(True, Q8)}
    assert marks(900.0) == {(False, Q8)}
    assert marks(None, 0.5, 1.0) == {(True, Q8)}
    assert marks(900.0, 1.0, 0.5) == {(False, Q8)}
    assert marks(None, 1.0, 0.5) == {(True, Q8 // 2)}
    full, half = (
        max(block.top_rate_q8() for block in planned(machine, LONG, None, factors=factors))
        for factors in ((1.0, 1.0), (1.0, 0.5))
    )
    assert half == pytest.approx(full / 2, rel=0.01)
    assert planned(machine, LONG, None, factors=(0.5, 1.0)) == planned(machine, LONG, None)


def test_a_hold_while_limited_holds_and_goes_on_limited() -> None:
    made = loaded(planned(MACHINES["built-in"], LONG, 900.0))
    made.core.set_override(0.5)
    for _ in range(40):
        made.core.poll(0.01)
    made.core.brake()
    report = made.play()
    assert report.held
    made.core.resume()
    for _ in range(30):
        report = made.core.poll(0.01)
    assert report.rate_hz == pytest.approx(1500, rel=0.01)
    assert made.play().position_steps == (4000, 2000, 0)
    assert made.lost() == (0, 0, 0)
