"""Planning for any number of axes: what a feed counts along, and the limits of each."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.config import Config
from fraese.machine import Axis, Machine
from fraese.planner.lines import plan_line
from fraese.planner.planner import Options, Planner
from fraese.planner.segments import Limits, ThreeLinear, limits_of
from tests.planner.motion import check_limits, duration_s, moving, run, total_steps, uneven


def machine_of(names: str) -> Machine:
    """Axes with these names; rotary ones with 100 steps a degree, linear ones 200 a mm."""
    changes = {"kind": "stepdir"}
    return Machine.from_config(
        Config.model_validate(
            {
                "card": changes,
                "axes": {"names": list(names), **{n: {"gear": "90"} for n in names if n in "abc"}},
            }
        )
    )


def way_time_s(names: str, to: tuple[float, ...], feed: float | None) -> float:
    """Duration of a move from zero, ramps left out: the planned top speed counts."""
    axes = machine_of(names)
    blocks = moving(run(Planner(axes, (0,) * len(names), Options()), [to], feed))
    assert total_steps(blocks) == axes.to_steps(to)
    fastest = min(piece.interval_q8 for block in blocks for piece in block.pieces)
    ticks = max(map(abs, axes.to_steps(to)))
    return ticks * fastest / 256 / 16e6


@pytest.mark.parametrize(
    ("names", "to", "feed", "seconds"),
    [
        ("x", (30.0,), 600.0, 3.0),
        ("xz", (3.0, -4.0), 60.0, 5.0),
        # Along X, Y, Z if any of them moves; the others follow.
        ("xyza", (3.0, 4.0, 0.0, 10.0), 60.0, 5.0),
        ("xyza", (3.0, 4.0, 0.0, -100.0), 60.0, 5.0),
        # Else along U, V, W; else degrees a minute.
        ("xuva", (0.0, 3.0, 4.0, 50.0), 60.0, 5.0),
        ("xyza", (0.0, 0.0, 0.0, 90.0), 900.0, 6.0),
        ("ab", (30.0, 40.0), 600.0, 5.0),
        # No axis above its own rate: 4000 steps/s are 40 degrees a second here.
        ("xyza", (0.01, 0.0, 0.0, 80.0), 600.0, 2.0),
        ("xyza", (0.001, 0.0, 0.0, 80.0), 600.0, 2.0),
        ("xyza", (3.0, 0.0, 0.0, 80.0), None, 2.0),
        ("a", (80.0,), None, 2.0),
    ],
)
def test_a_feed_is_along_the_first_group_that_moves(
    names: str, to: tuple[float, ...], feed: float | None, seconds: float
) -> None:
    assert way_time_s(names, to, feed) == pytest.approx(seconds, rel=0.01)
    axes = machine_of(names)
    lone = plan_line(axes, axes.to_steps(to), feed)
    assert lone is not None
    if seconds >= 3:
        cruise_s = min(piece.interval_q8 for piece in lone.pieces) / 256 / 16e6
        assert cruise_s * lone.ticks() == pytest.approx(seconds, rel=0.01)


def test_a_feed_in_small_pieces_keeps_its_meaning() -> None:
    """Pieces in which X makes no step are still along X: the whole takes as long as in one go."""
    axes = machine_of("xa")
    count = 400
    points = [(0.8 * k / count, 8.0 * k / count) for k in range(1, count + 1)]
    assert abs(points[0][0]) < axes.axes[0].step_mm / 2
    # min_block_s would slow down such short pieces.
    options = Options(min_block_s=0)
    blocks = run(Planner(axes, (0, 0), options), points, 12.0)
    assert total_steps(blocks) == axes.to_steps(points[-1])
    assert duration_s(blocks) == pytest.approx(4.0, rel=0.02)
    check_limits(axes.axes, blocks)


def test_arcs_take_the_other_axes_along_evenly() -> None:
    axes = machine_of("zaxy")
    start = (0.0, 0.0, 10.0, 0.0)
    planner = Planner(axes, axes.to_steps(start), Options())
    blocks = list(planner.arc((-2.0, 36.0, -10.0, 0.0), (0.0, 0.0), 17, 1, 600.0))
    blocks += planner.finish()
    assert planner.position_steps == axes.to_steps((-2.0, 36.0, -10.0, 0.0))
    check_limits(axes.axes, blocks)
    at = np.array(axes.to_steps(start)) + np.cumsum([b.steps for b in blocks], axis=0)
    z_mm, a_deg, x_mm, y_mm = (at * [axis.step_mm for axis in axes.axes]).T
    assert np.hypot(x_mm, y_mm) == pytest.approx(10.0, abs=0.02)
    turned = np.arctan2(y_mm, x_mm) % (2 * np.pi)
    assert a_deg == pytest.approx(36.0 * turned / np.pi, abs=0.1)
    assert z_mm == pytest.approx(-2.0 * turned / np.pi, abs=0.02)


def test_an_arc_needs_both_axes_of_its_plane() -> None:
    planner = Planner(machine_of("xz"), (0, 0), Options())
    assert list(planner.arc((5.0, 5.0), (0.0, 5.0), 18, 1, 600.0)) is not None
    planner = Planner(machine_of("xz"), (0, 0), Options())
    with pytest.raises(ValueError, match="both its axes"):
        planner.arc((5.0, 5.0), (0.0, 5.0), 17, 1, 600.0)


def test_points_are_merged_only_while_no_other_axis_moves() -> None:
    axes = machine_of("xya")
    planner = Planner(axes, (0, 0, 0), Options())
    planner.path_control("G64", 0.01)
    still = [(float(k), 0.0, 0.0) for k in range(1, 11)]
    turning = [(10.0 + k, 0.0, 5.0 * k) for k in range(1, 4)]
    blocks = moving(run(planner, [*still, *turning], 6000.0))
    assert blocks[0].steps == (2000, 0, 0)
    assert [block.steps for block in blocks[1:]] == [(200, 0, 500)] * 3


def test_a_dwell_is_one_of_all_axes() -> None:
    planner = Planner(machine_of("xyza"), (0, 0, 0, 0), Options())
    assert [block.steps for block in planner.dwell(1.0)] == [(0, 0, 0, 0)]


# --- any machine -------------------------------------------------------------------------------

_AXIS: st.SearchStrategy[dict[str, Any]] = st.fixed_dictionaries(
    {
        "steps_per_mm": st.fractions(1, 2000, max_denominator=40),
        "motor_sign": st.sampled_from((1, -1)),
        "max_rate_hz": st.floats(1000, 6000),
        "start_rate_hz": st.floats(100, 1000),
        "acceleration_hz_s": st.floats(2000, 80_000),
        "backlash_steps": st.integers(0, 9),
    }
)


@st.composite
def machines(draw: st.DrawFn) -> Machine:
    names = draw(st.lists(st.sampled_from("xyzabcuvw"), min_size=1, max_size=4, unique=True))
    usual = Machine.from_config(Config()).axes[0]
    return Machine(tuple(replace(usual, name=name, **draw(_AXIS)) for name in names))


@given(machines(), st.data())
def test_every_axis_keeps_its_limits_and_arrives(axes: Machine, data: st.DataObject) -> None:
    count = len(axes.axes)
    point = st.tuples(*[st.floats(-5, 5).map(lambda mm: round(mm, 3))] * count)
    points = data.draw(st.lists(point, min_size=1, max_size=8))
    feed = data.draw(st.one_of(st.none(), st.floats(30, 5000)))
    start = (0,) * count
    planner = Planner(axes, start, Options())
    blocks = run(planner, points, feed)
    assert planner.position_steps == axes.to_steps(points[-1])
    check_limits(axes.axes, blocks)


@given(
    st.tuples(*[st.integers(-400, 400)] * 3).filter(any),
    st.tuples(*[st.integers(-400, 400)] * 3).filter(any),
    st.tuples(*[st.floats(-0.002, 0.002)] * 3),
    st.sampled_from(("xyz", "yxz", "uvw", "abc")),
)
def test_what_is_written_out_for_three_axes_gives_the_very_numbers(
    one: tuple[int, ...], other: tuple[int, ...], off: tuple[float, ...], names: str
) -> None:
    axes = Machine(
        tuple(replace(axis, name=name) for axis, name in zip(uneven().axes, names, strict=True))
    )
    quick, plain = limits_of(axes, 0.5), Limits(axes, 0.5)
    assert type(quick) is ThreeLinear
    way = tuple(mm + by for mm, by in zip(axes.to_mm(one), off, strict=True))
    pair = []
    for limits in (quick, plain):
        before = limits.segment(one, way, 10.0, 50.0, None, 1)
        after = limits.segment(other, None, math.inf, math.inf, None, 2)
        pair.append((before, after, limits.corner_mm2_s2(before, after)))
    assert pair[0] == pair[1]


def test_one_axis_of_many_steps_is_not_measured_by_a_way_of_nothing() -> None:
    """Speeds stay numbers, and energies that a block can carry."""
    fine = Axis(
        "a", Fraction(1000), 1, -math.inf, math.inf, math.inf, -1, 20_000, 2000, 200_000,
        kind="rotary", unit="°", has_switches=False,
    )  # fmt: skip
    axes = Machine((machine_of("x").axes[0], fine))
    blocks = moving(run(Planner(axes, (0, 0), Options()), [(0.005, 360.0)], 600.0))
    assert total_steps(blocks) == (1, 360_000)
    assert all(block.weight >= 40 for block in blocks)
    assert duration_s(blocks) == pytest.approx(360_000 / 20_000, rel=0.02)
