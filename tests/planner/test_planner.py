import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import (
    Block,
    Outputs,
    Watch,
    WatchAction,
    accel_q_from_hz_s,
    rate_q8_from_hz,
)
from fraese.machine import Machine
from fraese.planner.lines import line_limits, plan_line
from fraese.planner.planner import Options, PathMode, Planner
from tests.planner.motion import (
    Point,
    axis_rates_hz,
    check_limits,
    duration_s,
    intervals_s,
    machine,
    moving,
    run,
    total_steps,
    uneven,
)

MACHINES = [machine(), uneven(), machine(acceleration_hz_s=2000.0, start_rate_hz=100.0)]
START = (0, 0, 0)


def planner(axes: Machine, **options: object) -> Planner:
    return Planner(axes, START, Options(**options))  # type: ignore[arg-type]


def coordinates(widest_mm: float) -> st.SearchStrategy[float]:
    return st.floats(-widest_mm, widest_mm).map(lambda value: round(value, 4))


@st.composite
def paths(draw: st.DrawFn) -> list[Point]:
    """Random walks with steps of very different size, often straight on or back."""
    points, at, way = [], (0.0, 0.0, 0.0), (0.1, 0.0, 0.0)
    for _ in range(draw(st.integers(1, 40))):
        if draw(st.integers(0, 2)) == 0:
            widest = draw(st.sampled_from([0.004, 0.05, 0.3, 2.0, 20.0]))
            x, y, z = (draw(coordinates(widest)) for _ in range(3))
            way = (x, y, z)
        factor = draw(st.sampled_from([1.0, 1.0, 1.0, -1.0, 0.3]))
        at = tuple(a + factor * b for a, b in zip(at, way, strict=True))  # type: ignore[assignment]
        points.append(at)
    return points


FEEDS = st.sampled_from([None, 30.0, 200.0, 900.0, 3000.0])


