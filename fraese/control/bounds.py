r"""Between which counts the motors are, whatever happens until the next look.

    count ^          _______ high
          |      ___/        \___        a block goes straight from its beginning to its end:
          |  ___/                \___    the ends of all blocks, and where the motors are now,
          | now                      low  bound everything between
          +----------------------------> blocks handed over

Rule 1: what was handed to the driver may be played to its end, as planned and no faster.
Rule 2: only so much counts as can be played within the horizon at its top rate, and the way that
        braking takes from there. Whoever uses such bounds sees to it that the motors brake by then.
Rule 3: where all is played before the horizon, there is a margin at the end of it: what an axis
        could do in the rest of the time, or in ``margin_s``, at the share of its top rate that the
        fastest of these blocks uses: so what comes next mostly lies within already.
"""

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from fraese.blocks import CYCLES_PER_S, Q8, Block
from fraese.machine import Steps

#: A throttle that closes lags by some ticks at low rates (``motor/horizon.py``).
_LAG_TICKS: Final = 8
#: Units of a block's ``accel_q`` in 1 tick/s**2.
_ACCEL_Q: Final = Q8 * 65536 / CYCLES_PER_S


class Span(NamedTuple):
    """One block, or what is left of it.

    Attributes:
        block: all of it.
        ticks: how many it has,
        done: and how many were played.
        duration_s: as planned, of the whole block.
    """

    block: Block
    ticks: int
    done: int
    duration_s: float

    def braking_s(self) -> float:
        """Braking from its top rate goes as far as that rate in so long."""
        block = self.block
        if not block.accel_q:
            return 0.0
        return block.top_rate_q8() / Q8 / (block.accel_q / _ACCEL_Q) / 2


class Box(NamedTuple):
    """Motor counts, per motor.

    Attributes:
        low: nothing reaches below it,
        high: or above it,
        is_whole: for ever; else until the horizon.
    """

    low: Steps
    high: Steps
    is_whole: bool

    def holds(self, counts: Steps) -> bool:
        """These counts are within."""
        for low, at, high in zip(self.low, counts, self.high, strict=True):
            if not low <= at <= high:
                return False
        return True


def holds(outer: Box | None, inner: Box) -> bool:
    """All that the inner one bounds lies within the outer one."""
    return outer is not None and outer.holds(inner.low) and outer.holds(inner.high)


def common(one: Box | None, other: Box | None) -> Box | None:
    """What both bound; None where one bounds nothing."""
    if one is None or other is None:
        return None
    return Box(
        tuple(map(max, one.low, other.low)),
        tuple(map(min, one.high, other.high)),
        one.is_whole and other.is_whole,
    )


def reached(
    start: Steps, span: Span, left_s: float, here: Steps | None = None
) -> tuple[Steps, bool]:
    """Where a block can be after so long, and whether that is its end.

    Args:
        start: counts where it begins.
        span: the block.
        left_s: time that it can be played.
        here: where it is, if it has begun.
    """
    block = span.block
    end = tuple(a + b for a, b in zip(start, block.steps, strict=True))
    if _least_s(span) <= left_s:
        return end, True
    ticks = int(max(left_s, 0.0) * block.top_rate_q8() / Q8) + _LAG_TICKS
    if ticks >= span.ticks - span.done:
        return end, True
    reach = []
    for at, to, steps in zip(here or start, end, block.steps, strict=True):
        most = -(-abs(steps) * ticks // span.ticks) + 1
        reach.append(max(at - most, to) if steps < 0 else min(at + most, to))
    return tuple(reach), False


def _least_s(span: Span) -> float:
    """What is left of it takes no less: each tick may be a cycle shorter than planned."""
    return span.duration_s * (span.ticks - span.done) / span.ticks * 0.99


def box_of(
    here: Steps,
    start: Steps,
    spans: Iterable[Span],
    horizon_s: float,
    max_rates_hz: Sequence[float],
    margin_s: float,
) -> Box:
    """Bounds of all that was handed over.

    Args:
        here: counts now,
        start: and where the first block begins.
        spans: the blocks, in their order.
        horizon_s: how far one has to look.
        max_rates_hz: of each motor.
        margin_s: room for what comes next, at most as much as is left of the horizon.
    """
    low, high, left_s, share, is_whole = here, here, horizon_s, 0.0, True
    at: Steps | None = here
    end, braking_s = here, 0.0
    for span in spans:
        braking_s = max(braking_s, span.braking_s())
        end, is_whole = reached(start, span, left_s + braking_s, at)
        at = None
        low, high = tuple(map(min, low, end)), tuple(map(max, high, end))
        share = max(share, _share(span, max_rates_hz))
        if not is_whole:
            break
        left_s -= _least_s(span)
        start = end
    room_s = min(margin_s, max(0.0, left_s + braking_s)) if is_whole else 0.0
    rooms = [int(rate * min(share, 1.0) * room_s) + 1 for rate in max_rates_hz]
    return Box(
        tuple(min(n, to - room) for n, to, room in zip(low, end, rooms, strict=True)),
        tuple(max(n, to + room) for n, to, room in zip(high, end, rooms, strict=True)),
        is_whole,
    )


def _share(span: Span, max_rates_hz: Sequence[float]) -> float:
    """How much of its top rate its fastest motor uses."""
    if not span.ticks:
        return 1.0
    top_hz = span.block.top_rate_q8() / Q8
    return max(
        abs(steps) / span.ticks * top_hz / rate
        for steps, rate in zip(span.block.steps, max_rates_hz, strict=True)
    )
