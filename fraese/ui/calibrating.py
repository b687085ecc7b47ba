"""Calibration as the app does it: routines by name, the one in hand, and what it has found.

Rule 1: a routine is made and started in the machine's thread; what it has found is read from any.
Rule 2: what was found stays until the same routine is begun anew, also when another view is seen.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Protocol

from fraese.control.calibration.backlash import BacklashTest
from fraese.control.calibration.frequency import FrequencyTest
from fraese.control.calibration.proposal import Proposal, Value
from fraese.control.calibration.repeat import RepeatTest
from fraese.control.calibration.stepsize import StepSizeTest
from fraese.control.calibration.sweep import Stage, Wish
from fraese.control.calibration.travel import TravelTest
from fraese.control.controller import Controller
from fraese.phrases import spoken

Test = BacklashTest | FrequencyTest | RepeatTest | StepSizeTest | TravelTest


class Writer(Protocol):
    """Writes the configuration file."""

    @property
    def path(self) -> str:
        """Of the file that counts, or that would be made."""

    def write(self, values: Mapping[str, Value | None]) -> None:
        """Change these keys; None takes a key away.

        Raises:
            ConfigError: if it cannot; the file is unchanged.
        """


@dataclass(frozen=True, slots=True)
class Routine:
    """One of the things that can be done.

    Attributes:
        name: as its key's action names it.
        title: for people.
        what: what it does, before it moves.
        by_switch: it needs end switches.
    """

    name: str
    title: str
    what: str
    by_switch: bool = False


ROUTINES: Final = {
    each.name: each
    for each in (
        Routine(
            "reference",
            spoken("Reference run"),
            spoken(
                "Each axis runs to its end switch, backs off, and comes back slowly: that"
                " contact counts. Machine zero is at the pull-off distance from it. An axis"
                " without switches is referenced where it stands."
            ),
        ),
        Routine(
            "travel",
            spoken("Measure travel"),
            spoken(
                "{{axis}} is referenced at {{home}}, then runs to the other end switch and"
                " back to machine zero. The way from contact to contact is its travel."
            ),
            by_switch=True,
        ),
        Routine(
            "steps",
            spoken("Steps per mm"),
            spoken(
                "{{axis}} runs in by a little, so that no backlash is in the way, and waits"
                " for you to mark where it stands. Then it makes the way. Measure how far it"
                " really went."
            ),
        ),
        Routine(
            "backlash",
            spoken("Backlash by switch"),
            spoken(
                "{{axis}} creeps into {{home}} until it closes and out again until it opens."
                " What the motor turns in vain is the backlash; what the switch itself needs"
                " is in it."
            ),
            by_switch=True,
        ),
        Routine(
            "gauge",
            spoken("Backlash by dial gauge"),
            spoken(
                "{{axis}} moves forward and waits for you to set a dial gauge to zero. Then"
                " it moves forward and the same way back. What the gauge shows is the"
                " backlash."
            ),
        ),
        Routine(
            "repeat",
            spoken("Repeat a switch"),
            spoken(
                "{{axis}} approaches its end switch again and again, as a reference run"
                " does. How far the contacts lie apart says how well it repeats."
            ),
            by_switch=True,
        ),
        Routine(
            "frequency",
            spoken("Frequency test"),
            spoken(
                "The motor of {{axis}} is driven at one rate after the other, until it"
                " stalls: take the tool out. {{axis}} is not referenced any more then,"
                " unless its switch tells of lost steps."
            ),
        ),
        Routine(
            "switches",
            spoken("Switch test"),
            spoken("You press each end switch by hand, and see that it arrives. Nothing moves."),
        ),
    )
}
STAGES: Final = {"start": Stage.START, "cruise": Stage.CRUISE, "acceleration": Stage.ACCELERATION}


class Calibration:
    """What is calibrated, and what was found.

    Args:
        order: hands something that wants the controller to the machine's thread; False: it was not
            taken.

    Attributes:
        tests: of each routine, by its name, the last one that was begun.
        last: name of the routine that was begun last; empty: none.
        axis: of it.
    """

    def __init__(self, order: Callable[[Callable[[Controller], object]], bool]) -> None:
        self._order = order
        self.tests: dict[str, Test] = {}
        self.last = self.axis = ""
        self._chosen = 0

    def _begin(self, name: str, axis: str, make: Callable[[Controller], Test]) -> bool:
        """Make and start it; told as begun only when it was not refused."""

        def begin(controller: Controller) -> None:
            test = make(controller)
            self.tests[name] = test
            self.last, self.axis, self._chosen = name, axis, 0

        return self._order(begin)

    # --- what can be begun -----------------------------------------------------------------------

    def travel(self, axis: str) -> bool:
        """From end to end."""

        def make(controller: Controller) -> Test:
            test = TravelTest(controller, axis)
            test.start()
            return test

        return self._begin("travel", axis, make)

    def steps(self, axis: str, way_mm: float) -> bool:
        """A way that is to be measured."""

        def make(controller: Controller) -> Test:
            test = StepSizeTest(controller, axis)
            test.start(way_mm)
            return test

        return self._begin("steps", axis, make)

    def backlash(self, axis: str, times: int) -> bool:
        """By the switch."""

        def make(controller: Controller) -> Test:
            test = BacklashTest(controller, axis)
            test.start_by_switch(times)
            return test

        return self._begin("backlash", axis, make)

    def gauge(self, axis: str) -> bool:
        """By a dial gauge."""

        def make(controller: Controller) -> Test:
            test = BacklashTest(controller, axis)
            test.start_by_gauge()
            return test

        return self._begin("gauge", axis, make)

    def repeat(self, axis: str, sign: int | None, times: int) -> bool:
        """Approach a switch so often."""

        def make(controller: Controller) -> Test:
            test = RepeatTest(controller, axis, sign, times)
            test.start()
            return test

        return self._begin("repeat", axis, make)

    def frequency(self, axis: str, stage: Stage | None, wish: Wish, *, by_switch: bool) -> bool:
        """Rates and accelerations; without a stage, all of them."""

        def make(controller: Controller) -> Test:
            before = self.tests.get("frequency")
            again = isinstance(before, FrequencyTest) and before.facts().axis == axis
            same = again and isinstance(before, FrequencyTest) and before.by_switch == by_switch
            # What an earlier stage has found is the next one's ground.
            test = before if same else FrequencyTest(controller, axis, by_switch=by_switch)
            assert isinstance(test, FrequencyTest)
            test.start([stage] if stage else tuple(Stage), wish)
            return test

        return self._begin("frequency", axis, make)

    # --- what was found --------------------------------------------------------------------------

    @property
    def test(self) -> Test | None:
        """The one that was begun last."""
        return self.tests.get(self.last)

    @property
    def frequency_test(self) -> FrequencyTest | None:
        """The frequency test, if it was the last."""
        test = self.test
        return test if isinstance(test, FrequencyTest) else None

    @property
    def proposals(self) -> tuple[Proposal, ...]:
        """What the configuration should say of the last one, the likeliest first."""
        test = self.test
        if test is None or isinstance(test, RepeatTest):
            return ()
        if isinstance(test, StepSizeTest):
            return test.proposals()
        proposal = test.proposal()
        return (proposal,) if proposal else ()

    @property
    def proposal(self) -> Proposal | None:
        """The one that is chosen."""
        all_ = self.proposals
        return all_[self._chosen % len(all_)] if all_ else None

    def choose(self, by: int) -> None:
        """Another one."""
        self._chosen += by
