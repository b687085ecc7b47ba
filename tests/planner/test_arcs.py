import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Block
from fraese.planner.arcs import PLANES, Point, arc_shape
from fraese.planner.planner import Options, Planner
from tests.planner.motion import check_limits, duration_s, machine, total_steps, uneven

TOLERANCE_MM = 0.005
RADII = st.floats(0.05, 60)
ANGLES = st.floats(-3.1, 3.1)
TURNS = st.sampled_from([1, -1, 2, -3])


def on_circle(plane: int, radius: float, angle: float, height: float) -> Point:
    point = [0.0, 0.0, 0.0]
    first, second = PLANES[plane]
    third = 3 - first - second
    point[first], point[second] = radius * math.cos(angle), radius * math.sin(angle)
    point[third] = height
    return point[0], point[1], point[2]


@given(st.sampled_from([17, 18, 19]), RADII, ANGLES, ANGLES, st.floats(-5, 5), TURNS)
def test_chords_stay_within_the_tolerance_and_are_as_few_as_can_be(
    plane: int, radius: float, begin: float, end: float, climb: float, turns: int
) -> None:
    start, to = on_circle(plane, radius, begin, 0.0), on_circle(plane, radius, end, climb)
    shape = arc_shape(start, to, (0.0, 0.0), plane, turns)
    corners = np.array([start, *shape.corners(TOLERANCE_MM)])
    first, second = PLANES[plane]
    third = 3 - first - second
    flat = corners[:, [first, second]]
    assert np.allclose(np.hypot(*flat.T), radius, rtol=1e-9)
    middle = (flat[1:] + flat[:-1]) / 2
    sagitta = radius - np.hypot(*middle.T)
    assert sagitta.max() <= TOLERANCE_MM * (1 + 1e-6)
    assert tuple(corners[-1]) == to
    # One chord fewer would be too few.
    fewer = abs(shape.sweep_rad) / (len(corners) - 2) if len(corners) > 2 else math.inf
    assert fewer > math.pi / 3 - 1e-6 or radius * (1 - math.cos(fewer / 2)) > TOLERANCE_MM * 0.999
    heights = np.diff(corners[:, third])
    assert np.allclose(heights, heights.mean(), atol=1e-9)


@given(st.sampled_from([17, 18, 19]), ANGLES, ANGLES, TURNS)
def test_the_sweep_goes_the_right_way_round_so_many_times(
    plane: int, begin: float, end: float, turns: int
) -> None:
    start, to = on_circle(plane, 10, begin, 0.0), on_circle(plane, 10, end, 0.0)
    sweep = arc_shape(start, to, (0.0, 0.0), plane, turns).sweep_rad
    assert math.copysign(1, sweep) == math.copysign(1, turns)
    assert (abs(turns) - 1) * 2 * math.pi < abs(sweep) <= abs(turns) * 2 * math.pi + 1e-6
    assert math.cos(begin + sweep) == pytest.approx(math.cos(end), abs=1e-6)
    assert math.sin(begin + sweep) == pytest.approx(math.sin(end), abs=1e-6)


@pytest.mark.parametrize(("plane", "axes"), [(17, "xy"), (18, "zx"), (19, "yz")])
def test_counter_clockwise_goes_from_the_first_axis_to_the_second(plane: int, axes: str) -> None:
    start, to = on_circle(plane, 5, 0.0, 0.0), on_circle(plane, 5, math.pi / 2, 0.0)
    corners = list(arc_shape(start, to, (0.0, 0.0), plane, 1).corners(TOLERANCE_MM))
    assert all(corner["xyz".index(name)] > -1e-9 for corner in corners for name in axes)
    assert start["xyz".index(axes[0])] == to["xyz".index(axes[1])] == 5


@pytest.mark.parametrize("turns", [1, -1, 3])
def test_an_end_at_the_start_is_a_full_turn(turns: int) -> None:
    shape = arc_shape((10.0, 0.0, 0.0), (10.0, 1e-9, -2.0), (0.0, 0.0), 17, turns)
    assert abs(shape.sweep_rad) == pytest.approx(abs(turns) * 2 * math.pi, rel=1e-6)


