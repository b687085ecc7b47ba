"""The simulated mill has facts of its own, and tells what it sees: places, and lost steps."""

from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, assemble
from fraese.assembly.misfits import misfits
from fraese.assembly.trueaxis import true_axes
from fraese.control.controller import Controller
from fraese.control.state import MachineState, Status
from fraese.errors import ConfigError
from tests.helpers import configured, homed, kept, mill, plant

FULL_STEP = {"card": {"table": "full-step"}}
#: Half-steps the other way round.
BACKWARDS = "0D 1C 2D 27 29 38 09 03"
RATES = {"max_rate_hz": 20_000, "start_rate_hz": 3200, "acceleration_hz_s": 80_000}
EIGHTHS: dict[str, Any] = {
    "card": {"kind": "stepdir"},
    "axes": {"x": {"steps_per_rev": 1600, **RATES}},
}


def moved(made: Plant, **to_mm: float) -> MachineState:
    made.controller.move_to(to_mm)
    assert made.controller.run() is Status.OK
    return made.controller.state()


def way_mm(made: Plant, axis: str, by_mm: float) -> float:
    """How far a carriage really goes."""
    motor = made.controller.machine.index(axis)
    before_mm = made.controller.state().carriages_mm[motor]
    made.controller.move_to({axis: by_mm}, relative=True, feed_mm_min=200)
    assert made.controller.run() is Status.OK
    return made.controller.state().carriages_mm[motor] - before_mm


# --- where the carriages are ---------------------------------------------------------------------


@pytest.mark.parametrize(
    "sections",
    [
        {},
        {"card": {"kind": "stepdir"}},
        {"axes": {"x": {"home_end": "max"}, "z": {"home_end": "min"}}},
        {"homing": {"pull_off_mm": 0.05}},
        {
            "axes": {"x": {"inverted": True, "pitch_mm": "5", "gear": "3/2"}},
            "simulation": {"axes": {"x": {"inverted": True, "pitch_mm": "5", "gear": "3/2"}}},
        },
        {
            "card": {"table": BACKWARDS},
            "axes": {name: {"inverted": True} for name in "xyz"},
        },
        {**EIGHTHS, "simulation": {"axes": {"x": {"microsteps": 8}}}},
    ],
    ids=str,
)
def test_a_referenced_machine_that_is_as_configured_is_where_it_says(
    sections: dict[str, Any],
) -> None:
    made = homed(**sections)
    assert made.controller.state().carriages_mm == (0, 0, 0)
    low = made.controller.machine.axes[0].low_mm
    state = moved(made, x=low + 12.5, y=7.25)
    assert state.carriages_mm == state.position_mm
    assert state.lost_steps == (0, 0, 0)
    assert state.lost_why == ("", "", "")
    assert state.message == ""


def test_a_new_machine_stands_in_the_middle_of_its_travel() -> None:
    assert plant().controller.state().carriages_mm == (148, 98, -28)


def test_what_has_no_switches_counts_from_where_it_stood() -> None:
    made = plant(card={"kind": "stepdir"}, axes={"names": ["x", "a"], "x": {"end_switches": False}})
    assert made.controller.state().carriages_mm == (0, 0)
    state = moved(made, x=5, a=370)
    # Half a step of 0.9 degrees is none.
    assert state.carriages_mm == state.position_mm == (5, 369.9)


@pytest.mark.parametrize(
    ("sections", "factor"),
    [
        ({"axes": {"x": {"inverted": True}}}, -1),
        ({"axes": {"x": {"steps_per_rev": 800}}}, 2),
        ({"axes": {"x": {"steps_per_rev": 200}}}, 0.5),
        ({"axes": {"x": {"pitch_mm": "4"}}}, 0.5),
        ({"axes": {"x": {"gear": "2"}}}, 2),
        ({"card": {"table": "full-step"}}, 2),
        ({"card": {"table": BACKWARDS}}, -1),
        ({"simulation": {"full_steps_per_rev": 400}}, 0.5),
        ({"simulation": {"axes": {"x": {"inverted": True}}}}, -1),
        ({"simulation": {"axes": {"x": {"pitch_mm": "5"}}}}, 2.5),
        ({"card": {"kind": "stepdir"}, "simulation": {"axes": {"x": {"microsteps": 4}}}}, 0.5),
        ({"card": {"kind": "stepdir"}, "axes": {"x": {"steps_per_rev": 500}}}, 1.25),
    ],
    ids=str,
)
def test_what_is_configured_wrong_shows_as_a_wrong_place(
    sections: dict[str, Any], factor: float
) -> None:
    made = plant(**sections)
    assert way_mm(made, "x", 10) == pytest.approx(10 * factor)
    assert made.controller.state().lost_steps[0] == 0
    (said,) = [text for text in made.notes if "becomes" in text]
    assert said.startswith("X")
    assert f"1 mm becomes {factor:.4g} mm" in said


