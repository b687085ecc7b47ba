"""What a command may ask for: soft limits, and numbers that make sense.

Rule 1: everything is refused before anything moves, in one sentence that names axis, value and
        what would be right.
Rule 2: a referenced axis stays within its soft limits; one that stands beyond a limit may come
        back, but not go further.
Rule 3: nobody knows where an unreferenced axis is: no single move is longer than its whole travel.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Final

from fraese.control.position import Position
from fraese.errors import LimitError
from fraese.machine import Axis, Machine, Steps, three_decimals
from fraese.phrases import phrase
from fraese.workframe import WorkFrame

#: Numbers beyond are mistakes of typing.
_LARGEST_MM: Final = 1e7
#: Below this nothing gets anywhere: a millimetre would take more than a day.
_SLOWEST_MM_MIN: Final = 0.0005


def require_reachable(position: Position, targets: Iterable[Steps]) -> None:
    """See that every target can be reached from here.

    Raises:
        LimitError: naming axis, target and travel.
    """
    for target in targets:
        for motor, axis in enumerate(position.machine.axes):
            here, there = position.position_steps[motor], target[motor]
            if there == here:
                continue
            here_mm, there_mm = axis.to_mm(here), axis.to_mm(there)
            said = why_not(
                axis,
                position.referenced[motor],
                here_mm,
                there_mm,
                abs(there_mm - here_mm),
                position.frame,
            )
            if said:
                raise LimitError(said)


def why_not(
    axis: Axis, referenced: bool, from_mm: float, to_mm: float, span_mm: float, frame: WorkFrame
) -> str:
    """Why an axis cannot go somewhere, in a sentence; empty: it can.

    Args:
        axis: which.
        referenced: whether its position can be relied on.
        from_mm: where it comes from, machine coordinates; from beyond a limit it may come back.
        to_mm: where it is to go.
        span_mm: way between the ends of all that it does; all that counts where it is not
            referenced.
        frame: for the limits in work coordinates.
    """
    if referenced or axis.is_endless:
        if axis.low_mm <= to_mm <= axis.high_mm and not axis.is_endless:
            return ""
        # What is a little outside may still round onto the limit.
        low, high = _limits_steps(axis, axis.to_steps(from_mm))
        if low <= axis.to_steps(to_mm) <= high:
            return ""
        return _outside(axis, to_mm, frame)
    if span_mm <= axis.travel_mm + axis.step_mm / 2:
        return ""
    return phrase(
        "{name} would move {with_unit}, further than its whole travel of {with_unit_2}.",
        name=axis.name.upper(),
        with_unit=axis.with_unit(f"{span_mm:.3f}"),
        with_unit_2=axis.with_unit(axis.travel_mm),
    )


def within_travel(
    machine: Machine, referenced: Sequence[bool], from_mm: Sequence[float], to_mm: Sequence[float]
) -> tuple[float, ...]:
    """How far a straight way gets inside the travel; ``to_mm`` itself where that is all inside."""
    share = 1.0
    for axis, is_known, start_mm, end_mm in zip(
        machine.axes, referenced, from_mm, to_mm, strict=True
    ):
        if is_known and not axis.is_endless and start_mm != end_mm:
            inside_mm = min(max(end_mm, axis.low_mm), axis.high_mm)
            share = min(share, (inside_mm - start_mm) / (end_mm - start_mm))
    if share == 1:
        return tuple(to_mm)
    ways = zip(from_mm, to_mm, strict=True)
    return tuple(start + max(share, 0.0) * (end - start) for start, end in ways)


def jog_target(
    position: Position, motor: int, distance_steps: int, longest_mm: float, *, clamp: bool
) -> Steps:
    """Where a jog of one axis leads.

    Args:
        position: where the axes are.
        motor: which one.
        distance_steps: signed.
        longest_mm: no jog is longer.
        clamp: stop at the soft limit instead of refusing.

    Raises:
        LimitError: if it would leave the travel, or is too long or nothing.
    """
    axis = position.machine.axes[motor]
    if not distance_steps:
        raise LimitError(
            phrase(
                "A jog must be at least one step of {with_unit}.",
                with_unit=axis.with_unit(axis.step_mm),
            )
        )
    if abs(distance_steps) > axis.to_steps(longest_mm):
        require_jog(axis, axis.to_mm(distance_steps), longest_mm)
    target = list(position.position_steps)
    target[motor] += distance_steps
    if clamp:
        target[motor] = _within(position, motor, target[motor])
    require_reachable(position, [tuple(target)])
    return tuple(target)


def _within(position: Position, motor: int, target_steps: int) -> int:
    """The target, or the soft limit before it.

    Raises:
        LimitError: if the axis stands at that limit already.
    """
    if not position.referenced[motor]:
        return target_steps
    axis, here = position.machine.axes[motor], position.position_steps[motor]
    low, high = _limits_steps(axis, here)
    target_steps = min(max(target_steps, low), high)
    if target_steps == position.position_steps[motor]:
        name = position.machine.axes[motor].name
        raise LimitError(phrase("{name} stands at its soft limit.", name=name.upper()))
    return target_steps


def _limits_steps(axis: Axis, here_steps: int) -> tuple[int, int]:
    """Soft limits of an axis, or where it stands beyond one."""
    return min(axis.low_steps, here_steps), max(axis.high_steps, here_steps)


def _outside(axis: Axis, value_mm: float, frame: WorkFrame) -> str:
    name = axis.name.upper()
    if axis.is_endless:
        return phrase(
            "{name} {with_unit} is further than steps are counted, {with_unit_2} either way.",
            name=name,
            with_unit=axis.with_unit(value_mm),
            with_unit_2=axis.with_unit(axis.to_mm(axis.high_steps)),
        )
    offset_mm = frame.origin[frame.axes.index(axis.name)]
    # A turned axis has no travel of its own: it depends on where the other one stands.
    own = frame.moved_with(axis.name) == {axis.name}
    work = (
        phrase(
            " (work {low} to {high})",
            low=three_decimals(axis.low_mm - offset_mm),
            high=three_decimals(axis.high_mm - offset_mm),
        )
        if offset_mm and own
        else ""
    )
    return phrase(
        "{name} {with_unit} is outside the travel, {low_mm:g} to {with_unit_2} in"
        " machine coordinates{work}.",
        name=name,
        with_unit=axis.with_unit(three_decimals(value_mm)),
        low_mm=axis.low_mm,
        with_unit_2=axis.with_unit(axis.high_mm),
        work=work,
    )


def require_jog(axis: Axis, distance_mm: float, longest_mm: float) -> None:
    """See that a jog is bounded.

    Raises:
        LimitError: if it is too long or nothing.
    """
    if not 0 < abs(distance_mm) <= longest_mm:
        raise LimitError(
            phrase(
                "A jog must be longer than 0 and at most {with_unit}, not {with_unit_2}.",
                with_unit=axis.with_unit(longest_mm),
                with_unit_2=axis.with_unit(distance_mm),
            )
        )


def to_steps(machine: Machine, point_mm: Sequence[float]) -> Steps:
    """A point in machine coordinates.

    Raises:
        LimitError: if it has a coordinate that is not a number.
    """
    for axis, mm in zip(machine.axes, point_mm, strict=True):
        require_finite(axis, mm)
    return machine.to_steps(tuple(point_mm))


def require_finite(axis: Axis, value_mm: float) -> None:
    """See that a coordinate is a number.

    Raises:
        LimitError: if it is not, or no machine is so large.
    """
    name = axis.name.upper()
    if not math.isfinite(value_mm):
        raise LimitError(
            phrase("{name} needs a number, not {value_mm}.", name=name, value_mm=value_mm)
        )
    if abs(value_mm) > _LARGEST_MM:
        raise LimitError(
            phrase(
                "{name} {value_mm:g} is further than any machine: at most {with_unit} either way.",
                name=name,
                value_mm=value_mm,
                with_unit=axis.with_unit(f"{_LARGEST_MM:,.0f}"),
            )
        )


def require_feed(feed_mm_min: float | None) -> None:
    """See that a feed moves something, in a time that is one.

    Raises:
        LimitError: if it does not.
    """
    if feed_mm_min is None:
        return
    if not feed_mm_min > 0:
        raise LimitError(
            phrase("A feed is above 0 mm/min, not {feed_mm_min:g}.", feed_mm_min=feed_mm_min)
        )
    if not _SLOWEST_MM_MIN <= feed_mm_min < math.inf:
        raise LimitError(
            phrase(
                "A feed is a number of mm/min from {slowest_mm_min:g} on, not {feed_mm_min:g}.",
                slowest_mm_min=_SLOWEST_MM_MIN,
                feed_mm_min=feed_mm_min,
            )
        )


def fastest_mm_min(machine: Machine, here: Steps, there: Steps) -> float:
    """How fast the axes can go along a straight line of linear axes; infinite elsewhere."""
    ways_mm = [
        axis.to_mm(to) - axis.to_mm(at)
        for axis, at, to in zip(machine.axes, here, there, strict=True)
    ]
    moved = [(axis, way) for axis, way in zip(machine.axes, ways_mm, strict=True) if way]
    if any(axis.kind == "rotary" for axis, _ in moved):
        return math.inf
    length_mm = math.hypot(*ways_mm)
    rates = (axis.max_rate_hz * axis.step_mm * 60 * length_mm / abs(way) for axis, way in moved)
    return min(rates, default=math.inf)
