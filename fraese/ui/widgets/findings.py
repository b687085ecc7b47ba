"""What calibration has found, drawn in characters: histogram, sweep, old and new.

Nothing here depends on colour: what is good, resonates or stalls has its own sign.
"""

from collections.abc import Sequence
from typing import Final

from fraese.control.calibration.backlash import Backlash, BacklashTest
from fraese.control.calibration.frequency import FrequencyTest, Progress
from fraese.control.calibration.proposal import Proposal
from fraese.control.calibration.repeat import Repeatability, RepeatTest
from fraese.control.calibration.stepsize import StepSizeTest
from fraese.control.calibration.sweep import Outcome, Tried
from fraese.control.calibration.travel import TravelTest
from fraese.phrases import shown, spoken
from fraese.ui.calibrating import Calibration, Test

_EIGHTHS: Final = " ▏▎▍▌▋▊▉█"
#: Signs of a value, from harmless to bad; where several share a place, the worst is shown.
UNTRIED, GOOD, RESONANT, STALLED = "·", "▪", "~", "×"
_LEGEND: Final = spoken(
    "{good} good   {resonant} resonates   {stalled} stalls   {untried} not tried",
    good=GOOD,
    resonant=RESONANT,
    stalled=STALLED,
    untried=UNTRIED,
)


