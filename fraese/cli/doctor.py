"""``fraese doctor``: what was found, for people or as JSON."""

import json
import math
import sys
import textwrap
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from fraese.cli import language
from fraese.cli.histogram import histogram
from fraese.cli.leaving import leave
from fraese.cli.options import ConfigOption, JsonOption, TraceOption
from fraese.cli.output import note, say
from fraese.errors import UsageError
from fraese.kinds.port import port_kind
from fraese.phrases import phrase, shown

if TYPE_CHECKING:
    from fraese.doctor import Diagnosis
    from fraese.doctor.findings import Finding
    from fraese.doctor.timing import Conditions, Timing

app = typer.Typer()

_LEAST_S: Final = 0.2
_MOST_S: Final = 600.0
_MARKS: Final = {"ok": "ok", "warn": "warn", "bad": "BAD"}
_MARK: Final = 6
_NAME: Final = 22
_WIDTH: Final = 100
_BAR: Final = 26
_INDENT: Final = " " * (_MARK + _NAME)


@app.command()
def doctor(
    config: ConfigOption = None,
    as_json: JsonOption = False,
    seconds: Annotated[
        float, typer.Option("--seconds", metavar="S", help="Length of each measurement, s.")
    ] = 4.0,
    load: Annotated[
        bool, typer.Option("--load/--no-load", help="Measure with all cores busy, too.")
    ] = True,
    trace: TraceOption = None,
) -> None:
    """Look port, kernel and timing over: can this computer be trusted with steel?

    Opens the configured port, and leaves it with motors and outputs off. Nothing moves. Ends with 1
    if something is bad.
    """

    def go() -> int:
        if not _LEAST_S <= seconds <= _MOST_S:
            raise UsageError(
                phrase(
                    "--seconds {seconds:g}: from {least_s:g} to {most_s:g} s.",
                    seconds=seconds,
                    least_s=_LEAST_S,
                    most_s=_MOST_S,
                )
            )
        loaded = language.load(config)
        if trace is not None and not port_kind(loaded.port).opens:
            raise UsageError(
                phrase(
                    "--trace: doctor does nothing with a port of the kind {kind} that a waveform"
                    " could show.",
                    kind=loaded.port.kind,
                )
            )
        if sys.platform != "linux":
            raise UsageError(phrase("doctor looks at a Linux kernel, and here is none."))
        # Only there: what it measures with exists on Linux only.
        from fraese.doctor import examine

        diagnosis = examine(loaded, seconds, load, note, trace=trace)
        say(json.dumps(as_dict(diagnosis)) if as_json else "\n".join(report(diagnosis)))
        return 0 if diagnosis.ok else 1

    leave(go, as_json)


# --- for people ----------------------------------------------------------------------------------


def report(diagnosis: "Diagnosis") -> list[str]:
    """All of it, as lines."""
    lines = []
    for finding in diagnosis.findings:
        lines += _finding(finding)
    lines += ["", *_table(diagnosis.timing), "", *_bars(diagnosis.timing), ""]
    lines += _rungs(diagnosis.timing)
    for sentence in diagnosis.advice:
        lines += ["", *textwrap.wrap(shown(sentence), _WIDTH)]
    return [*lines, "", shown(_summary(diagnosis))]


def _finding(finding: "Finding") -> list[str]:
    head = f"{_MARKS[finding.state.value]:<{_MARK}}{shown(finding.name):<{_NAME}}"
    lines = textwrap.wrap(
        shown(finding.found),
        _WIDTH,
        initial_indent=head,
        subsequent_indent=_INDENT,
        break_on_hyphens=False,
    )
    if finding.change:
        # Not broken: it may be a line to be copied.
        lines.append(f"{_INDENT}-> {shown(finding.change)}")
    return lines


