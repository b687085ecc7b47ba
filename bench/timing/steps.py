"""The step process by itself, idle and with a hog on every core."""

import os
from collections.abc import Sequence

import numpy as np

from bench.timing.figures import Row, Samples, Section, row_of, together
from fraese.motor.realtime.bareloop import interruptions_us
from fraese.motor.realtime.measure import (
    Duty,
    Lateness,
    highest_rate_hz,
    hogs,
    ladder,
    measure,
    smc_duty,
    stepdir_duty,
)

CORES = os.cpu_count() or 1
_BURSTS = 3
_PAPER_RATES_HZ = (20_000, 30_000, 40_000, 50_000, 60_000, 80_000, 100_000, 120_000)


def bare(seconds: float, interval_us: float) -> str:
    """What the machine takes from a loop that only looks at the time, and what follows from it.

    Args:
        seconds: to measure for.
        interval_us: of ticks that such a loop would make.
    """
    taken_us = np.sort(np.array(interruptions_us(seconds) or [0.0]))
    median, p99, longest = np.percentile(taken_us, (50, 99, 100))
    return (
        f"A bare loop with the same rights was interrupted {len(taken_us) / seconds:.0f} times a"
        f" second just after, for {median:.1f} us in the median (p99 {p99:.1f}, longest"
        f" {longest:.1f}). By that alone {_share_later(taken_us, interval_us / 4, seconds):.2%} of"
        f" the ticks would be later than a quarter, and p99.9 would be"
        f" {_later_than_one_in(1000, taken_us, seconds):.1f} us."
    )


def _share_later(taken_us: Samples, us: float, seconds: float) -> float:
    """Share of all moments after which the loop does not look at the time for longer than this."""
    return float(np.maximum(taken_us - us, 0).sum() / (seconds * 1e6))


def _later_than_one_in(number: int, taken_us: Samples, seconds: float) -> float:
    """One moment in so many has to wait longer than this, us."""
    low, high = 0.0, float(taken_us[-1])
    for _ in range(60):
        middle = (low + high) / 2
        if _share_later(taken_us, middle, seconds) > 1 / number:
            low = middle
        else:
            high = middle
    return high


def _idle_and_loaded(duty: Duty, seconds: float) -> tuple[list[Row], Lateness]:
    idle = measure(duty, seconds)
    with hogs(CORES):
        loaded = measure(duty, seconds)
    rows = [row_of("nothing beside it", idle), row_of(f"{CORES} hogs on {CORES} cores", loaded)]
    return rows, idle


def phase_card(seconds: float) -> Section:
    """5 kHz on three axes: nine writes and three readings every 200 us."""
    rows, idle = _idle_and_loaded(smc_duty(), seconds)
    said = [f"Granted: {', '.join(idle.notes)}.", bare(min(seconds, 10), idle.duty.interval_us)]
    return Section("smc", "Phase-current card, 5 kHz on three axes", rows, said)


def x4step(seconds: float) -> Section:
    """20 kHz on all four axes of X4Step."""
    rows, idle = _idle_and_loaded(stepdir_duty("x4step"), seconds)
    said = [f"Granted: {', '.join(idle.notes)}.", bare(min(seconds, 10), idle.duty.interval_us)]
    for row in rows:
        median, _, p999, longest = row.percentiles_us()
        said.append(
            f"{row.name.capitalize()}: {row.later_than_a_quarter()} of {len(row.late_us)} ticks"
            f" were later than a quarter of the interval, the longest by {longest:.0f} us; p99.9 is"
            f" {p999:.2f} us, the median {median:.2f} us."
        )
    return Section("x4step", "X4Step, 20 kHz on four axes", rows, said)


def paper(seconds: float) -> Section:
    """The paper's 133 kHz on one axis, in bursts, and how far it really goes."""
    duty = stepdir_duty("paper", motors=1)
    bursts = [
        row_of("133 kHz wanted", measure(duty, max(2.0, seconds / 4))) for _ in range(_BURSTS)
    ]
    rungs = ladder(duty, 1.0, _PAPER_RATES_HZ)
    held_hz = highest_rate_hz(rungs)
    rows: list[Row] = [together(f"133 kHz wanted, {_BURSTS} bursts", bursts)]
    if held_hz:
        held = stepdir_duty("paper", held_hz, motors=1)
        rows.append(row_of(f"{held_hz / 1000:g} kHz wanted", measure(held, 2.0)))
    made_hz = rows[0].played_hz
    said = [
        f"Of 133333 ticks a second {made_hz:.0f} were made: one tick, with its two edges, costs"
        f" {1e6 / made_hz:.1f} us here, and the interval is 7.5 us. What limits is the time that"
        " Python takes for a tick; what comes later moves all that follows, so no pulse and no"
        " interval is cut short.",
        f"The highest rate of {', '.join(f'{rate / 1000:g}' for rate in _PAPER_RATES_HZ)} kHz at"
        f" which 99.9 % of the ticks were late by less than a quarter of the interval:"
        f" {f'{held_hz / 1000:g} kHz' if held_hz else 'none'}.",
        *_sequence(bursts),
    ]
    return Section("paper", "The paper, 133 kHz on one axis", rows, said)


def _sequence(bursts: Sequence[Row]) -> list[str]:
    each = ", ".join(f"{burst.played_hz:.0f}" for burst in bursts)
    return [f"The bursts one by one: {each} ticks a second."]
