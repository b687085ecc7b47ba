"""Corners of many short segments: what the path may do there, axis by axis."""

from hypothesis import example, given
from hypothesis import strategies as st

from fraese.machine import Machine, Steps
from fraese.planner.segments import UNLIMITED, Limits, Segment, start_rate_hz
from tests.planner.motion import machine, uneven

_MACHINES = (machine(), uneven(), machine(acceleration_hz_s=2000.0, start_rate_hz=100.0))


def segment(limits: Limits, steps: Steps) -> Segment:
    """A straight line of so many steps."""
    x, y, z = steps
    return limits.segment((x, y, z), None, UNLIMITED, UNLIMITED, None, 0)


def is_calm(axes: Machine, part: Segment, speed_mm_s: float) -> bool:
    """Every motor is at or below its start/stop rate: it needs no ramp at all."""
    duration_s = part.length_mm / speed_mm_s
    return all(
        abs(n) / duration_s <= start_rate_hz(axis) * (1 + 1e-9)
        for n, axis in zip(part.steps, axes.axes, strict=True)
    )


def can_turn(axes: Machine, before: Segment, after: Segment, speed_mm_s: float) -> bool:
    """From the middle of the one to the middle of the other no axis changes its rate too fast."""
    duration_s = (before.length_mm + after.length_mm) / 2 / speed_mm_s
    for was, now, axis in zip(before.steps, after.steps, axes.axes, strict=True):
        change_hz = abs(now / after.length_mm - was / before.length_mm) * speed_mm_s
        if change_hz / duration_s > axis.acceleration_hz_s * (1 + 1e-9):
            return False
    return True


#: Straight on, but for a step more or less.
_CHANGES = st.tuples(st.integers(-2, 2), st.integers(-2, 2), st.integers(-2, 2))
_STEPS = st.tuples(st.integers(-12, 12), st.integers(-12, 12), st.integers(-12, 12))


@given(axes=st.sampled_from(_MACHINES), first=_STEPS.filter(any), change=_CHANGES)
@example(axes=uneven(), first=(3, 0, 2), change=(0, 0, 1))
def test_a_corner_is_slow_enough_for_both_sides(axes: Machine, first: Steps, change: Steps) -> None:
    """Where the path turns faster than an axis can, all are within their start/stop rates."""
    second = tuple(a + b for a, b in zip(first, change, strict=True))
    if not any(second):
        return
    limits = Limits(axes)
    before, after = segment(limits, first), segment(limits, second)
    speed_mm_s = limits.corner_mm2_s2(before, after) ** 0.5
    if speed_mm_s == UNLIMITED:
        return
    both_calm = all(is_calm(axes, part, speed_mm_s) for part in (before, after))
    assert both_calm or can_turn(axes, before, after, speed_mm_s)


@given(axes=st.sampled_from(_MACHINES), first=_STEPS.filter(any), change=_CHANGES)
@example(axes=uneven(), first=(3, 0, 2), change=(0, 0, 1))
def test_a_corner_is_no_slower_than_without_ramps(
    axes: Machine, first: Steps, change: Steps
) -> None:
    """Within the start/stop rates before, after, and in what changes, nothing speaks against it."""
    second = tuple(a + b for a, b in zip(first, change, strict=True))
    if not any(second):
        return
    limits = Limits(axes)
    before, after = segment(limits, first), segment(limits, second)
    leaps = (
        abs(now / after.length_mm - was / before.length_mm) / start_rate_hz(axis)
        for was, now, axis in zip(first, second, axes.axes, strict=True)
    )
    calm_mm_s = min(before.start_mm_s, after.start_mm_s, 1 / max(max(leaps), 1e-9))
    assert limits.corner_mm2_s2(before, after) ** 0.5 >= calm_mm_s * (1 - 1e-9)
