"""What is measured on a simulated mill is what it is built like."""

from decimal import Decimal
from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.control.calibration.backlash import BacklashTest
from fraese.control.calibration.figures import Bin, Figures
from fraese.control.calibration.repeat import RepeatTest
from fraese.control.calibration.stepsize import StepSizeTest
from fraese.control.calibration.travel import TravelTest
from fraese.control.state import Status
from fraese.errors import HomingError, LimitError, StateError
from tests.helpers import carriages, end, look, merged, mill, plant

ROUGH: dict[str, Any] = {"bounce_readings": 4, "lag_ms": 5}


def built(axis: str = "x", *, rough: bool = False, configured: Any = None, **keys: Any) -> Plant:
    """A mill whose axis is so, whatever it is configured to be."""
    simulation = {**(ROUGH if rough else {}), "axes": {axis: keys}}
    short = {"x": {"travel_mm": 100}, "y": {"travel_mm": 50}}
    return plant(simulation=simulation, axes=merged(short, {axis: configured or {}}))


def done(made: Plant) -> None:
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert look(made).lost_steps == (0, 0, 0)


def answering(made: Plant) -> list[float]:
    """Answers whatever is asked; where the first carriage stood then."""
    at: list[float] = []

    def answer() -> None:
        if made.controller.question:
            at.append(made.controller.state().carriages_mm[0])
            made.controller.answer()

    made.controller.set_break_key(answer)
    return at


class TestTravel:
    @pytest.mark.parametrize(
        ("axis", "travel_mm", "rough"),
        [("x", 92.34, False), ("x", 40.0, True), ("z", 61.5, False)],
    )
    def test_from_end_to_end(self, axis: str, travel_mm: float, rough: bool) -> None:
        made = built(axis, rough=rough, travel_mm=travel_mm)
        test = TravelTest(made.controller, axis)
        assert test.proposal() is None
        test.start()
        done(made)
        assert test.result is not None
        assert test.result.measured_mm == pytest.approx(travel_mm, abs=0.06 if rough else 0.006)
        proposal = test.proposal()
        assert proposal is not None
        (change,) = proposal.changes
        assert change.key == f"axes.{axis}.travel_mm"
        assert change.new == pytest.approx(Decimal(str(travel_mm)), abs=Decimal("0.07"))
        at = made.controller.machine.index(axis)
        assert made.controller.state().referenced[at]
        assert made.controller.state().position_mm[at] == 0

    def test_nothing_is_proposed_where_it_is_right(self) -> None:
        made = built()
        test = TravelTest(made.controller, "y")
        test.start()
        done(made)
        proposal = test.proposal()
        assert proposal is not None
        assert proposal.changes == ()
        assert proposal.words() == "nothing is to be changed"

    def test_an_axis_without_switches_is_refused(self) -> None:
        made = built(configured={"end_switches": False})
        with pytest.raises(LimitError, match=r"X has no end switches \(axes\.x\.end_switches\)"):
            TravelTest(made.controller, "x").start()
        assert carriages(made) == (10_000, 5_000, 6_000)


class TestStepSize:
    @pytest.mark.parametrize(
        ("keys", "configured", "changes"),
        [
            ({"pitch_mm": 5}, {}, {"axes.x.pitch_mm": 5}),
            ({"pitch_mm": 1.25}, {}, {"axes.x.pitch_mm": Decimal("1.25")}),
            ({"inverted": True}, {}, {"axes.x.inverted": True}),
            ({}, {"inverted": True}, {"axes.x.inverted": False}),
            ({"pitch_mm": 5, "inverted": True}, {},
             {"axes.x.pitch_mm": 5, "axes.x.inverted": True}),
            ({"pitch_mm": 2, "backlash_mm": 0.3}, {}, {}),
            ({"pitch_mm": 1.9731}, {}, {"axes.x.pitch_mm": Decimal("1.9731")}),
        ],
    )  # fmt: skip
    def test_what_was_really_made_says_the_pitch(
        self, keys: dict[str, Any], configured: dict[str, Any], changes: dict[str, Any]
    ) -> None:
        made = built(configured=configured, **keys)
        test = StepSizeTest(made.controller, "x")
        at = answering(made)
        test.start(15)
        done(made)
        went_mm = made.controller.state().carriages_mm[0] - at[0]
        found = test.measured(test.commanded_mm, went_mm)
        best = test.proposals()[0]
        assert dict(best.values()) == changes
        assert test.commanded_mm == 15
        turns = 15 / float(made.config.axes.table["x"].pitch)
        true_steps_per_mm = 400 / float(keys.get("pitch_mm", 2))
        assert found.found_steps_per_mm == pytest.approx(true_steps_per_mm, rel=1e-4)
        assert abs(went_mm) == pytest.approx(turns * float(keys.get("pitch_mm", 2)), abs=0.006)

    def test_a_reading_is_taken_for_what_it_is(self) -> None:
        made = built()
        test = StepSizeTest(made.controller, "x")
        test.measured(100, 249.97)
        assert [dict(each.values()) for each in test.proposals()] == [
            {"axes.x.pitch_mm": 5}, {"axes.x.pitch_mm": Decimal("4.9994")}
        ]  # fmt: skip
        assert "a pitch that is made" in test.proposals()[0].why
        test.measured(100, 99.98)
        assert [dict(each.values()) for each in test.proposals()] == [
            {}, {"axes.x.pitch_mm": Decimal("1.9996")}
        ]  # fmt: skip
        assert "in force is right" in test.proposals()[0].why

    def test_what_says_nothing_is_refused(self) -> None:
        made = built()
        test = StepSizeTest(made.controller, "x")
        assert test.proposals() == ()
        for commanded_mm, measured_mm in ((0, 1), (1, 0), (float("nan"), 1)):
            with pytest.raises(LimitError):
                test.measured(commanded_mm, measured_mm)
        for way_mm in (0.0, 0.001, 1000.0, float("inf")):
            with pytest.raises(LimitError):
                test.start(way_mm)
        mill(made).press(end("xmin"))
        with pytest.raises(StateError, match="closed"):
            test.start(10)
        assert carriages(made)[0] == 10_000


