from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Block, steps_done
from fraese.config import Config
from fraese.errors import ConfigError
from fraese.machine import Machine
from fraese.planner.backlash import Carriages, followed, take_up
from fraese.planner.planner import Options, Planner
from tests.planner.motion import check_limits, duration_s, machine, run, total_steps

LASH = machine(backlash_steps=9)
MIXED = Machine(
    tuple(
        replace(axis, backlash_steps=lash, motor_sign=sign)
        for axis, lash, sign in zip(machine().axes, (5, 0, 12), (1, 1, -1), strict=True)
    )
)
POINTS = st.lists(
    st.tuples(*[st.floats(-3, 3).map(lambda mm: round(mm, 2))] * 3), min_size=1, max_size=15
)


@given(st.integers(0, 20), st.lists(st.integers(-30, 30), max_size=20))
def test_the_carriage_follows_with_play_and_stays_within_it(
    backlash: int, turns: list[int]
) -> None:
    slack = motor = carriage = 0
    for turn in turns:
        moved, slack = followed(slack, backlash, turn)
        motor, carriage = motor + turn, carriage + moved
        assert slack == carriage - motor
        assert 0 <= slack <= backlash
        assert moved * turn >= 0


@given(st.integers(0, 20), st.integers(0, 20), st.sampled_from([1, -1]), st.integers(0, 50))
def test_after_the_take_up_every_motor_step_is_a_step(
    backlash: int, slack: int, direction: int, steps: int
) -> None:
    slack = min(slack, backlash)
    extra = take_up(slack, backlash, direction)
    moved, after = followed(slack, backlash, extra)
    assert moved == 0
    assert followed(after, backlash, direction * steps)[0] == direction * steps


def in_halves(block: Block) -> Sequence[tuple[int, ...]]:
    """A block in two parts, as it is seen when somebody looks in the middle."""
    ticks = block.ticks()
    half = tuple((1 if n > 0 else -1) * steps_done(abs(n), ticks, ticks // 2) for n in block.steps)
    return half, tuple(n - m for n, m in zip(block.steps, half, strict=True))


@given(st.sampled_from([LASH, MIXED]), POINTS)
def test_every_target_is_reached_by_the_carriages_whatever_the_motors_do(
    axes: Machine, points: list[tuple[float, float, float]]
) -> None:
    planner = Planner(axes, (0, 0, 0), Options())
    carriages = Carriages(axes, (0, 0, 0))
    for point in points:
        for block in [*planner.line(point, 900.0), *planner.drain()]:
            half, rest = in_halves(block)
            seen = carriages.seen(half)
            carriages.advance(half)
            assert carriages.position_steps == seen
            carriages.advance(rest)
        assert carriages.position_steps == axes.to_steps(point) == planner.position_steps
        assert carriages.slack_steps == planner.slack_steps


@given(st.sampled_from([LASH, MIXED]), POINTS)
def test_no_limit_is_broken_by_taking_up(
    axes: Machine, points: list[tuple[float, float, float]]
) -> None:
    check_limits(axes.axes, run(Planner(axes, (0, 0, 0), Options()), points, 900.0))


def test_the_path_is_not_bent() -> None:
    planner = Planner(LASH, (0, 0, 0), Options())
    blocks = run(planner, [(5.0, 2.0, 0.0), (10.0, 0.0, 0.0)], 600.0)
    assert [block.steps for block in blocks] == [(1000, 400, 0), (0, -9, 0), (1000, -400, 0)]
    assert total_steps(blocks) == (2000, -9, 0)


def test_the_slack_can_be_known_beforehand() -> None:
    planner = Planner(LASH, (0, 0, 0), Options(), slack_steps=(9, 4, 0))
    blocks = run(planner, [(-1.0, -1.0, 1.0)], 600.0)
    assert [block.steps for block in blocks] == [(0, -5, 0), (-200, -200, 200)]


def test_without_backlash_nothing_is_inserted_and_the_motor_is_the_axis() -> None:
    axes = machine()
    blocks = run(Planner(axes, (0, 0, 0), Options()), [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0)], 600.0)
    assert [block.steps[0] for block in blocks] == [200, -200]
    carriages = Carriages(axes, (7, 8, 9))
    carriages.advance((1, -2, 3))
    assert carriages.position_steps == (8, 6, 12)


def test_taking_up_costs_little_time() -> None:
    points = [(k * 0.1, 2.0 * float(np.sin(k * 0.05)), 0.0) for k in range(400)]
    plain = duration_s(run(Planner(machine(), (0, 0, 0), Options()), points, 600.0))
    lash = duration_s(run(Planner(LASH, (0, 0, 0), Options()), points, 600.0))
    reversals = 6
    assert plain < lash < plain + reversals * 0.2


def test_backlash_is_configured_in_millimetres_and_made_up_for_in_whole_steps() -> None:
    config = Config.model_validate({"axes": {"y": {"backlash_mm": Decimal("0.043")}}})
    axes = Machine.from_config(config).axes
    assert [axis.backlash_steps for axis in axes] == [0, 9, 0]
    assert axes[1].steps_per_mm == Fraction(200)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("backlash_mm", -1),
        ("backlash_mm", 11),
        ("avoid_hz", [[500, 300]]),
        ("avoid_hz", [[0, 300]]),
        ("avoid_hz", [300]),
    ],
)
def test_nonsense_in_the_configuration_is_refused(key: str, value: object) -> None:
    from fraese.config.file import from_table

    with pytest.raises(ConfigError, match=key):
        from_table({"axes": {"x": {key: value}}}, "test")


def test_bands_and_options_come_from_the_configuration() -> None:
    config = Config.model_validate(
        {
            "axes": {"x": {"avoid_hz": [[300, 450]]}},
            "planner": {"min_block_ms": 2, "window": 50, "chord_tolerance_mm": 0.01},
        }
    )
    assert Machine.from_config(config).axes[0].avoid_hz == ((300, 450),)
    options = Options.from_config(config.planner, rate_factor=0.5)
    assert options == Options(0.01, 0.002, 0.05, 50, rate_factor=0.5)