def test_a_swapped_plug_moves_the_other_carriage() -> None:
    swapped = {"x": {"motor": 2}, "y": {"motor": 1}}
    made = plant(simulation={"axes": swapped})
    assert moved(made, x=10).carriages_mm == (148, 108, -28)
    assert "X: its motor hangs on socket 2 of the simulated mill, not on 1." in made.notes
    # The same, known to the configuration: the simulated mill is plugged alike.
    assert moved(plant(axes=swapped), x=10).carriages_mm == (158, 98, -28)


def test_the_wrong_end_is_found_by_an_inverted_axis() -> None:
    made = plant(axes={"x": {"inverted": True}})
    made.controller.home(["x"])
    assert made.controller.run() is Status.OK
    state = made.controller.state()
    assert state.position_mm[0] == 0
    assert state.carriages_mm[0] == 296


# --- drives with fine steps ----------------------------------------------------------------------


def test_eighths_of_steps_are_followed_at_20_khz() -> None:
    made = plant(**EIGHTHS)
    state = moved(made, x=40)
    assert state.position_steps[0] == 32_000
    assert state.carriages_mm[0] == 188
    assert state.lost_steps == (0, 0, 0)
    assert made.notes == ()


@pytest.mark.parametrize("microsteps", [1, 2, 5, 8, 10, 25, 125, 256])
def test_however_fine_it_adds_up_exactly(microsteps: int) -> None:
    rates = {"max_rate_hz": 9000, "start_rate_hz": 200, "acceleration_hz_s": 9000}
    made = plant(card={"kind": "stepdir"}, axes={"x": {"steps_per_rev": 200 * microsteps, **rates}})
    for mm in (3.337, -1.113, 0.7):
        state = moved(made, x=mm)
        assert state.lost_steps[0] == 0
        # Between two full steps the angle is what the drive makes of it.
        assert state.carriages_mm[0] - 148 == pytest.approx(state.position_mm[0], abs=1e-5)
    # After whole full steps nothing at all is left of that.
    assert moved(made, x=1).carriages_mm[0] == 149


# --- lost steps ----------------------------------------------------------------------------------


def test_what_the_motor_cannot_follow_is_told() -> None:
    made = plant(**FULL_STEP)
    state = moved(made, x=10)
    assert state.position_steps[0] == 2000
    lost = state.lost_steps[0]
    assert lost > 1900
    # A position is ahead of its carriage by what was lost, here at 0.01 mm a full step.
    assert (state.carriages_mm[0] - 148) / 0.01 == pytest.approx(2000 - lost)
    assert state.message == (
        f"Lost on the simulated mill: X {lost:g} of 2000 steps (too steep: its motor starts and"
        " stops at 3 turns/s and changes its rate by 150 turns/s in a second)."
    )
    assert state.lost_why[0].startswith("too steep")


def test_too_fast() -> None:
    made = plant(axes={"x": {"max_rate_hz": 8000}})
    state = moved(made, x=-40)
    assert state.lost_steps[0] < -4000
    assert state.lost_why == ("too fast: its motor follows up to 15 turns/s", "", "")


def test_blocked_and_told_anew_by_every_job() -> None:
    made = plant()
    mill(made).mill.block(1)
    state = moved(made, y=1)
    assert state.lost_steps == (0, 200, 0)
    assert state.message == "Lost on the simulated mill: Y 200 of 200 steps (blocked)."
    mill(made).mill.block(1, False)
    state = moved(made, x=1)
    assert state.message == ""
    assert state.lost_steps == (0, 0, 0)


def test_at_the_mechanical_end() -> None:
    made = plant(switches={"mode": "ignore"})
    state = moved(made, x=200)
    # The way of 150 mm to the switch, 2 mm behind it.
    assert state.carriages_mm[0] == 300
    assert state.lost_steps[0] == 48 * 200
    assert state.lost_why[0] == "at the mechanical end"


def test_without_current_and_an_axis_that_is_inverted() -> None:
    made = plant(axes={"x": {"inverted": True}}, simulation={"axes": {"x": {"inverted": True}}})
    mill(made).electronics.cut_power()
    state = moved(made, x=3)
    assert state.lost_steps[0] == 600
    assert state.lost_why[0] == "without current"


def test_stopped_dead_it_ran_on() -> None:
    made = plant()
    made.controller.move_to({"x": 60})
    made.controller.set_break_key(made.controller.stop)
    made.controller.run()
    state = made.controller.state()
    assert state.lost_steps[0] == -8
    assert state.lost_why[0].startswith("stopped too suddenly")
    assert state.carriages_mm[0] - 148 == pytest.approx(state.position_mm[0] + 0.04)


def test_a_reference_run_says_why_it_found_no_switch() -> None:
    made = plant(**FULL_STEP)
    made.controller.home()
    assert made.controller.run() is Status.ERROR
    message = made.controller.state().message
    assert "zmax was not found within 66 mm, and steps were lost on the way: look at why" in message
    assert message.count("Lost on the simulated mill: Z ") == 1
    assert "too steep" in message


def test_on_metal_nobody_looks_on() -> None:
    made = plant()
    driver = made.controller._driver
    alone = Controller(made.controller.machine, driver, made.clock, made.config)
    state = alone.state()
    assert state.carriages_mm == state.lost_steps == ()
    assert state.lost_why == ()
    alone.move_to({"x": 1})
    assert alone.run() is Status.OK
    assert alone.state().message == ""


