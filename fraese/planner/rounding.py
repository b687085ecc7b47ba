"""Millimetres to steps in floats, with the very result of exact fractions.

``Axis.to_steps`` is the law: floor(x * k + 1/2) without rounding anywhere. Fractions cost some
3 us a coordinate; a float product is wrong by less than 1e-6 steps as long as the result is
below a thousand million steps, so only what falls that close to a boundary needs the law itself.
"""

import math
from collections.abc import Callable, Sequence
from typing import Final

from fraese.machine import Axis, Steps

_MARGIN_STEPS: Final = 1e-6
_REST_STEPS: Final = 1 - _MARGIN_STEPS
_FLOAT_LIMIT_STEPS: Final = 1e9


def rounder(axis: Axis) -> Callable[[float], int]:
    """A function equal to ``axis.to_steps`` for every float."""
    numerator, denominator = axis.steps_per_mm.as_integer_ratio()
    steps_per_mm = float(axis.steps_per_mm)
    floor = math.floor

    def exactly(position_mm: float) -> int:
        mm, parts = position_mm.as_integer_ratio()
        divisor = parts * denominator
        return (2 * mm * numerator + divisor) // (2 * divisor)

    def to_steps(position_mm: float) -> int:
        wanted = position_mm * steps_per_mm + 0.5
        if -_FLOAT_LIMIT_STEPS < wanted < _FLOAT_LIMIT_STEPS:
            whole = floor(wanted)
            if _MARGIN_STEPS < wanted - whole < _REST_STEPS:
                return whole
        return exactly(position_mm)

    return to_steps


def point_rounder(axes: Sequence[Axis]) -> Callable[[tuple[float, ...]], Steps]:
    """The same for points; written out for three axes, what most machines have."""
    rounders = [rounder(axis) for axis in axes]
    if len(rounders) != 3:
        return lambda point: tuple([each(mm) for each, mm in zip(rounders, point, strict=True)])
    to_x, to_y, to_z = rounders

    def three_to_steps(point: tuple[float, ...]) -> Steps:
        x_mm, y_mm, z_mm = point
        return to_x(x_mm), to_y(y_mm), to_z(z_mm)

    return three_to_steps
