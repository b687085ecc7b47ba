import math
from dataclasses import replace
from fractions import Fraction

from hypothesis import example, given
from hypothesis import strategies as st

from fraese.config import Config
from fraese.machine import Axis, Machine
from fraese.planner.rounding import rounder

AXIS = Machine.from_config(Config()).axes[0]
RATIOS = [Fraction(200), Fraction(400, 3), Fraction(1000), Fraction(320, 7), Fraction(1, 3)]


def axes() -> st.SearchStrategy[Axis]:
    return st.sampled_from(RATIOS).map(lambda ratio: replace(AXIS, steps_per_mm=ratio))


@given(axes(), st.floats(allow_nan=False, allow_infinity=False))
@example(AXIS, 0.0025)
@example(AXIS, -0.0025)
@example(AXIS, 1e300)
def test_any_float_is_rounded_as_the_fraction_is(axis: Axis, position_mm: float) -> None:
    assert rounder(axis)(position_mm) == axis.to_steps(position_mm)


@given(axes(), st.integers(-(10**7), 10**7), st.integers(-3, 3))
def test_so_is_every_float_next_to_half_a_step(axis: Axis, step: int, away: int) -> None:
    position_mm = float((step + Fraction(1, 2)) / axis.steps_per_mm)
    position_mm += away * abs(position_mm) * 2**-53
    assert rounder(axis)(position_mm) == axis.to_steps(position_mm)


@given(axes(), st.integers(-(10**6), 10**6))
def test_and_every_decimal_a_program_can_hold(axis: Axis, number: int) -> None:
    assert rounder(axis)(number / 10_000) == axis.to_steps(number / 10_000)


def test_where_the_float_product_lands_on_the_wrong_side() -> None:
    """Floats next to half a step, of which some are rounded over it by the product."""
    wrong = 0
    for ratio in RATIOS:
        axis = replace(AXIS, steps_per_mm=ratio)
        to_steps, steps_per_mm = rounder(axis), float(ratio)
        for step in range(-3000, 3000, 7):
            position_mm = float((step + Fraction(1, 2)) / ratio)
            for near_mm in (math.nextafter(position_mm, -math.inf), position_mm):
                assert to_steps(near_mm) == axis.to_steps(near_mm)
                wrong += math.floor(near_mm * steps_per_mm + 0.5) != axis.to_steps(near_mm)
    assert wrong > 100
