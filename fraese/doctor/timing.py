"""Are the steps on time? The step loop as configured, on a port that leads nowhere.

    quiet machine      S seconds  --> how late, how often
    all cores busy     S seconds  --> how late, how often
    faster and faster  S/4 each   --> the highest rate that holds

Rule 1: what is measured is what drives metal (``motor/realtime/measure.py``): a child process,
        with the rights that it will have then, at the highest rate that is configured.
Rule 2: late is who is late by more than a quarter of the step interval: from there on the motor
        notices. A rate holds if that happens to less than one tick in a thousand.
Rule 3: nothing is extrapolated. A rate that was not tried is not promised.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from fraese.config import Config
from fraese.doctor.findings import Finding, State
from fraese.kinds.card import card_kind
from fraese.motor.realtime.kernel import KernelFacts
from fraese.motor.realtime.measure import (
    Duty,
    Lateness,
    Rung,
    highest_rate_hz,
    hogs,
    ladder,
    measure,
)
from fraese.motor.realtime.setup import RealtimeOptions
from fraese.motor.seams import Card
from fraese.phrases import phrase

#: Edges of the histogram, us: three to a decade.
EDGES_US: Final[npt.NDArray[np.float64]] = np.array(
    [0.0, *(base * 10.0**k for k in range(-1, 5) for base in (1, 2, 5)), np.inf]
).round(1)
#: Rates that are tried, ticks a second.
RATES_HZ: Final = (
    500.0, 1000.0, 2000.0, 3000.0, 5000.0, 7000.0, 10_000.0, 14_000.0, 20_000.0, 30_000.0,
    50_000.0, 70_000.0, 100_000.0, 133_000.0,
)  # fmt: skip
#: Each rate is tried for this share of the time of a measurement.
_RUNG_SHARE: Final = 0.25

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Conditions:
    """One measurement.

    Attributes:
        name: "quiet" or "busy".
        hogs: processes beside it that only compute.
        result: what came out.
    """

    name: str
    hogs: int
    result: Lateness

    @property
    def holds(self) -> bool:
        """The rate that was wanted holds under these conditions."""
        result = self.result
        return Rung(result.duty.rate_hz, result.percentiles_us()[2], result.played_hz).holds


@dataclass(frozen=True, slots=True)
class Timing:
    """All measurements.

    Attributes:
        duty: what was to be done.
        runs: under each condition.
        rungs: rates that were tried on the quiet machine.
    """

    duty: Duty
    runs: tuple[Conditions, ...]
    rungs: tuple[Rung, ...]

    @property
    def highest_hz(self) -> float:
        """The highest rate that holds; 0: none of those tried."""
        return highest_rate_hz(self.rungs)

    @property
    def ladder_ended(self) -> bool:
        """A rate was found that does not hold; else there may be higher ones that do."""
        return bool(self.rungs) and not self.rungs[-1].holds


def duty_of(card: Card, options: RealtimeOptions) -> Duty:
    """All axes together, at the highest rate that any of them is configured for."""
    return Duty(card, options.top_rate_hz, card.motors, options=options)


def limit_hz(config: Config) -> float:
    """What the card can follow at most."""
    return card_kind(config).limit_hz(config)


def rates_to_try(limit: float, wanted_hz: float) -> list[float]:
    """Those of ``RATES_HZ`` that a card can follow, its limit, and the rate that is wanted."""
    return sorted({rate for rate in RATES_HZ if rate < limit} | {limit, wanted_hz})


def take(duty: Duty, limit: float, seconds: float, cores: int, load: bool, say: Say) -> Timing:
    """Measure.

    Args:
        duty: what has to be done.
        limit: highest rate that is tried.
        seconds: for each condition.
        cores: how many there are to be kept busy.
        load: measure under load, too.
        say: is told what is being done.

    Raises:
        PortError: if the step process does not start.
    """
    runs = []
    for name, number in (("quiet", 0), *((("busy", cores),) if load else ())):
        say(
            phrase(
                "measuring {rate_hz:g} ticks/s for {seconds:g} s, {loads} ...",
                rate_hz=duty.rate_hz,
                seconds=seconds,
                loads=_LOADS[name],
            )
        )
        with hogs(number):
            runs.append(Conditions(name, number, measure(duty, seconds)))
    say(phrase("looking for the highest rate that holds ..."))
    rungs = ladder(duty, seconds * _RUNG_SHARE, rates_to_try(limit, duty.rate_hz))
    return Timing(duty, tuple(runs), tuple(rungs))


_NAMES: Final = {"quiet": phrase("quiet"), "busy": phrase("busy")}
_LOADS: Final = {"quiet": phrase("nothing beside it"), "busy": phrase("all cores kept busy")}


def judge(timing: Timing) -> list[Finding]:
    """One finding for each condition, and one for the rates."""
    return [*(_lateness(run) for run in timing.runs), _highest(timing)]


def _lateness(run: Conditions) -> Finding:
    result = run.result
    p999_us, longest_us = result.percentiles_us()[2:]
    quarter_us = result.duty.interval_us / 4
    found = phrase(
        "At {rate_hz:g} ticks/s 99.9 % are late by less than {p999_us:.1f} us (a quarter"
        " of the interval: {quarter_us:.1f} us), the longest by {longest_us:.0f} us;"
        " {late_edges} of {count} are later than the quarter.",
        rate_hz=result.duty.rate_hz,
        p999_us=p999_us,
        quarter_us=quarter_us,
        longest_us=longest_us,
        late_edges=result.late_edges(),
        count=len(result.late_us),
    )
    if run.holds:
        return Finding(phrase("timing, {load}", load=_NAMES[run.name]), State.OK, found)
    slow = "" if result.played_hz > 0.98 * result.duty.rate_hz else (
        phrase(" Only {played_hz:.0f} ticks/s were made.", played_hz=result.played_hz)
    )  # fmt: skip
    return Finding(
        phrase("timing, {load}", load=_NAMES[run.name]),
        {"quiet": State.BAD, "busy": State.WARN}[run.name],
        found + slow,
        {
            "quiet": phrase("Lower axes.*.max_rate_hz to a rate that holds."),
            "busy": phrase("Run nothing else beside it, or lower axes.*.max_rate_hz."),
        }[run.name],
    )


def _highest(timing: Timing) -> Finding:
    name, wanted_hz = phrase("highest rate"), timing.duty.rate_hz
    highest_hz = timing.highest_hz
    if not highest_hz:
        return Finding(
            name,
            State.BAD,
            phrase("Not even {rate_hz:g} ticks/s hold.", rate_hz=timing.rungs[0].rate_hz),
            phrase("Do not drive steel from this machine."),
        )
    found = phrase("{highest_hz:g} ticks/s hold", highest_hz=highest_hz) + (
        phrase(", {rate_hz:g} do not.", rate_hz=timing.rungs[-1].rate_hz)
        if timing.ladder_ended
        else phrase("; more is not asked of this card.")
    )
    if highest_hz >= wanted_hz:
        return Finding(name, State.OK, found)
    return Finding(
        name,
        State.BAD,
        phrase("{found} Configured: {wanted_hz:g}.", found=found, wanted_hz=wanted_hz),
        phrase("axes.*.max_rate_hz = {highest_hz:g}, or less.", highest_hz=highest_hz),
    )


def advice(timing: Timing, kernel: KernelFacts) -> list[str]:
    """What would make the steps more punctual, beyond what the checks say; a sentence each."""
    quiet = timing.runs[0].result
    sentences: list[str] = []
    if quiet.percentiles_us()[3] > quiet.duty.interval_us and not kernel.isolated:
        core = kernel.cores[-1] if kernel.cores else 0
        sentences.append(
            phrase(
                "The longest delay is longer than a step: keep everything else off one core"
                " with isolcpus={core} nohz_full={core} on the kernel's command line; the"
                " steps are made there from then on.",
                core=core,
            )
        )
    busy = [run for run in timing.runs if run.name == "busy" and not run.holds]
    if timing.runs[0].holds and busy:
        sentences.append(
            phrase(
                "Other programs delay the steps: close them while the machine moves, or give"
                " the steps the rights that are named above."
            )
        )
    if not timing.runs[0].holds and timing.duty.card.fall:
        sentences.append(
            phrase(
                "Where a fast rate is needed: the microcontroller of the bridge times the"
                " steps by itself, and needs nothing of this."
            )
        )
    return sentences
