"""What is said before a program starts: bounds, tools, time, the machine, and what is wrong."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from fraese.control.state import MachineState, three_decimals
from fraese.phrases import shown, spoken
from fraese.ui.programs import Facts
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.status import clock_words, contact_words


@dataclass(frozen=True, slots=True)
class Line:
    """One fact.

    Attributes:
        label: what it is about.
        text: the fact.
        tone: "-good", "-warn", "-alarm" or none.
    """

    label: str
    text: str
    tone: str = ""


@dataclass(frozen=True, slots=True)
class Problem:
    """Something that is wrong, or should be known.

    Attributes:
        line: where in the program; 0: nowhere.
        text: a sentence.
        stops: it cannot start so.
    """

    line: int
    text: str
    stops: bool

    @property
    def words(self) -> str:
        """With its sign and place."""
        place = spoken("line {line}: ", line=self.line) if self.line else ""
        return f"{'✗' if self.stops else '!'} {place}{shown(self.text)}"


def lines(
    facts: Facts,
    state: MachineState,
    shape: Shape,
    tried: Collection[str] = (),
    height_map: str = "",
) -> list[Line]:
    """The facts, one below the other.

    Args:
        facts: of the look-through.
        state: of the machine.
        shape: which axes it has.
        tried: names of the end switches that were pressed by hand, and seen.
        height_map: to which it is bent; empty: none.
    """
    return [
        *_bounds(facts, state, shape),
        Line(spoken("time"), _time(facts, state)),
        Line(spoken("tools"), _tools(facts, state)),
        Line(spoken("spindle"), _spindle(facts)),
        Line(spoken("stops"), _stops(facts, state)),
        _referenced(state),
        _switches(state, shape, tried),
        Line(spoken("zero"), f"{state.work.system}{shown(state.work.more())}"),
        *([Line(spoken("map"), shown(height_map))] if height_map else []),
    ]


def problems(facts: Facts, state: MachineState, news: str = "") -> list[Problem]:
    """All that is wrong, what stops it first.

    Args:
        facts: of the look-through.
        state: of the machine.
        news: what became of the file since it was opened; empty: nothing.
    """
    found = [Problem(each.line, each.message, True) for each in (*facts.errors, *facts.outside)]
    found += [Problem(each.line, each.message, False) for each in facts.notes]
    if not facts.errors and facts.low_mm is None:
        found.append(Problem(0, spoken("Nothing moves in this program."), False))
    lacking = [
        name.upper() for name, known in zip(state.axes, state.referenced, strict=True) if not known
    ]
    if lacking:
        axes = ", ".join(lacking)
        found.append(
            Problem(
                0,
                spoken("{axes} not referenced: nothing knows where the travel ends.", axes=axes),
                False,
            )
        )
    if state.switch_ignored:
        found.append(
            Problem(0, spoken("The end switches are ignored: nothing stops at them."), False)
        )
    if news:
        found.append(
            Problem(
                0, spoken("{news} What runs is what it held when it was opened.", news=news), False
            )
        )
    return found


def _bounds(facts: Facts, state: MachineState, shape: Shape) -> list[Line]:
    if facts.low_mm is None or facts.high_mm is None:
        return [Line(spoken("bounds"), spoken("nothing moves"))]
    return [
        _axis(axis, facts.low_mm[i], facts.high_mm[i], state, i)
        for i, axis in enumerate(shape.axes)
    ]


def _axis(axis: AxisShape, low: float, high: float, state: MachineState, index: int) -> Line:
    reach = f"{three_decimals(low)} … {three_decimals(high)}"
    if not state.referenced[index]:
        return Line(axis.letter, spoken("{reach} from here, no limits", reach=reach), "-warn")
    first, last = state.low_mm[index], state.high_mm[index]
    travel = spoken("{reach} in {first:g} … {last:g}", reach=reach, first=first, last=last)
    slack = 1e-6
    if low < first - slack or high > last + slack:
        return Line(axis.letter, spoken("{travel}: OUTSIDE", travel=travel), "-alarm")
    return Line(axis.letter, f"{travel} {axis.unit}", "-good")


def _time(facts: Facts, state: MachineState) -> str:
    if facts.errors or facts.outside:
        return spoken("not known")
    words = clock_words(facts.duration_s)
    if state.override != 1 or state.rapid_override != 1:
        words += spoken(
            " at 100 % (feed {override:.0%}, rapids {rapid_override:.0%} now)",
            override=state.override,
            rapid_override=state.rapid_override,
        )
    return words


def _tools(facts: Facts, state: MachineState) -> str:
    tools = facts.wants.tools
    now = (
        spoken("T{tool} in the spindle", tool=state.work.tool)
        if state.work.tool
        else spoken("none known in the spindle")
    )
    return (
        f"{' '.join(f'T{number}' for number in tools)} ({now})"
        if tools
        else spoken("no change ({now})", now=now)
    )


def _spindle(facts: Facts) -> str:
    speeds = facts.wants.spindle_rev_min
    if speeds is None:
        return spoken("never switched on")
    low, high = speeds
    return (
        spoken("{low:g} rev/min", low=low)
        if low == high
        else spoken("{low:g} to {high:g} rev/min", low=low, high=high)
    )


def _stops(facts: Facts, state: MachineState) -> str:
    wants = facts.wants
    said = [spoken("{stops} for you", stops=wants.stops)] if wants.stops else []
    if wants.optional_stops:
        said.append(
            spoken(
                "{optional_stops} at M1 ({word})",
                optional_stops=wants.optional_stops,
                word=spoken("stops") if state.optional_stop else spoken("passed"),
            )
        )
    if wants.probes:
        said.append(spoken("probes {probes} times", probes=wants.probes))
    if state.single_block:
        said.append(spoken("single block"))
    return ", ".join(said) or spoken("none")


def _referenced(state: MachineState) -> Line:
    missing = [
        name.upper() for name, known in zip(state.axes, state.referenced, strict=True) if not known
    ]
    if missing:
        return Line(
            spoken("referenced"),
            spoken("NOT {missing}: no limits, slower", missing=" ".join(missing)),
            "-warn",
        )
    return Line(spoken("referenced"), spoken("all axes"), "-good")


def _switches(state: MachineState, shape: Shape, tried: Collection[str]) -> Line:
    ends = shape.ends
    said = contact_words(state)
    if state.switch_ignored:
        said = spoken("{said}, IGNORED", said=said)
    count = len(set(ends) & set(tried))
    if ends and not count:
        said = spoken("{said}, none of {ends} tried by hand", said=said, ends=len(ends))
    elif ends:
        said = spoken(
            "{said}, {count} of {ends} tried by hand", said=said, count=count, ends=len(ends)
        )
    is_alarm = state.switch_closed or state.switch_ignored
    tone = "-alarm" if is_alarm else "" if count == len(ends) else "-warn"
    return Line(spoken("switches"), said, tone)


def may_start(found: Sequence[Problem]) -> bool:
    """Nothing stops it."""
    return not any(problem.stops for problem in found)