def bar(count: float, most: float, width: int) -> str:
    """A bar for one count; the smallest is seen."""
    if count <= 0 or most <= 0 or width <= 0:
        return ""
    eighths = max(1, round(count / most * width * 8))
    return "█" * (eighths // 8) + _EIGHTHS[eighths % 8].strip()


def histogram(found: Repeatability, width: int) -> list[str]:
    """How often the switch closed where: bars by their middles, from the mean."""
    bins = found.figures.bins(found.step_mm)
    labels = [f"{round((each.low + each.high) / 2, 4) + 0.0:+.4f} {found.unit}" for each in bins]
    most = max((each.count for each in bins), default=0)
    room = width - max(map(len, labels), default=0) - 6
    return [
        f"{label} {each.count:>3}  {bar(each.count, most, room)}"
        for label, each in zip(labels, bins, strict=True)
    ]


def sweep_line(outcome: Outcome, values: Sequence[float], width: int) -> str:
    """A stage in one line, as long as there is room for: a sign for each value."""
    tried = {each.value: each for each in outcome.tried}
    signs = [_sign(tried.get(value), outcome.stall, value) for value in values]
    worst = (UNTRIED, GOOD, RESONANT, STALLED)
    if len(signs) <= width:
        each = max(1, width // max(1, len(signs)))
        return "".join(sign * each for sign in signs)
    return "".join(
        max(
            signs[at * len(signs) // width : max(1, (at + 1) * len(signs) // width)],
            key=worst.index,
        )
        for at in range(width)
    )


def _sign(tried: Tried | None, stall: float | None, value: float) -> str:
    if tried is None:
        return UNTRIED
    if not tried.is_bad:
        return GOOD
    return STALLED if stall is not None and value >= stall else RESONANT


def sweep(found: Progress, width: int, *, running: bool) -> list[str]:
    """All stages that were tried, and the value that is tried now."""
    by = spoken("its switch tells of lost steps") if found.by_switch else spoken("by ear")
    lines = [f"{found.axis.upper()}, {by}"]
    for stage, outcome in found.outcomes.items():
        values = outcome.sweep.values
        ends = f"{values[0]:g}", f"{values[-1]:g} {shown(stage.unit)}"
        room = width - len(ends[0]) - len(ends[1]) - 2
        lines += ["", f"{ends[0]} {sweep_line(outcome, values, room)} {ends[1]}"]
        if running and stage is found.stage:
            at = (values.index(found.value) if found.value in values else 0) + 1
            lines.append(
                spoken(
                    "now {value:g} {unit}, {at} of {count}",
                    value=found.value,
                    unit=stage.unit,
                    at=at,
                    count=len(values),
                )
            )
        else:
            lines.append(_capital(shown(outcome.words())))
    return [*lines, "", _LEGEND] if len(lines) > 1 else lines


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _backlash(found: Backlash, width: int) -> list[str]:
    readings = found.figures.readings
    most = max((*readings, found.configured_mm), default=0)
    lines = [
        f"{number:>2}  {reading:.4f}  {bar(reading, most, width - 14)}"
        for number, reading in enumerate(readings, start=1)
    ]
    if not lines:
        return [spoken("not measured yet")]
    figures = found.figures
    return [
        *lines,
        "",
        spoken(
            "mean {mean:.4f}, spread {spread:.4f}; told apart are {fine_mm:.4f}",
            mean=figures.mean,
            spread=figures.spread,
            fine_mm=found.fine_mm,
        ),
    ]


def _steps(test: StepSizeTest, width: int) -> list[str]:
    found = test.result
    if found is None:
        return [
            spoken("{commanded_mm:g} were commanded.", commanded_mm=test.commanded_mm)
            if test.commanded_mm
            else spoken("on the way")
        ]
    most = max(abs(found.commanded_mm), abs(found.measured_mm))
    room = max(1, width - 24)
    return [
        spoken(
            "commanded {commanded_mm:>12.3f} {bar}",
            commanded_mm=found.commanded_mm,
            bar=bar(abs(found.commanded_mm), most, room),
        ),
        spoken(
            "measured  {measured_mm:>12.3f} {bar}",
            measured_mm=found.measured_mm,
            bar=bar(abs(found.measured_mm), most, room),
        ),
        "",
        spoken(
            "{steps_per_mm:.6g} steps per unit are in force, {found_steps_per_mm:.6g} are right",
            steps_per_mm=found.steps_per_mm,
            found_steps_per_mm=found.found_steps_per_mm,
        )
        + (spoken(", the other way round.") if found.is_inverted else "."),
    ]


def _travel(test: TravelTest, width: int) -> list[str]:
    found = test.result
    if found is None:
        return [spoken("on the way")]
    most, room = max(found.measured_mm, found.configured_mm), max(1, width - 24)
    return [
        spoken(
            "configured {configured_mm:>11.3f} {bar}",
            configured_mm=found.configured_mm,
            bar=bar(found.configured_mm, most, room),
        ),
        spoken(
            "measured   {measured_mm:>11.3f} {bar}",
            measured_mm=found.measured_mm,
            bar=bar(found.measured_mm, most, room),
        ),
    ]


def finding(test: Test, width: int, *, running: bool) -> list[str]:
    """What a routine has found so far."""
    if isinstance(test, FrequencyTest):
        return sweep(test.facts(), width, running=running)
    if isinstance(test, RepeatTest):
        facts = test.facts()
        head = spoken(
            "{end}, {made} of {approaches} approaches",
            end=facts.end,
            made=facts.made,
            approaches=facts.approaches,
        )
        words = [shown(facts.words())] if facts.made > 1 else []
        return [head, "", *histogram(facts, width), "", *words]
    if isinstance(test, BacklashTest):
        return _backlash(test.facts(), width)
    return _steps(test, width) if isinstance(test, StepSizeTest) else _travel(test, width)


def proposed(calibration: Calibration, write: str, other: str) -> list[str]:
    """What is proposed, and the keys for it.

    Args:
        calibration: what was found.
        write: the key that writes it.
        other: the key for the next proposal.
    """
    proposal, every = calibration.proposal, calibration.proposals
    if proposal is None:
        return []
    # A frequency test has said in its stages why.
    lines = _changes(proposal)[calibration.frequency_test is not None :]
    if len(every) > 1:
        at = every.index(proposal) + 1
        lines.append(
            spoken(
                "{at} of {count} that explain it; {other} shows the next one.",
                at=at,
                count=len(every),
                other=other,
            )
        )
    if proposal.changes:
        lines.append(spoken("{write} writes it.", write=write))
    return lines


def _changes(proposal: Proposal) -> list[str]:
    if not proposal.changes:
        return [proposal.why, spoken("The configuration is right as it is.")]
    return [shown(proposal.why), *(f"   {shown(change.words())}" for change in proposal.changes)]
