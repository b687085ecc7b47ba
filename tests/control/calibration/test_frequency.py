"""The frequency test finds what a motor of the simulated mill follows, and where it resonates."""

from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.control.calibration.frequency import FrequencyTest
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
from fraese.control.state import Status
from fraese.errors import LimitError
from fraese.machine import Axis, Machine
from fraese.motor.rotor import Hindrance
from tests.helpers import after_slices, axes, configured, mill, plant

#: Rates of this motor in steps/s: stalls above 3000, resonates about 1000. From rest it makes eight
#: steps at up to 440: it may jump by 240 and gain 16,000 a second meanwhile.
MOTOR: dict[str, Any] = {
    "start_turns_s": 0.6, "max_turns_s": 7.5, "acceleration_turns_s2": 40,
    "resonances_turns_s": [[2.35, 2.65]],
}  # fmt: skip
CAUTIOUS: dict[str, Any] = {
    "travel_mm": 60, "start_rate_hz": 200, "max_rate_hz": 2000, "acceleration_hz_s": 10_000,
}  # fmt: skip
RATES = Rates(200, 2000, 10_000)


def weak(**simulation: Any) -> Plant:
    return plant(simulation={"axes": {"x": {**MOTOR, **simulation}}}, axes={"x": CAUTIOUS})


def tried(stage: Stage, good: str, *, step: float = 100) -> Outcome:
    """From ``step`` on: a point went well, a cross did not."""
    values = tuple(step * n for n in range(1, len(good) + 1))
    found = [Tried(v, lost_steps=8 * (c == "x")) for v, c in zip(values, good, strict=True)]
    return Outcome(Sweep(stage, values, RATES), tuple(found))


def axis_of(**keys: Any) -> Axis:
    return Machine.from_config(configured(axes={"x": keys})).axes[0]


class TestByTheSwitch:
    def test_everything_from_the_start_on(self) -> None:
        made = weak()
        test = FrequencyTest(made.controller, "x", by_switch=True)
        assert test.proposal() is None
        wishes = {
            Stage.START: Wish(300, 540, 20),
            Stage.CRUISE: Wish(step=100),
            Stage.ACCELERATION: Wish(5000, 32_000, 3000),
        }
        for stage, wish in wishes.items():
            test.start([stage], wish)
            assert made.controller.run() is Status.OK, made.controller.state().message
        found = test.facts().outcomes
        start, cruise, acceleration = (found[stage] for stage in Stage)
        assert start.best is not None
        assert cruise.best is not None
        assert acceleration.best is not None
        assert 0.9 * 440 <= start.best <= 440
        assert 0.95 * 3000 <= cruise.best <= 1.05 * 3000
        assert cruise.stall == pytest.approx(cruise.best, rel=0.05)
        assert acceleration.stall is not None
        assert 10_000 <= acceleration.best <= 40_000
        ((low, high),) = cruise.bands
        assert 850 <= low <= 940
        assert 1060 <= high <= 1150
        proposal = test.proposal()
        assert proposal is not None
        values = dict(proposal.values())
        assert values["axes.x.avoid_hz"] == cruise.bands
        assert 250 <= values["axes.x.start_rate_hz"] <= 310  # type: ignore[operator]
        assert 2000 <= values["axes.x.max_rate_hz"] <= 2250  # type: ignore[operator]
        assert values["axes.x.acceleration_hz_s"] == pytest.approx(acceleration.best / 2, rel=0.05)
        state = made.controller.state()
        assert state.referenced[0]
        assert state.carriages_mm[0] == pytest.approx(0, abs=0.02), "it knows again where it is"
        self.runs_without_a_lost_step({key.split(".")[-1]: each for key, each in values.items()})

    def runs_without_a_lost_step(self, keys: dict[str, Any]) -> None:
        made = plant(simulation={"axes": {"x": MOTOR}}, axes={"x": {**CAUTIOUS, **keys}})
        for feed_mm_min in (None, 320.0, 250.0):
            for way_mm in (25, -25):
                made.controller.move_to({"x": way_mm}, relative=True, feed_mm_min=feed_mm_min)
                made.controller.run()
        assert made.controller.state().lost_steps[0] == 0

    def test_a_switch_that_scatters_is_no_lost_step(self) -> None:
        made = weak(scatter_mm=0.03, backlash_mm=0.2)
        test = FrequencyTest(made.controller, "x", by_switch=True)
        test.start([Stage.START], Wish(100, 200, 10))
        assert made.controller.run() is Status.OK
        outcome = test.facts().outcomes[Stage.START]
        assert [each.lost_steps for each in outcome.tried] == [0] * 11
        assert (outcome.best, outcome.stall, outcome.bands) == (200, None, ())

    def test_stopped_in_the_middle_it_tells_what_it_found(self) -> None:
        made = weak()
        test = FrequencyTest(made.controller, "x", by_switch=True)
        test.start([Stage.CRUISE], Wish(300, 500, 50))

        def stop() -> None:
            outcomes = test.facts().outcomes
            if outcomes and len(outcomes[Stage.CRUISE].tried) == 2:
                made.controller.cancel()

        made.controller.set_break_key(stop)
        assert made.controller.run() is Status.CANCEL
        outcome = test.facts().outcomes[Stage.CRUISE]
        assert [each.value for each in outcome.tried] == [300, 350]
        assert not made.controller.state().referenced[0]
        with pytest.raises(LimitError, match="no end switches"):
            FrequencyTest(
                plant(axes={"x": {"end_switches": False}}).controller, "x", by_switch=True
            ).start()