def test_unequal_radii_become_a_spiral_to_the_exact_end() -> None:
    shape = arc_shape((10.0, 0.0, 0.0), (0.0, 10.004, 0.0), (0.0, 0.0), 17, 1)
    corners = list(shape.corners(TOLERANCE_MM))
    assert corners[-1] == (0.0, 10.004, 0.0)
    assert (np.diff([math.hypot(*corner[:2]) for corner in corners]) > 0).all()


@pytest.mark.parametrize(("plane", "turns"), [(17, 0), (16, 1)])
def test_nonsense_is_refused(plane: int, turns: int) -> None:
    with pytest.raises(ValueError, match="plane 17, 18 or 19"):
        arc_shape((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0), plane, turns)


def play_arc(planner: Planner, *arc: object) -> list[Block]:
    return [*planner.arc(*arc), *planner.finish()]  # type: ignore[arg-type]


@given(st.sampled_from([17, 18, 19]), st.floats(0.05, 8), ANGLES, TURNS)
def test_planned_arcs_keep_limits_end_exactly_and_stay_near_the_circle(
    plane: int, radius: float, end: float, turns: int
) -> None:
    axes = uneven()
    start, to = on_circle(plane, radius, 0.0, 0.0), on_circle(plane, radius, end, 0.7)
    planner = Planner(axes, axes.to_steps(start), Options())
    planner.line(start)
    blocks = play_arc(planner, to, (0.0, 0.0), plane, turns, 900.0)
    check_limits(axes.axes, blocks)
    signs = [axis.motor_sign for axis in axes.axes]
    moved = [b - a for a, b in zip(axes.to_steps(start), axes.to_steps(to), strict=True)]
    assert total_steps(blocks) == tuple(s * n for s, n in zip(signs, moved, strict=True))
    at = np.array(axes.to_steps(start)) + np.cumsum([b.steps for b in blocks], axis=0) * signs
    first, second = PLANES[plane]
    step_mm = np.array([axis.step_mm for axis in axes.axes])
    off = np.hypot(*(at * step_mm)[:, [first, second]].T) - radius
    assert np.abs(off).max() <= math.hypot(step_mm[first], step_mm[second])


def test_a_tight_arc_is_driven_no_faster_than_its_curve_allows() -> None:
    axes = machine()
    radius = 0.9
    planner = Planner(axes, axes.to_steps((radius, 0.0, 0.0)), Options())
    blocks = play_arc(planner, (radius, 0.0, 0.0), (0.0, 0.0), 17, 8, 1200.0)
    inside = blocks[20:-20]
    length_mm = sum(math.hypot(*block.steps) / 200 for block in inside)
    fastest = math.sqrt(20_000 / 200 * radius)
    assert length_mm / duration_s(inside) == pytest.approx(fastest, rel=0.02)
    assert (
        max(math.hypot(*block.steps) / 200 / duration_s([block]) for block in inside)
        <= fastest * 1.001
    )


def test_a_wide_arc_keeps_the_feed() -> None:
    axes = machine()
    planner = Planner(axes, axes.to_steps((50.0, 0.0, 0.0)), Options())
    blocks = play_arc(planner, (50.0, 0.0, 0.0), (0.0, 0.0), 17, -1, 600.0)
    assert duration_s(blocks) == pytest.approx(2 * math.pi * 50 / 10, rel=0.01)


def test_a_helix_of_a_thousand_turns_is_a_stream() -> None:
    axes = machine()
    planner = Planner(axes, axes.to_steps((5.0, 0.0, 0.0)), Options())
    stream = planner.arc((5.0, 0.0, -50.0), (0.0, 0.0), 17, 10_000, 600.0)
    for _, block in zip(range(2000), stream, strict=False):
        assert any(block.steps)
        assert planner.pending <= 232


def test_an_arc_that_was_not_taken_is_not_lost_in_silence() -> None:
    planner = Planner(machine(), (1000, 0, 0), Options())
    planner.arc((0.0, 5.0, 0.0), (0.0, 0.0), 17, 1, 600.0)
    with pytest.raises(RuntimeError, match="not taken"):
        planner.line((0.0, 0.0, 0.0))
