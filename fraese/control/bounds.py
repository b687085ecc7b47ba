r"""Between which counts the motors are, whatever happens until the next look.

    count ^          _______ high
          |      ___/        \___        a block goes straight from its beginning to its end:
          |  ___/                \___    the ends of all blocks, and where the motors are now,
          | now                      low  bound everything between
          +----------------------------> blocks handed over

Rule 1: what was handed to the driver may be played to its end, as planned and no faster.
Rule 2: of a block that takes longer than the horizon, only so much counts as can be played within
        it at its top rate. Whoever uses such bounds sees to it that the motors have braked by then.
Rule 3: the margin is what an axis could do in ``margin_s`` more, at the share of its top rate that
        the fastest of these blocks uses: so what comes next mostly lies within already.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from fraese.blocks import Q8, Block
from fraese.machine import Steps


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
    # Each tick may be a cycle shorter than planned.
    if span.duration_s * (span.ticks - span.done) / span.ticks * 0.99 <= left_s:
        return end, True
    ticks = int(max(left_s, 0.0) * block.top_rate_q8() / Q8) + 2
    if ticks >= span.ticks - span.done:
        return end, True
    reach = []
    for at, to, steps in zip(here or start, end, block.steps, strict=True):
        most = -(-abs(steps) * ticks // span.ticks) + 1
        reach.append(max(at - most, to) if steps < 0 else min(at + most, to))
    return tuple(reach), False


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
        margin_s: room for what comes next.
    """
    low, high, left_s, share, is_whole = here, here, horizon_s, 0.0, True
    at: Steps | None = here
    for span in spans:
        to, is_whole = reached(start, span, left_s, at)
        at = None
        low = tuple(map(min, low, to))
        high = tuple(map(max, high, to))
        share = max(share, _share(span, max_rates_hz))
        if not is_whole:
            break
        left_s -= span.duration_s * (span.ticks - span.done) / span.ticks * 0.99
        start = to
    rooms = [int(rate * min(share, 1.0) * margin_s) + 1 for rate in max_rates_hz]
    return Box(
        tuple(n - room for n, room in zip(low, rooms, strict=True)),
        tuple(n + room for n, room in zip(high, rooms, strict=True)),
        is_whole,
    )


def _share(span: Span, max_rates_hz: Sequence[float]) -> float:
    """How much of its top rate its fastest motor uses."""
    if span.duration_s <= 0:
        return 1.0
    return max(
        abs(steps) / span.duration_s / rate
        for steps, rate in zip(span.block.steps, max_rates_hz, strict=True)
    )