# --- the configuration ---------------------------------------------------------------------------


def test_older_keys_keep_their_meaning() -> None:
    older = {"max_rate_hz": 3000, "jump_hz": 600, "acceleration_hz_s": 20_000}
    simulation = configured(simulation=older).simulation
    assert simulation.max_turns_s == 7.5
    assert simulation.start_turns_s == 1.5
    assert simulation.acceleration_turns_s2 == 50
    for motor in mill(plant(simulation=older)).mill.rotors:
        assert motor.limits.max_rate_hz == 3000
        assert motor.limits.jump_hz == 600
        assert motor.limits.acceleration_hz_s == 20_000


@pytest.mark.parametrize(
    ("simulation", "said"),
    [
        ({"jump_hz": 3, "start_turns_s": 3}, "jump_hz is the older name of start_turns_s"),
        ({"jump_hz": "fast"}, "jump_hz must be a number"),
        ({"max_rate_hz": 0}, "simulation.max_turns_s: "),
        ({"axes": {"a": {}}}, "simulation.axes.a: there is no a in axes.names"),
        ({"axes": {"x": {"pitch_deg": 3}}}, "x is a linear axis; its key is pitch_mm"),
        ({"axes": {"x": {"motor": 2}}}, "the motors of x and y hang on the same socket, 2"),
        ({"axes": {"x": {"pitch": 3}}}, "unknown key simulation.axes.x.pitch; known here: accel"),
        ({"axes": {"q": {}}}, "simulation.axes.q"),
        ({"axes": {"x": {"gear": "0"}}}, "must be a positive number or ratio"),
    ],
    ids=str,
)
def test_what_is_wrong_in_the_simulation_is_said(simulation: dict[str, Any], said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        configured(simulation=simulation)
    assert said in str(caught.value)


def test_one_motor_may_be_another_than_the_others() -> None:
    axes = true_axes(configured(simulation={"max_turns_s": 8, "axes": {"y": {"max_turns_s": 20}}}))
    assert [axis.slide(False).limits.max_rate_hz for axis in axes] == [3200, 8000, 3200]


def test_rates_that_the_simulated_motor_does_not_follow_are_told_beforehand() -> None:
    said = misfits(configured(**FULL_STEP))
    assert any("X, Y, Z: the simulated motor cannot follow: max_rate_hz 4000" in s for s in said)
    assert misfits(configured()) == ()


@pytest.mark.parametrize("kind", ["simulation", "ppdev"])
def test_steps_in_a_turn_that_no_motor_has_with_this_table(kind: str) -> None:
    said = misfits(configured(port={"kind": kind}, axes={"x": {"steps_per_rev": 500}}))
    assert said[0] == (
        "X: steps_per_rev 500 does not suit card.table (8 entries: half-steps, 400 steps_per_rev"
        " for a 200-step motor)."
    )
    # Of a simulated motor nothing is said where there is metal.
    assert len(said) == (2 if kind == "simulation" else 1)


def test_a_mill_with_other_facts_is_a_new_one(tmp_path: Path) -> None:
    assemble(configured(), state=tmp_path).close()
    made = assemble(configured(simulation={"axes": {"x": {"pitch_mm": 5}}}), state=tmp_path)
    assert "the simulated mill as it was otherwise" in made.notes[0]


def test_fine_steps_are_found_as_they_were_left(tmp_path: Path) -> None:
    left = assemble(configured(**EIGHTHS), state=tmp_path)
    before = moved(left, x=1.2345)
    left.close()
    found = assemble(configured(**EIGHTHS), state=tmp_path)
    assert found.controller.state().carriages_mm == before.carriages_mm
    assert found.controller.state().lost_steps == (0, 0, 0)
    state = moved(found, x=2)
    assert state.carriages_mm[0] == 150
    assert kept(tmp_path)["simulation"]


ROTARY: dict[str, Any] = {
    "card": {"kind": "stepdir"},
    "axes": {"names": ["x", "a"], "a": {"gear": "90"}},
}


@pytest.mark.parametrize(
    ("sections", "said"),
    [
        (
            {"simulation": {"axes": {"x": {"travel_mm": "100"}}}},
            "X: travel_mm 300, really 100 on the simulated mill (see simulation.axes).",
        ),
        (
            {"simulation": {"axes": {"x": {"microsteps": 3}}}},
            "X: microsteps in simulation.axes has no effect: no drive makes the steps on smc1500.",
        ),
        (
            ROTARY,
            "A: 1° becomes 90° on the simulated mill (gear 90, really 1; see simulation.axes).",
        ),
        (
            {**ROTARY, "simulation": {"axes": {"a": {"gear": "90", "travel_deg": "90"}}}},
            "A: travel_deg endless, really 90 on the simulated mill (see simulation.axes).",
        ),
    ],
)
def test_every_disagreement_is_said_beforehand(sections: dict[str, Any], said: str) -> None:
    assert misfits(configured(**sections)) == (said,)
