"""Calibration: the reference run.

    position of one axis, the switch to the left
    |<- switch
    |   <====================  approach until contact
    |  ====>                   back off, slowly, until it opens
    |   <==                    second approach, slowly: the contact that counts
    |   ======>  pull-off: here is machine zero

Rule 1: contact counts are those latched at the first reading, not where the motors came to stand.
Rule 2: every way is bounded; an end that is not found, and a switch that does not open, are errors
        that say what to look at.
Rule 3: closed at the start it may be any switch, or two at once in a corner. The candidates are
        backed off one after the other, then in pairs, each way short; what did not help is undone.
Rule 4: an axis without end switches does not move: where it stands becomes its zero.
Rule 5: a lowered feed override acts on the ways, a raised one on none: behind a switch there is as
        much room as the configured feed needs. None acts where the contact is measured, and off it
        again: how well a switch repeats depends on the feed.
Rule 6: an axis is unreferenced from the start of its run until its zero is set.
"""

from collections.abc import Callable, Generator, Sequence
from itertools import combinations

from fraese import alarms
from fraese.blocks import WatchAction
from fraese.config.work import HomingConfig
from fraese.control.endswitches import EndSwitches
from fraese.control.jobs import STANDSTILL, Demand, Doing, Job
from fraese.control.lines import axis_line
from fraese.control.position import Position
from fraese.errors import HomingError, LimitError
from fraese.machine import Axis, Machine
from fraese.motor.seams import End, Ended, Report
from fraese.phrases import joined, phrase

_Steps = Generator[Demand, Report, Report]


def chosen(home_order: Sequence[str], axes: Sequence[str], machine: Machine) -> list[str]:
    """The axes of a reference run, in its order.

    Args:
        home_order: of the axes with end switches, as configured.
        axes: names; none: all with end switches.
        machine: what axes there are.

    Raises:
        LimitError: if there is nothing to do.
    """
    order = [name for name in home_order if not axes or name in axes]
    order += [name for name in axes if name not in order]
    if not order:
        raise LimitError(
            phrase(
                "No axis has end switches: name those whose present place is to be their"
                " zero, as in home {name}.",
                name=machine.axes[0].name.upper(),
            )
        )
    return order


