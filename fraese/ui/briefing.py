"""What is said before a program starts: bounds, tools, time, the machine, and what is wrong."""

from collections.abc import Sequence
from dataclasses import dataclass

from fraese.control.state import MachineState, three_decimals
from fraese.ui.programs import Facts
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.status import clock_words, switch_words


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
        place = f"line {self.line}: " if self.line else ""
        return f"{'✗' if self.stops else '!'} {place}{self.text}"


def lines(facts: Facts, state: MachineState, shape: Shape) -> list[Line]:
    """The facts, one below the other.

    Args:
        facts: of the look-through.
        state: of the machine.
        shape: which axes it has.
    """
    return [
        *_bounds(facts, state, shape),
        Line("time", _time(facts, state)),
        Line("tools", _tools(facts, state)),
        Line("spindle", _spindle(facts)),
        Line("stops", _stops(facts, state)),
        _referenced(state),
        Line("switches", _switches(state), "-alarm" if state.switch_closed else ""),
        Line("zero", f"{state.work.system}{state.work.more()}"),
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
        found.append(Problem(0, "Nothing moves in this program.", False))
    lacking = [
        name.upper() for name, known in zip(state.axes, state.referenced, strict=True) if not known
    ]
    if lacking:
        axes = ", ".join(lacking)
        found.append(
            Problem(0, f"{axes} not referenced: nothing knows where the travel ends.", False)
        )
    if state.switch_ignored:
        found.append(Problem(0, "The end switches are ignored: nothing stops at them.", False))
    if news:
        found.append(Problem(0, f"{news} What runs is what it held when it was opened.", False))
    return found


def _bounds(facts: Facts, state: MachineState, shape: Shape) -> list[Line]:
    if facts.low_mm is None or facts.high_mm is None:
        return [Line("bounds", "nothing moves")]
    return [
        _axis(axis, facts.low_mm[i], facts.high_mm[i], state, i)
        for i, axis in enumerate(shape.axes)
    ]


def _axis(axis: AxisShape, low: float, high: float, state: MachineState, index: int) -> Line:
    reach = f"{three_decimals(low)} … {three_decimals(high)}"
    if not state.referenced[index]:
        return Line(axis.letter, f"{reach} from here on; travel not known", "-warn")
    first, last = state.low_mm[index], state.high_mm[index]
    travel = f"{reach} in {first:g} … {last:g}"
    slack = 1e-6
    if low < first - slack or high > last + slack:
        return Line(axis.letter, f"{travel}: OUTSIDE", "-alarm")
    return Line(axis.letter, f"{travel} {axis.unit}", "-good")


def _time(facts: Facts, state: MachineState) -> str:
    if facts.errors or facts.outside:
        return "not known"
    words = clock_words(facts.duration_s)
    if state.override != 1 or state.rapid_override != 1:
        words += f" at 100 % (feed {state.override:.0%}, rapids {state.rapid_override:.0%} now)"
    return words


def _tools(facts: Facts, state: MachineState) -> str:
    tools = facts.wants.tools
    now = f"T{state.work.tool} in the spindle" if state.work.tool else "none known in the spindle"
    return (
        f"{' '.join(f'T{number}' for number in tools)} ({now})" if tools else f"no change ({now})"
    )


def _spindle(facts: Facts) -> str:
    speeds = facts.wants.spindle_rev_min
    if speeds is None:
        return "never switched on"
    low, high = speeds
    return f"{low:g} rev/min" if low == high else f"{low:g} to {high:g} rev/min"


def _stops(facts: Facts, state: MachineState) -> str:
    wants = facts.wants
    said = [f"{wants.stops} for you"] if wants.stops else []
    if wants.optional_stops:
        said.append(
            f"{wants.optional_stops} at M1 ({'stops' if state.optional_stop else 'passed'})"
        )
    if wants.probes:
        said.append(f"probes {wants.probes} times")
    if state.single_block:
        said.append("single block")
    return ", ".join(said) or "none"


def _referenced(state: MachineState) -> Line:
    missing = [
        name.upper() for name, known in zip(state.axes, state.referenced, strict=True) if not known
    ]
    if missing:
        return Line("referenced", f"NOT {' '.join(missing)}: no limits, slower", "-warn")
    return Line("referenced", "all axes", "-good")


def _switches(state: MachineState) -> str:
    said = switch_words(state)
    return f"{said}, IGNORED" if state.switch_ignored else said


def may_start(found: Sequence[Problem]) -> bool:
    """Nothing stops it."""
    return not any(problem.stops for problem in found)
