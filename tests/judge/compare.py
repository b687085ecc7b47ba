"""Our interpreter's moves as events, and the comparison with the judge's."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.gcode.interpreter import Interpreter
from fraese.gcode.setup import Setup
from fraese.tooldata import ToolData
from fraese.workframe import Point
from tests.judge.rs274 import INCH_MM, Event, Verdict, judge

# rs274 prints four decimals, also of inches: half a digit is 0.0013 mm, and a position may be
# the sum of a printed place and several printed offsets.
TOLERANCE_MM = 2e-3
SUMMED_TOLERANCE_MM = 6e-3
# What only matters when it changes: nothing is said about doing it once more.
STATES = ("spindle", "coolant", "path", "overrides")
# Refused on purpose, see docs/gcode.md; only what leads there could be compared.
DELIBERATE = ("a rotated coordinate system allows arcs in plane G17 only",)
START_STATES: dict[str, Event] = {
    "spindle": ("spindle", 0, 0.0),
    "coolant": ("coolant", False, False),
    "path": ("path", "G64", 0.0),
    "overrides": ("overrides", True),
}


def our_verdict(
    text: str,
    tools: dict[int, float] | None = None,
    diameters: dict[int, float] | None = None,
    **setup: Any,
) -> Verdict:
    """Our interpreter on the same program, with the judge's probe."""
    wide = diameters or {}
    table = None if tools is None else {n: ToolData(z, wide.get(n, 0.0)) for n, z in tools.items()}
    interpreter = Interpreter(Setup(tools=table, **setup))
    run = interpreter.run(text.splitlines())
    verdict = Verdict()
    answer = None
    at = interpreter.position_mm
    try:
        while True:
            move = run.send(answer)
            answer = None
            if isinstance(move, canon.Probe):
                answer = _short_of(at, move)
                at = answer.position_mm
            elif isinstance(move, canon.Rapid | canon.Feed | canon.Arc):
                at = move.to
            if not isinstance(move, canon.Offsets | canon.Breath):
                verdict.events.append(_event(move))
    except StopIteration:
        return verdict
    except ProgramError as error:
        verdict.refused = str(error)
        return verdict


def _short_of(start: Point, probe: canon.Probe) -> canon.Facts:
    to = probe.to
    length_mm = math.dist(start, to)
    part = 1 - 0.01 * INCH_MM / length_mm if length_mm else 1.0
    stop = tuple(a + (b - a) * part for a, b in zip(start, to, strict=True))
    return canon.Facts(stop, touched=probe.must_touch, contact_mm=to)


def _event(move: canon.Move) -> Event:
    match move:
        case canon.Rapid(_, to):
            return "rapid", to
        case canon.Feed(_, to, feed):
            return "feed", to, feed
        case canon.Arc(_, to, centre, plane, turns, feed):
            return "arc", to, centre, plane, turns, feed
        case canon.Dwell(_, duration_s):
            return "dwell", duration_s
        case canon.Probe(_, to, feed):
            return "probe", to, feed
        case canon.Spindle(_, direction, rev_min):
            return "spindle", direction, rev_min if direction else 0.0
        case canon.Coolant(_, mist, flood):
            return "coolant", mist, flood
        case canon.Tool(_, number):
            return "tool", number
        case canon.Pause(_, optional):
            return "pause", optional
        case canon.Message(_, said, _):
            return "message", said.strip().replace("-0.0000", "0.0000")
        case canon.PathControl(_, mode, tolerance_mm):
            return "path", str(mode), tolerance_mm
        case canon.Output() | canon.Command():
            raise AssertionError("M100 to M199 are not compared: there each means what it likes")
        case canon.Along() | canon.Offsets() | canon.Breath():
            raise AssertionError("rs274 says its own numbers; ours are the machine's")
        case canon.Overrides(_, enabled):
            return "overrides", enabled
        case canon.End():
            return ("end",)


def settled(events: Iterable[Event]) -> list[Event]:
    """Events where a state appears once, just before the first thing that happens in it."""
    said = dict(START_STATES)
    now = dict(START_STATES)
    result: list[Event] = []
    for event in events:
        if event[0] in STATES:
            now[str(event[0])] = event
            continue
        for kind in STATES:
            if not same(now[kind], said[kind], TOLERANCE_MM):
                result.append(now[kind])
                said[kind] = now[kind]
        result.append(event)
    return result


def same(a: object, b: object, tolerance: float) -> bool:
    """Whether two events or parts of them agree."""
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(same(x, y, tolerance) for x, y in zip(a, b, strict=True))
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) <= tolerance + 2e-6 * abs(a)
    return a == b


def differences(ours: Verdict, theirs: Verdict, tolerance: float = TOLERANCE_MM) -> str:
    """The first disagreement in words, or nothing."""
    a, b = settled(ours.events), settled(theirs.events)
    for index, (one, other) in enumerate(zip(a, b, strict=False)):
        if not same(one, other, tolerance):
            return f"event {index}: ours {one}, theirs {other}"
    if bool(ours.refused) != bool(theirs.refused):
        return f"refused: ours {ours.refused!r}, theirs {theirs.refused!r}"
    # A refused line may have done some of its work before.
    if len(a) != len(b) and not ours.refused:
        return f"{len(a)} events, theirs {len(b)}: {(a[len(b) :] or b[len(a) :])[:3]}"
    return ""


def disagreement(
    text: str,
    folder: Path,
    tools: dict[int, float] | None = None,
    tolerance: float = TOLERANCE_MM,
    axes: str = "xyz",
    diameters: dict[int, float] | None = None,
) -> str:
    """Run a program on both sides, on a machine with these axes."""
    ours = our_verdict(text, tools, diameters, axes=axes)
    if any(said in ours.refused for said in DELIBERATE):
        return ""
    return differences(ours, judge(text, folder, tools, axes=axes, diameters=diameters), tolerance)