def _table(timing: "Timing") -> list[str]:
    duty = timing.duty
    title = phrase(
        "{rate_hz:g} ticks/s on {motors} axes, late by (us)",
        rate_hz=duty.rate_hz,
        motors=duty.motors,
    )
    names = ("median", "p99", "p99.9", "longest", "> 1/4", "of")
    lines = [f"{shown(title):<44}" + "".join(f"{name:>9}" for name in names)]
    for run in timing.runs:
        figures = "".join(f"{value:9.1f}" for value in run.result.percentiles_us())
        counts = f"{run.result.late_edges():9}{len(run.result.late_us):9}"
        lines.append(f"  {run.name:<42}{figures}{counts}")
        lines += textwrap.wrap(
            "; ".join(map(shown, run.result.notes)),
            _WIDTH,
            initial_indent="    ",
            subsequent_indent="    ",
        )
    return lines


def _bars(timing: "Timing") -> list[str]:
    edges, series = _counts(timing)
    return histogram(edges, series, "us", _BAR)


def _counts(timing: "Timing") -> tuple[list[float], list[tuple[str, list[int]]]]:
    from fraese.doctor.timing import EDGES_US

    series = [(run.name, run.result.histogram(EDGES_US).tolist()) for run in timing.runs]
    return EDGES_US.tolist(), series


def _rungs(timing: "Timing") -> list[str]:
    lines = [f"{'ticks/s':>9}{'p99.9, us':>12}{'quarter, us':>13}{'played':>9}"]
    for rung in timing.rungs:
        quarter_us = 1e6 / rung.rate_hz / 4
        lines.append(
            f"{rung.rate_hz:9g}{rung.p999_us:12.1f}{quarter_us:13.1f}{rung.played_hz:9.0f}"
            f"  {shown(phrase('holds') if rung.holds else phrase('does not hold'))}"
        )
    return lines


def _summary(diagnosis: "Diagnosis") -> str:
    states = [finding.state.value for finding in diagnosis.findings]
    bad, warnings = states.count("bad"), states.count("warn")
    if bad:
        return phrase(
            "{bad} of {count} findings are bad, {warnings} are warnings.",
            bad=bad,
            count=len(states),
            warnings=warnings,
        )
    return phrase(
        "Nothing is bad; {warnings} of {count} findings are warnings.",
        warnings=warnings or phrase("no"),
        count=len(states),
    )


# --- for programs --------------------------------------------------------------------------------


def as_dict(diagnosis: "Diagnosis") -> dict[str, Any]:
    """All of it, as one object; a bin without an upper edge has null there."""
    timing = diagnosis.timing
    return {
        "ok": diagnosis.ok,
        "port": diagnosis.port,
        "checks": [
            {
                "name": finding.name,
                "state": finding.state.value,
                "found": finding.found,
                "change": finding.change,
            }
            for finding in diagnosis.findings
        ],
        "timing": {
            "rate_hz": timing.duty.rate_hz,
            "motors": timing.duty.motors,
            "quarter_us": timing.duty.interval_us / 4,
            "runs": [_run_as_dict(run) for run in timing.runs],
            "histogram": _bins_as_dict(timing),
            "ladder": [
                {
                    "rate_hz": rung.rate_hz,
                    "p999_us": rung.p999_us,
                    "played_hz": rung.played_hz,
                    "holds": rung.holds,
                }
                for rung in timing.rungs
            ],
            "highest_rate_hz": timing.highest_hz,
        },
        "advice": list(diagnosis.advice),
    }


def _run_as_dict(run: "Conditions") -> dict[str, Any]:
    result = run.result
    names = ("median_us", "p99_us", "p999_us", "longest_us")
    return {
        "name": run.name,
        "hogs": run.hogs,
        **dict(zip(names, result.percentiles_us(), strict=True)),
        "edges": len(result.late_us),
        "late_edges": result.late_edges(),
        "late_ticks": result.late_ticks,
        "dry_queues": result.dry_queues,
        "played_hz": result.played_hz,
        "holds": run.holds,
        "notes": list(result.notes),
    }


def _bins_as_dict(timing: "Timing") -> dict[str, Any]:
    edges, series = _counts(timing)
    return {
        "edges_us": [None if math.isinf(edge) else edge for edge in edges],
        **dict(series),
    }
