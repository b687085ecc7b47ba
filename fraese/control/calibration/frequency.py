"""The frequency test (X4Step's A): a motor is driven to and fro at one rate after the other.

    by ear                                  by switch
    there and back, for a while             |<- switch     |---stroke--->|
    somebody marks what he hears            |<===========================|   where is it?

Rule 1: a stroke is as long as its rate needs: up to it, some time at it, down again.
Rule 2: by switch, a motor that lost steps finds its switch elsewhere. Its way back is slow, so that
        it loses nothing there.
Rule 3: whoever tries where a motor stalls does not know afterwards where its axis is: it is not
        referenced from the start on. By switch it is referenced at the end.
Rule 4: marks come from any thread, and belong to the value that is tried then.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from fraese.anythread import any_thread
from fraese.blocks import dwell
from fraese.control.calibration.figures import Figures
from fraese.control.calibration.moves import AxisMoves, Count, Moves, with_rates
from fraese.control.calibration.proposal import Proposal
from fraese.control.calibration.sweep import (
    Outcome,
    Rates,
    Stage,
    Sweep,
    Tried,
    Wish,
    proposed,
    usual_sweep,
)
from fraese.control.controller import Controller
from fraese.control.homing import Homing
from fraese.control.jobs import STANDSTILL, Doing, Job
from fraese.control.softlimits import require_reachable
from fraese.errors import LimitError
from fraese.phrases import phrase

#: How often the switch is met before anything is tried, to see how well it repeats.
_FIRST_LOOKS: Final = 4
#: What is further off than so many times its spread is no matter of the switch.
_BEYOND_SPREAD: Final = 3
#: Steps in an electrical turn where nobody knows.
_TURN_STEPS: Final = 8
#: By ear, how long a value is heard.
HOLD_S: Final = 2.0
#: From where the switch has opened to where a stroke begins.
_CLEAR_MM: Final = 0.5
#: Before and after a stroke.
_REST_S: Final = 0.1
_AS_USUAL: Final = Wish()


@dataclass(frozen=True, slots=True)
class Progress:
    """How far it is.

    Attributes:
        axis: its name.
        by_switch: whether the switch tells of lost steps.
        stage: what is tried now; None: nothing yet.
        value: what is tried now.
        values: all that are to be tried in this stage.
        outcomes: what was found, this stage's so far with it.
    """

    axis: str
    by_switch: bool
    stage: Stage | None
    value: float
    values: tuple[float, ...]
    outcomes: Mapping[Stage, Outcome]

    def as_dict(self) -> dict[str, Any]:
        """For programs."""
        found = [outcome.as_dict() for outcome in self.outcomes.values()]
        return {"by_switch": self.by_switch, "stages": found}


class _Run:
    """One stage as it is tried.

    Attributes:
        sweep: what is tried.
        value: now.
        tried: so far, without marks.
        marks: values that somebody marked; written by him alone.
        stalled: he ended it.
    """

    def __init__(self, sweep: Sweep) -> None:
        self.sweep = sweep
        self.value = sweep.values[0]
        self.tried: tuple[Tried, ...] = ()
        self.marks: frozenset[float] = frozenset()
        self.stalled = False

    def outcome(self) -> Outcome:
        """With the marks."""
        marks = self.marks
        return Outcome(
            self.sweep, tuple(replace(each, marked=each.value in marks) for each in self.tried)
        )


class FrequencyTest:
    """Finds out what the motor of one axis can follow.

    Args:
        controller: of the machine.
        axis: name.
        by_switch: let the end switch tell of lost steps; else a person marks them.
        hold_s: by ear, how long each value is heard.

    Attributes:
        by_switch: as given.
    """

    def __init__(
        self, controller: Controller, axis: str, *, by_switch: bool, hold_s: float = HOLD_S
    ) -> None:
        self._controller = controller
        self._moves = AxisMoves(controller, axis)
        self.by_switch = by_switch
        self._hold_s = hold_s
        self._rest = dwell(len(controller.machine.axes), _REST_S)
        self._runs: dict[Stage, _Run] = {}
        self._run: _Run | None = None
        self._tolerance_steps = 0.0
        self._contact = 0

    # --- from any thread -----------------------------------------------------------------------

    @any_thread
    def mark(self) -> float | None:
        """The motor resonates at the value that is tried now; which one that is; None: none."""
        run = self._run
        if run is None:
            return None
        run.marks |= {run.value}
        return run.value

    @any_thread
    def mark_stall(self) -> float | None:
        """The motor stands at the value that is tried now: this stage is over."""
        run = self._run
        if run is None:
            return None
        run.stalled = True
        return self.mark()

    @any_thread
    def unmark(self) -> float | None:
        """The last mark was a mistake; which one that was."""
        run = self._run
        if run is None or not run.marks:
            return None
        last = max(run.marks)
        run.marks -= {last}
        return last

    @any_thread
    def facts(self) -> Progress:
        """How far it is."""
        run = self._run
        return Progress(
            self._moves.axis.name,
            self.by_switch,
            run.sweep.stage if run else None,
            run.value if run else 0.0,
            run.sweep.values if run else (),
            {stage: each.outcome() for stage, each in tuple(self._runs.items())},
        )

    @any_thread
    def proposal(self) -> Proposal | None:
        """What the configuration should say; None: nothing was tried."""
        outcomes = {
            stage: outcome for stage, outcome in self.facts().outcomes.items() if outcome.tried
        }
        if not outcomes:
            return None
        name = self._moves.axis.name
        config = self._controller.config.axes.table[name]
        keys = {
            Stage.START: config.start_rate_hz,
            Stage.CRUISE: config.max_rate_hz,
            Stage.ACCELERATION: config.acceleration_hz_s,
        }
        return proposed(name, self._moves.axis, keys, outcomes)

    # --- the job -------------------------------------------------------------------------------

    def start(self, stages: Sequence[Stage] = tuple(Stage), wish: Wish = _AS_USUAL) -> None:
        """Try these stages; the controller's ``run`` does it.

        Args:
            stages: one after the other; each goes on from what the one before has found.
            wish: what is to be tried otherwise than usual.

        Raises:
            LimitError: if there is no room for it, or no switch where one is to tell.
            StateError: if the machine is not ready.
        """
        moves = self._moves
        if self.by_switch:
            moves.require_switches()
        else:
            self._controller.check_moves([])
        # What is refused is refused before anything moves.
        first = self._usual(stages[0], wish)
        if not self.by_switch:
            self._require_room(first)
        name = moves.axis.name.upper()
        self._controller.start(
            phrase("frequency test of {name}", name=name), self._job(stages, wish)
        )

    def _usual(self, stage: Stage, wish: Wish) -> Sweep:
        # What was found before in this stage is tried anew.
        found = {each: run.outcome() for each, run in self._runs.items() if each is not stage}
        return usual_sweep(stage, self._moves.axis, found, wish, self._room_steps())

    def _room_steps(self) -> int:
        """The longest stroke that there is room for."""
        axis, homing = self._moves.axis, self._controller.config.homing
        if axis.is_endless:
            return axis.high_steps
        return axis.to_steps(axis.travel_mm - 2 * homing.pull_off_mm - _CLEAR_MM)

    def _require_room(self, sweep: Sweep) -> None:
        """See that the strokes, from where it stands, stay within the travel."""
        where, axis = self._controller.position, self._moves.axis
        longest = max(sweep.at(value).way_steps(self._room_steps()) for value in sweep.values)
        target = list(where.position_steps)
        target[self._moves.motor] += self._away * longest
        try:
            require_reachable(where, [tuple(target)])
        except LimitError as error:
            way = axis.with_unit(f"{axis.to_mm(longest):.1f}")
            raise LimitError(
                phrase(
                    "{error} The longest stroke is {way}: begin elsewhere, or try lower rates.",
                    error=error,
                    way=way,
                )
            ) from error

    @property
    def _away(self) -> int:
        """Direction of the strokes: from the end to which the axis is referenced."""
        return -self._moves.axis.home_sign

    def _job(self, stages: Sequence[Stage], wish: Wish) -> Job:
        moves = self._moves
        self._controller.position.lose_reference([moves.motor])
        if self.by_switch:
            yield from self._look_at_switch()
        for stage in stages:
            run = _Run(self._usual(stage, wish))
            self._runs[stage] = self._run = run
            yield from self._try_all(run)
        self._run = None
        if self.by_switch:
            yield from moves.leave(moves.axis.home_sign)
            yield from self._reference()

    def _reference(self) -> Job:
        controller = self._controller
        homing = Homing(
            controller.config.homing,
            controller.position,
            controller.switches,
            controller.say,
            lambda: "",
            measure=False,
        )
        yield from homing.job([self._moves.axis.name])

    def _try_all(self, run: _Run) -> Job:
        for value in run.sweep.values:
            run.value = value
            yield Doing(
                phrase(
                    "{stage}: {value:g} {unit}",
                    stage=run.sweep.stage.value,
                    value=value,
                    unit=run.sweep.stage.unit,
                )
            )
            late_before = self._controller.state().late_ticks
            rates = run.sweep.at(value)
            way = rates.way_steps(self._room_steps())
            lost = 0
            if self.by_switch:
                lost = yield from self._by_the_switch(rates, way)
            else:
                yield from self._by_ear(run, rates, way)
            late = self._controller.state().late_ticks > late_before
            run.tried = (*run.tried, Tried(value, lost, late=late))
            if run.stalled:
                return

    def _stroke(self, rates: Rates, steps: int) -> Moves:
        """From rest to rest: the rotor has come to stand before it, and comes to stand after it."""
        axis = with_rates(self._moves.axis, rates.start_hz, rates.rate_hz, rates.acceleration_hz_s)
        yield self._rest
        yield from self._moves.go(steps, axis=axis)
        yield self._rest
        return (yield STANDSTILL)

    # --- by ear --------------------------------------------------------------------------------

    def _by_ear(self, run: _Run, rates: Rates, way: int) -> Job:
        """There and back until it was heard for long enough, or somebody has heard enough."""
        heard_s = 0.0
        while heard_s < self._hold_s and not run.stalled:
            for sign in (self._away, -self._away):
                yield from self._stroke(rates, sign * way)
            heard_s += 2 * way / rates.rate_hz

    # --- by switch -----------------------------------------------------------------------------

    @property
    def _check_mm_min(self) -> float:
        """Slow enough that nothing is lost, as far as the configuration knows."""
        axis = self._moves.axis
        half_start_mm_min = 60 * axis.start_rate_hz / 2 * axis.step_mm
        return max(self._controller.config.homing.slow_mm_min, half_start_mm_min)

    def _look_at_switch(self) -> Job:
        """Where it closes, and how far that can be relied on."""
        moves, sign = self._moves, self._moves.axis.home_sign
        back_off_mm = self._controller.config.homing.back_off_max_mm
        yield from moves.find(sign)
        found = []
        for _ in range(_FIRST_LOOKS):
            yield from self._get_clear()
            found.append((yield from moves.to_contact(sign, 2 * back_off_mm, self._check_mm_min)))
        self._contact = found[-1]
        turn = self._controller.position.turn_steps[moves.motor] or _TURN_STEPS
        spread = Figures(tuple(map(float, found))).spread
        self._tolerance_steps = max(turn / 2, _BEYOND_SPREAD * spread)

    def _get_clear(self) -> Job:
        """Off the switch, and beyond the backlash."""
        axis = self._moves.axis
        yield from self._moves.off_contact(axis.home_sign)
        steps = self._away * (axis.backlash_steps + axis.to_steps(_CLEAR_MM))
        yield from self._moves.go(steps, self._check_mm_min)

    def _by_the_switch(self, rates: Rates, way: int) -> Count:
        """Off the switch, a stroke away from it, slowly back to it; steps that were lost.

        There and back at the same rate, a motor that stands still would lose nothing.
        """
        moves, sign, feed = self._moves, self._moves.axis.home_sign, self._check_mm_min
        yield from self._get_clear()
        yield from self._stroke(rates, self._away * way)
        longest_mm = moves.axis.to_mm(2 * way) + 2 * self._controller.config.homing.back_off_max_mm
        contact = yield from moves.to_contact(sign, longest_mm, feed)
        lost, self._contact = contact - self._contact, contact
        return abs(lost) if abs(lost) >= self._tolerance_steps else 0
