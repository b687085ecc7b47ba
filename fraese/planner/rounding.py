"""Millimetres to steps in floats, with the very result of exact fractions.

``Axis.to_steps`` is the law: floor(x * k + 1/2) without rounding anywhere. Fractions cost some
3 us a coordinate; a float product is wrong by less than 1e-6 steps as long as the result is
below a thousand million steps, so only what falls that close to a boundary needs the law itself.
"""

import math
from collections.abc import Callable
from typing import Final

from fraese.machine import Axis

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