class TestByEar:
    def test_what_is_marked_counts(self) -> None:
        made = weak()
        test = FrequencyTest(made.controller, "x", by_switch=False, hold_s=0.3)
        rotor = mill(made).mill.rotors[0]

        def listen() -> None:
            """Somebody who hears what the rotor does."""
            if rotor.hindrance is Hindrance.RESONANCE:
                test.mark()
            elif rotor.hindrance is Hindrance.TOO_FAST:
                test.mark_stall()
            rotor.forget()

        made.controller.set_break_key(listen)
        assert test.mark() is None
        test.start([Stage.CRUISE], Wish(700, 4000, 100))
        assert made.controller.run() is Status.OK, made.controller.state().message
        outcome = test.facts().outcomes[Stage.CRUISE]
        assert outcome.bands == ((900, 1100),)
        assert (outcome.best, outcome.stall) == (3000, 3100)
        assert outcome.tried[-1].value == 3100, "a stall ends it"
        assert not made.controller.state().referenced[0]

    def test_a_mark_can_be_taken_back(self) -> None:
        made = weak()
        test = FrequencyTest(made.controller, "x", by_switch=False, hold_s=0.1)
        values: list[float | None] = []
        after_slices(made.controller, 3, lambda: values.append(test.mark()))
        test.start([Stage.START], Wish(100, 200, 50))
        made.controller.run()
        after_slices(made.controller, 1, lambda: values.append(test.unmark()))
        assert values[0] in (100, 150, 200)
        marked = [each.value for each in test.facts().outcomes[Stage.START].tried if each.marked]
        assert marked == values
        assert test.unmark() is None, "when it is over, there is nothing to take back"

    def test_strokes_stay_within_the_travel(self) -> None:
        made = plant(axes=axes(travel_mm=60))
        made.controller.home(["x"])
        made.controller.run()
        made.controller.move_to({"x": 50}, machine_coordinates=True)
        made.controller.run()
        test = FrequencyTest(made.controller, "x", by_switch=False)
        with pytest.raises(LimitError, match=r"The longest stroke is \d+\.\d mm: begin elsewhere"):
            test.start([Stage.CRUISE], Wish(4000, 5000, 100))
        assert made.controller.state().referenced[0], "nothing was tried"