class Homing:
    """Reference run of one or several axes.

    Args:
        config: ways and feeds.
        position: of the axes; position and reference are set.
        switches: what is looked for.
        say: told what was found.
        lost: says which steps were lost on the way, where that can be seen; else nothing.
        measure: run to the other end too.

    Attributes:
        measured_mm: way from end to end of the axes that were measured, by name.
    """

    def __init__(
        self,
        config: HomingConfig,
        position: Position,
        switches: EndSwitches,
        say: Callable[[str], None],
        lost: Callable[[], str],
        measure: bool,
    ) -> None:
        self._config = config
        self._position = position
        self._machine = position.machine
        self._switches = switches
        self._say = say
        self._lost = lost
        self._measure = measure
        self.measured_mm: dict[str, float] = {}
        # Work offsets that went along, by axis.
        self._carried: dict[str, tuple[str, ...]] = {}

    def job(self, axes: Sequence[str]) -> Job:
        """The run, as a job for the run loop.

        Raises:
            HomingError: from the generator, with the motors at standstill.
        """
        report = yield STANDSTILL
        if report.switch_closed and any(self._axis(name).has_switches for name in axes):
            yield Doing(phrase("a switch is closed: off whichever it is"))
            for _ in range(self._switches.inputs):
                ends = self._switches.ends()
                # Since the last command somebody may have moved a carriage by hand.
                others = self._switches.ends(kept=False) - ends
                yield from self._free(self._order(ends, axes) + self._order(others, axes))
                if not self._switches.closed:
                    break
        said = []
        for name in axes:
            said.append((yield from self._reference(name)))
        carried = [
            phrase(
                "What was set before as {places} of {axis} keeps its place.",
                places=joined(", ", names),
                axis=axis.upper(),
            )
            for axis, names in self._carried.items()
        ]
        referenced = phrase("Referenced: {axes}.", axes=joined(", ", said))
        self._say(joined(" ", [referenced, *carried]))

    # --- one axis ------------------------------------------------------------------------------

    def _axis(self, name: str) -> Axis:
        return self._machine.axes[self._machine.index(name)]

    def _reference(self, name: str) -> Generator[Demand, Report, str]:
        axis = self._axis(name)
        if not axis.has_switches:
            self._set_zero(axis)
            return phrase(
                "{name} (without end switches: where it stands is zero)", name=name.upper()
            )
        sign = axis.home_sign
        self._position.lose_reference([self._machine.index(name)])
        contact = yield from self._find(axis, sign)
        yield from self._pull_off(axis, sign, contact)
        self._set_zero(axis)
        if not self._measure:
            return name.upper()
        yield Doing(phrase("{name}: to the other end", name=name.upper()))
        other = yield from self._find(axis, -sign)
        yield from self._pull_off(axis, -sign, other)
        zero_to_switch = axis.to_steps(self._config.pull_off_mm)
        measured_mm = axis.to_mm(abs(other) + zero_to_switch)
        self.measured_mm[name] = measured_mm
        yield from self._back_to_zero(axis)
        measured = axis.with_unit(f"{measured_mm:.3f}")
        return phrase(
            "{name} (travel {measured}, configured {with_unit})",
            name=name.upper(),
            measured=measured,
            with_unit=axis.with_unit(axis.travel_mm),
        )

    def _set_zero(self, axis: Axis) -> None:
        """Here is its machine zero."""
        if carried := self._position.set_reference(axis.name, 0):
            self._carried[axis.name] = carried

    def _back_to_zero(self, axis: Axis) -> _Steps:
        """The other end may lie outside the soft limits; home is where a reference run ends."""
        yield Doing(phrase("{name}: back to machine zero", name=axis.name.upper()))
        motor = self._machine.index(axis.name)
        distance = -self._position.position_steps[motor]
        yield from axis_line(self._position, motor, distance, None, None, most=1.0)
        return (yield STANDSTILL)

    def _find(self, axis: Axis, sign: int) -> Generator[Demand, Report, int]:
        """Approach, back off, approach slowly; the axis position at contact, in steps."""
        config = self._config
        search_mm = axis.travel_mm * config.search_factor
        end = self._name(axis, sign)
        yield Doing(phrase("{name}: to the switch {end}", name=axis.name.upper(), end=end))
        feed_mm_min = config.approach_mm_min
        report = yield from self._go(axis, sign * search_mm, feed_mm_min, sign, closed=True)
        if report.ended is not Ended.WATCH:
            lost = self._lost()
            on_the_way = (
                phrase(", and steps were lost on the way: look at why, then")
                if lost
                else phrase(": look")
            )
            raise HomingError(
                phrase(
                    "End switch {end} was not found within {with_unit}{on_the_way} at the"
                    " switch and at axes.{name}.{travel_key}; the machine stands at"
                    " {in_words}. {lost}",
                    end=end,
                    with_unit=axis.with_unit(search_mm),
                    on_the_way=on_the_way,
                    name=axis.name,
                    travel_key=axis.travel_key,
                    in_words=self._position.in_words(),
                    lost=lost,
                ).rstrip(),
                end=end,
            )
        yield Doing(
            phrase("{name}: off {end}, slowly, until it opens", name=axis.name.upper(), end=end)
        )
        yield from self._open(axis, sign)
        yield Doing(
            phrase(
                "{name}: slowly to {end} again: this contact counts",
                name=axis.name.upper(),
                end=end,
            )
        )
        report = yield from self._go(
            axis, sign * 2 * config.back_off_max_mm, config.slow_mm_min, sign, closed=True
        )
        if report.ended is not Ended.WATCH:
            raise HomingError(
                phrase(
                    "End switch {end} closed once, but not again within {with_unit}: look"
                    " for a loose switch or wire.",
                    end=end,
                    with_unit=axis.with_unit(2 * config.back_off_max_mm),
                ),
                alarms.END_NOT_AGAIN,
                end=end,
            )
        return self._position.latched_steps(report)[self._machine.index(axis.name)]

    def _open(self, axis: Axis, sign: int) -> _Steps:
        config = self._config
        report = yield from self._go(
            axis, -sign * config.back_off_max_mm, config.slow_mm_min, sign, closed=False
        )
        if report.ended is not Ended.WATCH:
            raise HomingError(
                phrase(
                    "End switch {name} does not open again within {with_unit}: {wire}",
                    name=self._name(axis, sign),
                    with_unit=axis.with_unit(config.back_off_max_mm),
                    wire=self._wire(self._end(axis, sign)),
                ),
                alarms.END_STUCK,
                end=self._name(axis, sign),
            )
        return report

    def _pull_off(self, axis: Axis, sign: int, contact: int) -> _Steps:
        """From the contact to the pull-off distance; the switch opens on the way."""
        way = axis.with_unit(self._config.pull_off_mm)
        yield Doing(
            phrase(
                "{name}: {way} off {name_2}",
                name=axis.name.upper(),
                way=way,
                name_2=self._name(axis, sign),
            )
        )
        index = self._machine.index(axis.name)
        target = contact - sign * axis.to_steps(self._config.pull_off_mm)
        distance = target - self._position.position_steps[index]
        end = self._end(axis, sign)
        watch = self._switches.watch(closed=False, action=WatchAction.IGNORE, end=end)
        feed_mm_min = self._config.approach_mm_min
        yield from axis_line(self._position, index, distance, feed_mm_min, watch, most=1.0)
        report = yield STANDSTILL
        if self._switches.shows(end):
            raise HomingError(
                phrase(
                    "End switch {name} is still closed at the pull-off distance of"
                    " {with_unit}: make homing.pull_off_mm longer, or {wire}",
                    name=self._name(axis, sign),
                    with_unit=axis.with_unit(self._config.pull_off_mm),
                    wire=self._wire(end),
                ),
                alarms.END_AT_PULL_OFF,
                end=self._name(axis, sign),
            )
        return report

    # --- closed at the start -------------------------------------------------------------------

    def _free(self, candidates: list[End]) -> Generator[Demand, Report, None]:
        """Back off candidates until the switch opens."""
        reach_mm = self._config.resolve_mm
        for size in range(1, len(self._machine.axes) + 1):
            for ends in combinations(candidates, size):
                if len({end.motor for end in ends}) < size:
                    continue
                if (yield from self._try(ends, reach_mm)):
                    return
        names = ", ".join(self._switches.name(end) for end in candidates)
        raise HomingError(
            phrase(
                "The end switch is closed and does not open within {reach_mm:g} mm of any of"
                " {names}: {wire}",
                reach_mm=reach_mm,
                names=names,
                wire=self._wire(candidates[0]),
            ),
            alarms.END_UNKNOWN,
            ends=[self._switches.name(end) for end in candidates],
        )

    def _try(self, ends: tuple[End, ...], reach_mm: float) -> Generator[Demand, Report, bool]:
        """Move away from these ends in turn; True when it opens, else everything is undone."""
        made = []
        for end in ends:
            axis = self._machine.axes[end.motor]
            before = self._position.position_steps[end.motor]
            report = yield from self._go(
                axis, -end.sign * reach_mm, self._config.slow_mm_min, end.sign, closed=False
            )
            if report.ended is Ended.WATCH:
                return True
            made.append((axis, end.sign, before - self._position.position_steps[end.motor]))
        for axis, sign, distance in reversed(made):
            yield from self._go(
                axis, axis.to_mm(distance), self._config.approach_mm_min, sign, closed=False
            )
        return False

    def _order(self, candidates: frozenset[End], axes: Sequence[str]) -> list[End]:
        """Home ends of the axes to be referenced first: there a mill is left most often."""

        def rank(end: End) -> tuple[bool, int, End]:
            axis = self._machine.axes[end.motor]
            place = axes.index(axis.name) if axis.name in axes else len(axes)
            return (end.sign != axis.home_sign, place, end)

        return sorted(candidates, key=rank)

    # --- moving --------------------------------------------------------------------------------

    def _go(
        self, axis: Axis, distance_mm: float, feed_mm_min: float, sign: int, *, closed: bool
    ) -> _Steps:
        """Move until the switch of an end is closed (or open), at most so far, to standstill."""
        index = self._machine.index(axis.name)
        distance = axis.to_steps(distance_mm)
        end = self._end(axis, sign)
        watch = self._switches.watch(closed=closed, action=WatchAction.STOP, end=end)
        most = 0.0 if feed_mm_min == self._config.slow_mm_min else 1.0
        yield from axis_line(self._position, index, distance, feed_mm_min, watch, most)
        return (yield STANDSTILL)

    def _name(self, axis: Axis, sign: int) -> str:
        return self._switches.name(self._end(axis, sign))

    def _end(self, axis: Axis, sign: int) -> End:
        return End(self._machine.index(axis.name), sign)

    def _wire(self, end: End) -> str:
        return phrase(
            "look for a stuck switch, and at the wire to DB25 pin {pin}.",
            pin=self._switches.pin_of(end),
        )