class TestBacklash:
    @pytest.mark.parametrize("rough", [False, True])
    @pytest.mark.parametrize("configured_mm", [0, 0.1])
    @pytest.mark.parametrize(("axis", "play_mm"), [("x", 0.12), ("x", 0), ("z", 0.035)])
    def test_by_the_switch(
        self, axis: str, play_mm: float, configured_mm: float, rough: bool
    ) -> None:
        configured = {"backlash_mm": configured_mm}
        made = built(axis, rough=rough, configured=configured, backlash_mm=play_mm)
        test = BacklashTest(made.controller, axis)
        test.start_by_switch(2)
        done(made)
        found = test.facts()
        assert found.figures.readings == pytest.approx((play_mm, play_mm), abs=1e-9)
        proposal = test.proposal()
        assert proposal is not None
        assert dict(proposal.values()) == (
            {} if play_mm == configured_mm else {f"axes.{axis}.backlash_mm": Decimal(str(play_mm))}
        )

    @pytest.mark.parametrize("configured_mm", [0, 0.05])
    @pytest.mark.parametrize("sign", [1, -1])
    def test_by_a_gauge(self, configured_mm: float, sign: int) -> None:
        made = built(configured={"backlash_mm": configured_mm}, backlash_mm=0.12)
        test = BacklashTest(made.controller, "x")
        at = answering(made)
        test.start_by_gauge(sign)
        done(made)
        test.read(made.controller.state().carriages_mm[0] - at[0])
        proposal = test.proposal()
        assert proposal is not None
        assert dict(proposal.values()) == {"axes.x.backlash_mm": Decimal("0.12")}
        with pytest.raises(LimitError, match="more than backlash can be"):
            test.read(6)

    def test_a_switch_that_does_not_open_ends_it(self) -> None:
        made = built()
        test = BacklashTest(made.controller, "x")
        test.start_by_switch()

        def press() -> None:
            if look(made).pressed:
                mill(made).press(end("xmin"))

        made.controller.set_break_key(press)
        assert made.controller.run() is Status.ERROR
        assert isinstance(made.controller.error, HomingError)
        assert "xmin does not open again within 5 mm" in str(made.controller.error)
        assert test.proposal() is None


class TestRepeatability:
    def test_a_good_switch_closes_at_the_same_step(self) -> None:
        made = built(rough=True, backlash_mm=0.1)
        test = RepeatTest(made.controller, "x", approaches=5)
        test.start()
        done(made)
        found = test.facts()
        assert found.made == 5
        assert found.figures.spread == 0
        assert found.words() in made.controller.state().message

    @pytest.mark.parametrize("sign", [-1, 1])
    def test_the_scatter_of_a_bad_one_is_found(self, sign: int) -> None:
        made = built(rough=True, scatter_mm=0.03)
        test = RepeatTest(made.controller, "x", sign, approaches=60)
        test.start()
        done(made)
        found = test.facts()
        assert found.end == ("xmax" if sign > 0 else "xmin")
        assert found.figures.deviation == pytest.approx(0.03, rel=0.3)
        assert 0.09 < found.figures.spread < 0.25
        assert sum(each.count for each in found.figures.bins(found.step_mm)) == 60
        at_mm = made.controller.state().carriages_mm[0]
        assert at_mm == pytest.approx(0 if sign < 0 else 96, abs=0.3), "off the switch"

    def test_the_number_has_bounds(self) -> None:
        for approaches in (1, 1001):
            with pytest.raises(LimitError, match="2 to 1000 times"):
                RepeatTest(built().controller, "x", approaches=approaches)


class TestFigures:
    def test_of_a_few_readings(self) -> None:
        found = Figures((1.0, 2.0, 2.0, 3.0))
        assert (found.mean, found.spread, found.drift) == (2.0, 2.0, 1.0)
        assert found.deviation == pytest.approx(0.8165, abs=1e-4)
        assert found.bins(1.0) == (Bin(-1.5, -0.5, 1), Bin(-0.5, 0.5, 2), Bin(0.5, 1.5, 1))

    def test_of_many_bars_some_are_put_together(self) -> None:
        found = Figures(tuple(n / 10 for n in range(100)))
        bins = found.bins(0.1)
        assert len(bins) <= 16
        assert sum(each.count for each in bins) == 100

    def test_of_none(self) -> None:
        none = Figures(())
        assert (none.mean, none.spread, none.deviation, none.drift) == (0, 0, 0, 0)
        assert none.bins(0.1) == ()
        assert Figures((1.0,)).deviation == 0