def signed(axes: Machine, steps: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(n * axis.motor_sign for n, axis in zip(steps, axes.axes, strict=True))


@given(st.sampled_from(MACHINES), paths(), FEEDS)
def test_no_limit_is_broken_and_no_step_is_lost(
    axes: Machine, points: list[Point], feed: float | None
) -> None:
    blocks = run(planner(axes), points, feed)
    check_limits(axes.axes, blocks)
    if blocks:
        assert total_steps(blocks) == signed(axes, axes.to_steps(points[-1]))
        assert blocks[-1].ends_at_rest
    assert all(any(block.steps) for block in blocks)
    assert all(block.ticks() == max(map(abs, block.steps)) for block in blocks)


@given(st.sampled_from(MACHINES), paths(), st.lists(st.integers(0, 7), max_size=40))
def test_nor_with_everything_that_can_come_in_between(
    axes: Machine, points: list[Point], whims: list[int]
) -> None:
    plan = planner(axes, window=8)
    blocks: list[Block] = []
    actions: dict[int, Callable[[], Sequence[Block] | None]] = {
        1: plan.drain,
        2: plan.ready,
        3: lambda: plan.set_override(0.1),
        4: lambda: plan.set_override(2.0),
        5: lambda: plan.path_control(PathMode.EXACT_STOP),
        6: lambda: plan.path_control("G61"),
        7: lambda: plan.dwell(0.01),
    }
    whims += [0] * len(points)
    for point, whim in zip(points, whims, strict=False):
        blocks += plan.line(point, 800.0)
        if whim in actions:
            blocks += actions[whim]() or ()
    blocks += plan.finish()
    check_limits(axes.axes, blocks)
    if moving(blocks):
        assert total_steps(blocks) == signed(axes, axes.to_steps(points[-1]))


@given(paths(), FEEDS)
def test_wherever_it_is_cut_off_what_is_final_can_be_stopped_within(
    points: list[Point], feed: float | None
) -> None:
    axes = machine()
    plan = planner(axes)
    blocks: list[Block] = []
    for point in points:
        blocks += plan.line(point, feed)
        assert plan.pending <= 200 + 32
    check_limits(axes.axes, blocks + list(plan.drain()))


def test_a_straight_line_in_small_pieces_is_as_fast_as_in_one() -> None:
    axes = machine()
    end = (60.0, 37.0, 11.0)
    whole = duration_s(run(planner(axes), [end], 900.0))
    pieces = [tuple(k / 400 * a for a in end) for k in range(1, 401)]
    cut = duration_s(run(planner(axes), pieces, 900.0))
    assert cut == pytest.approx(whole, rel=0.01)


def test_long_lines_are_cut_in_time_but_not_slowed_down() -> None:
    axes = machine()
    blocks = run(planner(axes, max_block_s=0.5), [(200.0, 33.33, 7.0)], 600.0)
    assert 38 <= len(blocks) <= 44
    whole = run(planner(axes, max_block_s=100.0), [(200.0, 33.33, 7.0)], 600.0)
    assert len(whole) == 1
    assert duration_s(blocks) == pytest.approx(duration_s(whole), rel=1e-3)
    assert total_steps(blocks) == total_steps(whole)


def test_a_right_angle_is_passed_at_the_start_rate_a_straight_one_at_full_rate() -> None:
    axes = machine()
    corner = run(planner(axes), [(10.0, 0.0, 0.0), (10.0, 10.0, 0.0)], 1200.0)
    assert 1 / intervals_s(corner[0])[-1] == pytest.approx(800, rel=0.03)
    straight = run(planner(axes), [(10.0, 0.0, 0.0), (20.0, 0.0, 0.0)], 1200.0)
    assert 1 / intervals_s(straight[0])[-1] == pytest.approx(4000, rel=0.01)


def test_turning_back_divides_the_start_rate_between_both_sides() -> None:
    blocks = run(planner(machine()), [(10.0, 0.0, 0.0), (0.0, 0.0, 0.0)], 1200.0)
    assert 1 / intervals_s(blocks[0])[-1] == pytest.approx(400, rel=0.06)
    assert 1 / intervals_s(blocks[1])[0] == pytest.approx(400, rel=0.06)


def test_exact_stop_never_passes_a_corner_above_the_start_rate() -> None:
    plan = planner(machine())
    plan.path_control(PathMode.EXACT_STOP)
    blocks = run(plan, [(k * 5.0, 0.0, 0.0) for k in range(1, 5)], 1200.0)
    assert len(blocks) == 4
    assert all(block.ends_at_rest for block in blocks)


def test_many_short_lines_round_a_small_circle_keep_to_the_acceleration_of_the_axes() -> None:
    axes = machine()
    radius_mm, count = 0.8, 60
    circle = [
        (
            radius_mm * math.sin(2 * math.pi * k / count),
            radius_mm * (1 - math.cos(2 * math.pi * k / count)),
            0.0,
        )
        for k in range(1, 6 * count)
    ]
    blocks = run(planner(axes), circle, 1200.0)
    inward_mm_s2 = 20_000 / 200
    fastest = math.sqrt(inward_mm_s2 * radius_mm)
    speeds = [math.hypot(*block.steps) / 200 / duration_s([block]) for block in blocks[100:200]]
    # Each axis has its own limit: on the diagonal two share the turn.
    assert fastest * 0.97 <= np.mean(speeds) <= fastest * 2**0.25


def test_less_than_a_step_is_kept_for_later() -> None:
    points = [(k * 0.0009, 0.0, 0.0) for k in range(1, 1001)]
    blocks = run(planner(machine()), points, 300.0)
    assert total_steps(blocks) == (180, 0, 0)
    assert all(block.steps[0] > 0 for block in blocks)


def test_short_segments_are_slowed_down_but_not_a_single_one() -> None:
    axes = machine()
    tiny = [(k * 0.02, 0.0, 0.0) for k in range(1, 400)]
    blocks = run(planner(axes, min_block_s=0.004), tiny, 1200.0)
    assert duration_s(blocks[100:200]) >= 100 * 0.004 * 0.999
    single = [(10.0, 0.0, 0.0), (10.01, 0.0, 0.0), (20.0, 0.0, 0.0)]
    assert duration_s(run(planner(axes), single, 1200.0)) == pytest.approx(
        duration_s(run(planner(axes), [(20.0, 0.0, 0.0)], 1200.0)), rel=1e-3
    )


def test_first_motion_does_not_wait_for_the_end() -> None:
    plan = planner(machine())
    for k in range(1, 200):
        if plan.line((k * 0.1, 0.0, 0.0), 600.0):
            break
    assert k < 80


def test_drain_gives_all_and_goes_on_from_rest() -> None:
    axes = machine()
    plan = planner(axes)
    blocks = list(plan.line((3.0, 0.0, 0.0), 1200.0)) + list(plan.drain())
    assert total_steps(blocks) == (600, 0, 0)
    assert blocks[-1].ends_at_rest
    assert not plan.pending
    blocks += run(plan, [(0.0, 0.0, 0.0)], 1200.0)
    check_limits(axes.axes, blocks)
    assert total_steps(blocks) == (0, 0, 0)


def test_an_override_acts_on_what_is_not_final() -> None:
    axes = machine()
    times = []
    for factor in (1.0, 0.5, 2.0):
        plan = planner(axes)
        plan.set_override(factor)
        times.append(duration_s(run(plan, [(100.0, 0.0, 0.0)], 300.0)))
    assert times[1] == pytest.approx(2 * times[0], rel=0.01)
    assert times[2] == pytest.approx(times[0] / 2, rel=0.01)
    rapid = planner(axes)
    rapid.set_override(0.1)
    assert duration_s(run(rapid, [(50.0, 0.0, 0.0)], None)) < 3


@pytest.mark.parametrize("factor", [0.0, 0.09, 2.1, float("nan")])
def test_an_override_has_bounds(factor: float) -> None:
    with pytest.raises(ValueError, match=r"0\.1 to 2"):
        planner(machine()).set_override(factor)


@pytest.mark.parametrize("feed", [0.0, -1.0, float("nan")])
def test_a_feed_is_positive(feed: float) -> None:
    with pytest.raises(ValueError, match="positive"):
        planner(machine()).line((1.0, 0.0, 0.0), feed)


def test_a_machine_that_is_not_referenced_runs_at_part_of_its_rates() -> None:
    axes = machine()
    for feed in (None, 600.0):
        full = duration_s(run(planner(axes), [(100.0, 0.0, 0.0)], feed))
        part = duration_s(run(planner(axes, rate_factor=0.5), [(100.0, 0.0, 0.0)], feed))
        assert part == pytest.approx(2 * full, rel=0.03)


@pytest.mark.parametrize("feed", [None, 90.0, 150.0, 290.0, 600.0])
def test_no_rate_is_kept_within_a_band_to_avoid(feed: float | None) -> None:
    axes = machine(avoid_hz=((250.0, 420.0), (900.0, 1100.0)))
    for block in run(planner(axes), [(30.0, 11.0, 0.0), (60.0, 16.0, 4.0)], feed):
        rates = np.abs(axis_rates_hz(block))
        flat = np.concatenate([[piece.add_q8 == 0] * piece.ticks for piece in block.pieces])
        longest = max(piece.ticks for piece in block.pieces)
        if longest > 50:
            kept = rates[flat & (intervals_s(block) == intervals_s(block).min())]
            for low, high in axes.axes[0].avoid_hz:
                assert not ((kept > low * 1.001) & (kept < high * 0.999)).any()


@pytest.mark.parametrize("feed", [None, 90.0, 150.0, 290.0, 600.0])
def test_nor_on_a_line_by_hand(feed: float | None) -> None:
    axes = machine(avoid_hz=((250.0, 420.0), (900.0, 1100.0)))
    for steps in ((6000, 0, 0), (6000, 2200, 0), (2200, -6000, 100)):
        block = plan_line(axes, steps, feed)
        assert block is not None
        kept = np.abs(axis_rates_hz(block))[intervals_s(block) == intervals_s(block).min()]
        assert len(kept) > 50
        for low, high in axes.axes[0].avoid_hz:
            assert not ((kept > low * 1.001) & (kept < high * 0.999)).any()


def test_outputs_ride_on_the_next_move_and_wait_for_nothing_else() -> None:
    plan = planner(machine())
    blocks = list(plan.line((1.0, 0.0, 0.0), 300.0))
    plan.outputs(1, 1)
    plan.outputs(2, 2)
    blocks += plan.line((2.0, 0.0, 0.0), 300.0)
    plan.outputs(3, 0)
    blocks += plan.finish()
    assert [block.outputs for block in blocks] == [None, Outputs(3, 3), Outputs(3, 0)]
    assert not blocks[0].ends_at_rest or blocks[0].duration_cycles()
    assert not any(blocks[2].steps)


def test_a_dwell_comes_after_rest_and_carries_outputs() -> None:
    plan = planner(machine())
    plan.line((1.0, 0.0, 0.0), 1200.0)
    plan.outputs(1, 1)
    blocks = plan.dwell(0.25, tag=7)
    assert blocks[-2].ends_at_rest
    assert duration_s(blocks[-1:]) == 0.25
    assert (blocks[-1].outputs, blocks[-1].tag) == (Outputs(1, 1), 7)


def test_a_watched_move_is_one_block_from_rest_to_rest() -> None:
    plan = planner(machine())
    plan.line((1.0, 0.0, 0.0), 1200.0)
    watch = Watch(0x80, 0, WatchAction.STOP)
    blocks = plan.watched((1.0, 0.0, -50.0), 100.0, watch)
    assert [block.watch for block in blocks] == [None, watch]
    assert blocks[0].ends_at_rest
    plan.reset((200, 0, -500))
    assert total_steps(run(plan, [(1.0, 0.0, 0.0)], 100.0)) == (0, 0, 500)


def test_merging_keeps_the_tolerance_and_saves_blocks() -> None:
    axes = machine()
    tolerance_mm = 0.01
    wave = [(k * 0.1, 0.5 * math.sin(k * 0.02), 0.0) for k in range(1, 600)]
    exact = run(planner(axes), wave, 600.0)
    plan = planner(axes)
    plan.path_control("G64", tolerance_mm)
    merged = run(plan, wave, 600.0)
    assert total_steps(merged) == total_steps(exact)
    assert len(merged) < len(exact) / 4
    corners = np.cumsum([(0, 0, 0)] + [block.steps for block in merged], axis=0) / 200
    for x_mm, y_mm, _ in wave:
        nearest = min(_distance(x_mm, y_mm, a, b) for a, b in pairwise(corners))
        assert nearest <= tolerance_mm + 0.0036


def _distance(x: float, y: float, a: np.ndarray, b: np.ndarray) -> float:
    way, off = b[:2] - a[:2], np.array([x, y]) - a[:2]
    along = min(1.0, max(0.0, float(off @ way / (way @ way))))
    return float(np.hypot(*(off - along * way)))


def test_a_corner_is_not_merged_away() -> None:
    plan = planner(machine())
    plan.path_control("G64", 0.01)
    square = [(1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0), (2.0, 2.0, 0.0)]
    assert [block.steps for block in run(plan, square, 300.0)] == [(400, 0, 0), (0, 400, 0)]


def test_memory_is_bounded() -> None:
    plan = planner(machine(acceleration_hz_s=500.0, start_rate_hz=10.0), window=20)
    most = 0
    for k in range(3000):
        plan.line((k * 0.1, 0.0, 0.0), 1200.0)
        most = max(most, plan.pending)
    assert most <= 20 + 32


@settings(max_examples=15)
@given(st.integers(0, 10**6))
def test_reports_carry_the_tags(seed: int) -> None:
    plan = planner(machine())
    blocks = list(plan.line((1.0, 0.0, 0.0), 300.0, seed)) + list(plan.finish())
    assert {block.tag for block in blocks} == {seed}


@given(st.sampled_from(MACHINES), paths(), FEEDS)
def test_blocks_say_what_a_throttle_must_know(
    axes: Machine, points: list[Point], feed: float | None
) -> None:
    for block in run(planner(axes), points, feed):
        limits = line_limits(axes, block.steps)
        assert block.accel_q == pytest.approx(
            accel_q_from_hz_s(limits.acceleration_hz_s), rel=1e-6, abs=1
        )
        assert block.jump_rate_q8 == pytest.approx(rate_q8_from_hz(limits.start_hz), abs=1)
        assert block.weight == pytest.approx(limits.weight, rel=1e-6, abs=1)
        leaves_hz = 1 / intervals_s(block)[-1]
        assert block.ends_at_rest == (leaves_hz <= limits.start_hz * (1 + 1e-6))


def test_after_a_dwell_motion_begins_from_a_real_standstill() -> None:
    first_ticks = []
    for pause_s in (0.0, 0.1):
        plan = planner(machine())
        plan.line((1.0, 0.0, 0.0), 1200.0)
        plan.dwell(pause_s)
        blocks = run(plan, [(0.0, 0.0, 0.0)], 1200.0)
        first_ticks.append(1 / intervals_s(blocks[0])[0])
    turning, standing = first_ticks
    assert turning < 200
    assert standing == pytest.approx(800, rel=1e-3)


def test_a_long_slow_line_is_planned_while_it_is_taken_and_an_override_acts_on_the_rest() -> None:
    plan = planner(machine())
    taken = []
    stream = iter(plan.line((100.0, 0.0, 0.0), 60.0))
    for block in stream:
        taken.append(block)
        assert plan.pending <= 40
        if len(taken) == 10:
            plan.set_override(2.0)
    taken += plan.finish()
    assert total_steps(taken) == (20_000, 0, 0)
    assert 10 + (100 - 10) / 2 < duration_s(taken) < 10 + (100 - 10) / 2 + 3


def test_blocks_that_were_not_taken_are_not_lost_in_silence() -> None:
    plan = planner(machine())
    plan.line((100.0, 0.0, 0.0), 60.0)
    with pytest.raises(RuntimeError, match="not taken"):
        plan.line((0.0, 0.0, 0.0), 60.0)
    with pytest.raises(RuntimeError, match="not taken"):
        plan.finish()
    plan.reset((0, 0, 0))
    assert total_steps(run(plan, [(1.0, 0.0, 0.0)], 60.0)) == (200, 0, 0)


def test_a_long_merged_line_comes_before_what_ended_it() -> None:
    plan = planner(machine())
    plan.path_control("G64", 0.01)
    points = [(10.0, 0.0, 0.0), (20.0, 0.0, 0.0), (20.0, 9.0, 0.0), (5.0, 9.0, 0.0)]
    blocks = run(plan, points[:2], 60.0)
    blocks += plan.line(points[2], 60.0)
    blocks += plan.line(points[3], None)
    blocks += plan.finish()
    corners = np.cumsum([block.steps for block in blocks], axis=0).tolist()
    wanted = [[4000, 0, 0], [4000, 1800, 0], [1000, 1800, 0]]
    assert [corner for corner in corners if corner in wanted] == wanted
    assert corners == sorted(corners, key=lambda at: (at[1], at[0] if at[1] == 0 else -at[0]))


@pytest.mark.parametrize("feed", [1e-3, 1e-9, 1e-300])
def test_a_feed_slower_than_anything_is_a_step_a_second(feed: float) -> None:
    blocks = run(planner(machine()), [(0.1, 0.0, 0.0)], feed)
    assert total_steps(blocks) == (20, 0, 0)
    assert 18 < duration_s(blocks) < 21


@pytest.mark.parametrize("mix_mm", [(0.01,), (0.01, 0.02, 1.0), (0.05, 0.01), (0.005, 5.0)])
def test_sixteen_blocks_in_a_row_take_their_time_whatever_their_mixture(
    mix_mm: tuple[float, ...],
) -> None:
    lengths_mm = [mix_mm[k * k % 7 % len(mix_mm)] for k in range(800)]
    points = [(x_mm, 0.0, 0.0) for x_mm in np.cumsum(lengths_mm).tolist()]
    blocks = run(planner(machine(), max_block_s=100.0, min_block_s=0.004), points, 1200.0)
    times = np.array([duration_s([block]) for block in blocks])
    means = np.convolve(times, np.ones(16) / 16, "valid")[8:]
    assert means.min() >= 0.8 * 0.004


def test_no_axis_is_accelerated_for_long_by_more_than_it_can_on_a_wavy_path() -> None:
    axes = machine()
    wave = [(k * 0.05, 0.6 * math.sin(k * 0.05 / 0.35), 0.0) for k in range(1, 900)]
    blocks = run(planner(axes), wave, 1200.0)
    steps = np.array([block.steps for block in blocks])
    times = np.array([duration_s([block]) for block in blocks])
    # Eight lines together: single ones are a few steps only, and rounding is most of them.
    steps = steps[: len(steps) // 8 * 8].reshape(-1, 8, 3).sum(axis=1)
    times = times[: len(times) // 8 * 8].reshape(-1, 8).sum(axis=1)
    rates = steps / times[:, None]
    change = np.abs(np.diff(rates, axis=0)) / ((times[1:] + times[:-1]) / 2)[:, None]
    # Along the path and across it at the same time: the root of two; and a step of rounding.
    assert np.quantile(change, 0.98) <= 20_000 * 2**0.5 * 1.1
    assert change.max() > 10_000
