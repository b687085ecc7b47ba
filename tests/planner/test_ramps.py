import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import CYCLES_PER_S, Q8, Block, Piece
from fraese.machine import Machine
from fraese.planner.lines import plan_line
from fraese.planner.ramps import interval_q8, mirrored, ramp_up, time_law
from fraese.planner.segments import start_rate_hz
from tests.planner.motion import check_limits, duration_s, intervals_s, machine

START = st.floats(0, 3000)
ACCELERATION = st.floats(500, 200_000)


def law(pieces: list[Piece]) -> np.ndarray:
    return intervals_s(Block((sum(piece.ticks for piece in pieces),), tuple(pieces)))


@given(START, ACCELERATION, st.integers(1, 5000))
def test_a_ramp_has_its_ticks_and_braking_is_its_mirror_image(
    start: float, acceleration: float, ticks: int
) -> None:
    up = ramp_up(start**2, 2 * acceleration, ticks)
    assert sum(piece.ticks for piece in up) == ticks
    assert list(law(up)) == list(law(mirrored(up))[::-1])


@given(st.floats(1, 200_000))
def test_a_rate_is_played_no_faster_than_it_was_meant(rate_hz: float) -> None:
    played_hz = CYCLES_PER_S * Q8 / interval_q8(rate_hz)
    assert rate_hz * (1 - 1e-3) < played_hz <= rate_hz * (1 + 1e-12)


@given(st.floats(50, 3000), ACCELERATION, st.integers(2, 5000))
def test_a_ramp_is_never_ahead_of_its_law_and_hardly_behind(
    start: float, acceleration: float, ticks: int
) -> None:
    played = np.cumsum(law(ramp_up(start**2, 2 * acceleration, ticks)))
    k = np.arange(1, ticks + 1)
    meant = (np.sqrt(start**2 + 2 * acceleration * k) - start) / acceleration
    assert (played >= meant * (1 - 1e-9)).all()
    # A cycle of rounding a tick, and what a chord cuts off.
    assert (played <= meant * 1.005 + k / CYCLES_PER_S).all()


@given(st.floats(100, 3000), ACCELERATION, st.integers(2, 5000))
def test_local_acceleration_overshoots_by_less_than_a_tenth(
    start: float, acceleration: float, ticks: int
) -> None:
    times = law(ramp_up(start**2, 2 * acceleration, ticks))
    rates = 1 / times
    change = np.diff(rates) / ((times[1:] + times[:-1]) / 2)
    rounding = 2 * rates[1:] ** 2 / CYCLES_PER_S * rates[1:]
    assert (change <= acceleration * 1.1 + rounding).all()


@given(
    st.integers(1, 4000),
    st.floats(0, 4000),
    st.floats(100, 6000),
    st.floats(0, 4000),
    ACCELERATION,
)
def test_every_law_has_exactly_its_ticks_and_keeps_its_rates(
    ticks: int, entry: float, cruise: float, leave: float, acceleration: float
) -> None:
    twice = 2 * acceleration
    cruise2 = cruise**2
    entry2 = min(entry**2, cruise2)
    exit2 = min(leave**2, cruise2, entry2 + twice * ticks)
    entry2 = min(entry2, exit2 + twice * ticks)
    pieces = time_law(ticks, entry2, cruise2, exit2, twice)
    assert sum(piece.ticks for piece in pieces) == ticks
    assert all(piece.ticks > 0 for piece in pieces)
    # Below the rate of a single tick's acceleration from rest nothing can be told apart.
    assert (1 / law(pieces) <= max(cruise, math.sqrt(acceleration)) * (1 + 1e-6)).all()


def test_entered_too_fast_it_brakes_first_and_then_cruises() -> None:
    pieces = time_law(1000, 3000.0**2, 1000.0**2, 800.0**2, 2 * 20_000)
    rates = 1 / law(pieces)
    assert rates[0] == pytest.approx(3000, rel=0.01)
    assert (np.diff(rates[:200]) < 0).all()
    assert np.median(rates) == pytest.approx(1000, rel=1e-3)
    assert rates[-1] == pytest.approx(800, rel=0.03)


def test_too_short_to_get_slower_it_brakes_all_the_way() -> None:
    pieces = time_law(10, 3000.0**2, 1000.0**2, 3000.0**2 - 10 * 40_000, 2 * 20_000)
    assert (np.diff(law(pieces)) > 0).all()


@pytest.mark.parametrize("ticks", [20, 57, 150])
def test_a_short_move_has_a_crest_of_constant_rate(ticks: int) -> None:
    times = law(time_law(ticks, 800.0**2, 8000.0**2, 800.0**2, 2 * 20_000))
    fastest = np.isclose(times, times.min(), rtol=1e-9)
    # X4Step: a motor is not torn from acceleration into braking.
    assert fastest.sum() >= 4
    assert np.allclose(times, times[::-1], rtol=0.01)


def optimum_s(axes: Machine, steps: tuple[int, int, int], feed: float | None) -> float:
    """Start/stop rate, constant acceleration, cruise: the fastest there is."""
    ticks = max(map(abs, steps))
    parts = [(axis, abs(n) / ticks) for axis, n in zip(axes.axes, steps, strict=True) if n]
    start = min(axis.start_rate_hz / part for axis, part in parts)
    top = min(axis.max_rate_hz / part for axis, part in parts)
    acceleration = min(axis.acceleration_hz_s / part for axis, part in parts)
    if feed is not None:
        top = min(top, feed / 60 * ticks / math.hypot(*axes.to_mm(steps)))
    start = min(start, top)
    peak = min(top, math.sqrt(start**2 + acceleration * ticks))
    ramps = (peak**2 - start**2) / acceleration
    return 2 * (peak - start) / acceleration + (ticks - ramps) / peak


STEPS = st.tuples(*[st.integers(-6000, 6000)] * 3).filter(lambda s: max(map(abs, s)) >= 200)


@given(STEPS, st.sampled_from([None, 60.0, 300.0, 1500.0]))
def test_straight_moves_take_hardly_longer_than_the_optimum(
    steps: tuple[int, int, int], feed: float | None
) -> None:
    axes = machine()
    block = plan_line(axes, steps, feed)
    assert block is not None
    best = optimum_s(axes, steps, feed)
    assert best * (1 - 1e-3) <= duration_s([block]) <= best * 1.02
    assert block.steps == steps
    check_limits(axes.axes, [block])


@given(st.integers(200, 20_000), st.floats(50, 2000), ACCELERATION)
def test_so_do_fast_and_slow_machines(ticks: int, start: float, acceleration: float) -> None:
    axes = machine(start_rate_hz=start, max_rate_hz=20_000.0, acceleration_hz_s=acceleration)
    block = plan_line(axes, (ticks, 0, 0))
    assert block is not None
    # Where the start/stop rate is low, it counts that the first and the last tick must have it.
    start = start_rate_hz(axes.axes[0])
    after = start + acceleration / (2 * start)
    inner = machine(start_rate_hz=after, max_rate_hz=20_000.0, acceleration_hz_s=acceleration)
    best = 2 / start + optimum_s(inner, (ticks - 2, 0, 0), None)
    assert duration_s([block]) <= best * 1.02
    rates = 1 / intervals_s(block)
    assert max(rates[0], rates[-1]) <= start * 1.001