class TestWhatIsTried:
    def test_by_default_round_what_is_configured(self) -> None:
        axis = axis_of()
        sweeps = {stage: usual_sweep(stage, axis, {}, Wish(), 50_000) for stage in Stage}
        assert (sweeps[Stage.START].values[0], sweeps[Stage.START].values[-1]) == (100, 2380)
        assert sweeps[Stage.CRUISE].values[0] == 800
        assert 7800 <= sweeps[Stage.CRUISE].values[-1] <= 8000
        assert sweeps[Stage.ACCELERATION].at(30_000) == Rates(800, 4000, 30_000)
        assert all(30 <= len(sweep.values) <= 60 for sweep in sweeps.values())

    def test_where_there_is_less_room_less(self) -> None:
        sweep = usual_sweep(Stage.CRUISE, axis_of(), {}, Wish(), 2000)
        assert 4000 < sweep.values[-1] < 7000
        assert sweep.at(sweep.values[-1]).way_steps(2000) <= 2000

    def test_a_stroke_gets_up_to_its_rate(self) -> None:
        rates = Rates(800, 4000, 20_000)
        assert rates.way_steps(10_000) == 768 + 2000
        assert rates.way_steps(1500) == 1500
        assert Rates(800, 100, 20_000).way_steps(10_000) == 64
        with pytest.raises(LimitError, match="take a stroke of 1168 steps, and there is room"):
            rates.way_steps(1000)

    @pytest.mark.parametrize(
        "wish", [Wish(5, 4), Wish(0, 4), Wish(-5, 4), Wish(1, 5000, 1), Wish(100, 200, 0),
                 Wish(100, float("inf")), Wish(100, 90_000, 1000), Wish(float("nan"), 5)],
    )  # fmt: skip
    def test_what_makes_no_sense_is_refused(self, wish: Wish) -> None:
        with pytest.raises(LimitError):
            usual_sweep(Stage.CRUISE, axis_of(), {}, wish, 4000)


class TestWhatIsMadeOfIt:
    @pytest.mark.parametrize(
        ("good", "best", "stall", "bands"),
        [
            ("........", 800, None, ()),
            ("......xx", 600, 700, ()),
            ("..xx..xx", 600, 700, ((200, 500),)),
            ("x...x.xx", 600, 700, ((1, 200), (400, 600))),
            ("xxxxxxxx", None, 100, ()),
        ],
    )
    def test_a_sweep(
        self, good: str, best: float | None, stall: float | None, bands: tuple[Any, ...]
    ) -> None:
        outcome = tried(Stage.CRUISE, good)
        assert (outcome.best, outcome.stall, outcome.bands) == (best, stall, bands)
        assert outcome.words().endswith(".")

    def test_of_accelerations_the_first_that_is_lost_is_too_much(self) -> None:
        outcome = tried(Stage.ACCELERATION, "...x....")
        assert (outcome.best, outcome.stall, outcome.bands) == (300, 400, ())

    def test_a_share_of_it_is_proposed(self) -> None:
        axis = axis_of(avoid_hz=[[300, 350], [9000, 9100]])
        outcomes = {
            Stage.START: tried(Stage.START, "..x..xxx"),
            Stage.CRUISE: tried(Stage.CRUISE, "......................xxx", step=200),
        }
        keys = dict.fromkeys(Stage, 1.0)
        values = proposed("x", axis, keys, outcomes).values()
        assert dict(values) == {
            "axes.x.start_rate_hz": 200, "axes.x.max_rate_hz": 3300,
            "axes.x.acceleration_hz_s": 20_000, "axes.x.avoid_hz": ((200, 400),),
        }  # fmt: skip

    def test_what_was_not_found_wrong_stays(self) -> None:
        axis = axis_of()
        keys = {Stage.START: 800.0, Stage.CRUISE: 4000.0, Stage.ACCELERATION: 20_000.0}
        outcomes = {Stage.CRUISE: tried(Stage.CRUISE, ".....", step=1000)}
        assert proposed("x", axis, keys, outcomes).changes == ()

    def test_no_more_bands_than_can_be_written(self) -> None:
        outcome = tried(Stage.CRUISE, ".x." * 12)
        values = proposed("x", axis_of(), dict.fromkeys(Stage, 1.0), {Stage.CRUISE: outcome})
        bands = values.values()["axes.x.avoid_hz"]
        assert isinstance(bands, tuple)
        assert len(bands) <= 8
        assert bands[0][0] == 100
