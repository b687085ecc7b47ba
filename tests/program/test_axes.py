"""Machines of one to four axes, worked with from end to end; the carriages tell the truth."""

from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant, assemble
from fraese.control.state import Status
from fraese.errors import FraeseError, LimitError
from fraese.program.program import open_program
from tests.helpers import carriages, configured, look, mill, plant

STEPDIR = {"card": {"kind": "stepdir"}}
#: 100 steps a degree.
WORM = {"gear": "90"}

MACHINES: dict[str, dict[str, Any]] = {
    "stepdir X": {**STEPDIR, "axes": {"names": ["x"]}},
    "stepdir X Z": {**STEPDIR, "axes": {"names": ["x", "z"]}},
    "stepdir X Y Z A": {
        **STEPDIR,
        "axes": {"names": ["x", "y", "z", "a"], "a": WORM},
        "simulation": {"axes": {"a": WORM}},
    },
    "stepdir swapped": {
        **STEPDIR,
        "axes": {
            "names": ["z", "a", "x", "y"],
            "z": {"motor": 4},
            "a": {**WORM, "motor": 3, "inverted": True},
            "x": {"motor": 1},
            "y": {"motor": 2, "inverted": True},
        },
        "simulation": {"axes": {"a": {**WORM, "inverted": True}, "y": {"inverted": True}}},
    },
    "smc1500 Y": {"axes": {"names": ["y"]}},
    "smc1500 X Z": {"axes": {"names": ["x", "z"], "x": {"motor": 3}, "z": {"motor": 1}}},
    "smc1500 Z X, full steps": {
        "card": {"table": "full-step"},
        "axes": {
            "names": ["z", "x"],
            "z": {"steps_per_rev": 200, "max_rate_hz": 2000, "start_rate_hz": 300},
            "x": {"steps_per_rev": 200, "max_rate_hz": 2000, "start_rate_hz": 300},
        },
    },
}
every_machine = pytest.mark.parametrize("kind", MACHINES)


def done(made: Plant) -> None:
    status = made.controller.run()
    assert status is Status.OK, made.controller.state().message


def at(made: Plant) -> dict[str, float]:
    """Where the carriages are, in machine coordinates of the axes; a new rotary one is at zero."""
    config, places = made.config, {}
    for axis, steps in zip(made.controller.machine.axes, carriages(made), strict=True):
        half_steps = 8 / len(mill_table(made))
        value = axis.motor_sign * steps / half_steps / float(axis.steps_per_mm)
        if axis.has_switches:
            travel = axis.travel_mm
            from_low = value if axis.motor_sign > 0 else travel + value
            pull_off = config.homing.pull_off_mm
            value = from_low - pull_off if axis.home_sign < 0 else from_low - travel + pull_off
        places[axis.name] = value
    return places


def mill_table(made: Plant) -> bytes:
    return bytes(4 if made.config.card.table == "full-step" else 8)


def stands_at(made: Plant, **wanted: float) -> None:
    """Carriages, position and word are one."""
    state = made.controller.state()
    assert dict(zip(state.axes, state.position_mm, strict=True)) == pytest.approx(wanted, abs=0.006)
    assert at(made) == pytest.approx(wanted, abs=0.011)
    # Without a switch a carriage counts from where it stood when the mill was new: here zero too.
    assert dict(zip(state.axes, state.carriages_mm, strict=True)) == pytest.approx(at(made))
    assert mill(made).mill.lost_steps() == (0.0,) * len(state.axes)


def place_of(made: Plant, value: float) -> dict[str, float]:
    """A point within the travel: downwards from zero on Z."""
    return {name: -value if name == "z" else value for name in made.controller.machine.names}


def referenced(kind: str) -> Plant:
    made = plant(**MACHINES[kind])
    made.controller.home()
    done(made)
    return made


@every_machine
def test_home_by_itself_leaves_out_what_has_no_switches(kind: str) -> None:
    made = referenced(kind)
    names = made.controller.machine.names
    assert made.controller.state().referenced == tuple(name != "a" for name in names)
    stands_at(made, **dict.fromkeys(names, 0.0))


@every_machine
def test_move_and_jog(kind: str) -> None:
    made = referenced(kind)
    there = place_of(made, 12.5)
    made.controller.move_to(there)
    done(made)
    stands_at(made, **there)
    for name in made.controller.machine.names:
        made.controller.jog(name, -1.5)
        done(made)
        there[name] -= 1.5
        stands_at(made, **there)


@every_machine
def test_a_coordinate_in_work_coordinates_and_the_state_over_a_restart(
    kind: str, tmp_path: Path
) -> None:
    config = configured(**MACHINES[kind])
    made = assemble(config, state=tmp_path)
    made.controller.home()
    done(made)
    there = place_of(made, 7.0)
    made.controller.move_to(there)
    done(made)
    made.controller.set_zero(made.controller.machine.names)
    made.close()
    again = assemble(config, state=tmp_path)
    assert not again.notes
    assert again.controller.state().referenced == made.controller.state().referenced
    assert again.controller.state().work_mm == (0.0,) * len(there)
    stands_at(again, **there)
    again.controller.move_to(place_of(again, 1.0))
    done(again)
    stands_at(again, **{name: mm + (-1 if name == "z" else 1) for name, mm in there.items()})
    again.close()


def test_another_name_or_socket_forgets_the_position(tmp_path: Path) -> None:
    table = {**STEPDIR, "axes": {"names": ["x", "y"], "y": {"travel_mm": 300}}}
    assemble(configured(**table), state=tmp_path).close()
    again = assemble(configured(**table), state=tmp_path)
    assert not again.notes
    again.close()
    swapped = {"names": ["x", "y"], "x": {"motor": 2}, "y": {"motor": 1, "travel_mm": 300}}
    made = assemble(configured(**{**table, "axes": swapped}), state=tmp_path)
    assert "configured otherwise" in made.notes[0]
    made.close()


def test_a_rotary_axis_is_referenced_by_its_name_and_turns_without_end() -> None:
    made = referenced("stepdir X Y Z A")
    controller = made.controller
    controller.move_to({"a": 250.0})
    done(made)
    stands_at(made, x=0, y=0, z=0, a=250)
    controller.home(["a"])
    done(made)
    message = controller.state().message
    assert message == "Referenced: A (without end switches: where it stands is zero)."
    assert all(controller.state().referenced)
    assert controller.state().position_mm[3] == 0.0
    controller.move_to({"a": -3600.0}, feed_mm_min=100_000)
    done(made)
    assert at(made)["a"] == pytest.approx(250 - 3600)
    with pytest.raises(
        LimitError, match=r"A 2e\+07 is further than any machine: at most 10,000,000° either way"
    ):
        controller.move_to({"a": 2e7})
    with pytest.raises(LimitError, match=r"longer than 0 and at most 50°, not 60°"):
        controller.jog("a", 60)


def test_a_travel_without_switches_counts_once_zero_is_declared() -> None:
    made = plant(
        **STEPDIR,
        axes={
            "names": ["x", "a"],
            "x": {"end_switches": False, "travel_mm": 100, "home_end": "max"},
            "a": {**WORM, "travel_deg": 90, "end_switches": True},
        },
        simulation={"axes": {"a": WORM}},
    )
    controller = made.controller
    with pytest.raises(LimitError, match="further than its whole travel of 100 mm"):
        controller.move_to({"x": 100.1})
    controller.home()
    done(made)
    assert controller.state().referenced == (False, True)
    assert controller.state().low_mm[1:] + controller.state().high_mm[1:] == (0.0, 86.0)
    controller.home(["x"])
    done(made)
    with pytest.raises(LimitError, match=r"X 0.010 mm is outside the travel, -100 to 0 mm"):
        controller.move_to({"x": 0.01})
    with pytest.raises(LimitError, match=r"A 86.010° is outside the travel, 0 to 86° in machine"):
        controller.move_to({"a": 86.01})
    controller.move_to({"x": -30.0, "a": 86.0})
    done(made)
    assert at(made)["a"] == pytest.approx(86.0, abs=0.01)


def test_nothing_to_home_is_said() -> None:
    made = plant(**STEPDIR, axes={"names": ["a"], "a": WORM})
    with pytest.raises(LimitError, match="name those whose present place is to be their zero, as"):
        made.controller.home()
    made.controller.home(["a"])
    done(made)


def test_a_closed_switch_is_never_taken_for_one_of_an_axis_without(tmp_path: Path) -> None:
    made = referenced("stepdir X Y Z A")
    made.controller.move_to({"x": 50.0, "y": 50.0, "z": -20.0})
    done(made)
    made.controller.move_to({"a": 100.0})
    made.press("ymax", True)
    assert made.controller.run() is Status.ERROR
    assert not any(name.startswith("a") for name in made.controller.state().ends)


def test_sockets_are_where_the_pulses_come_out() -> None:
    made = referenced("stepdir swapped")
    before = look(made).carriages_steps
    made.controller.move_to({"x": 10.0})
    done(made)
    moved = [b - a for a, b in zip(before, look(made).carriages_steps, strict=True)]
    assert moved == [0, 0, 2000, 0]


@pytest.mark.parametrize(
    ("kind", "word"),
    [("stepdir X", "pulse"), ("smc1500 Y", "half-step"), ("smc1500 Z X, full steps", "full step")],
)
def test_the_card_says_what_is_counted(kind: str, word: str) -> None:
    assert plant(**MACHINES[kind]).controller.state().step_word == word


def test_quarter_steps_are_called_that() -> None:
    table = "03 0B 09 29 38 39 29 2B 27 2F 2D 0D 1C 1D 0D 0B"
    with pytest.raises(FraeseError, match="16 entries: quarter-steps"):
        plant(card={"table": table})


# --- programs ----------------------------------------------------------------------------------

PROGRAMS = {
    "stepdir X": ("G21 G90 F600\nG0 X5\nG1 X12.5\nM2\n", {"x": 12.5}),
    "stepdir X Z": ("G21 G90 F600\nG0 X5 Z-2\nG18 G1 X12.5 Z-4\nM2\n", {"x": 12.5, "z": -4.0}),
    "stepdir X Y Z A": (
        "G21 G90 F600\nG0 X5 Y5\nG1 X10 A90\nG3 X10 Y15 I0 J5 A180\nG1 A-45 F3600\nM2\n",
        {"x": 10.0, "y": 15.0, "z": 0.0, "a": -45.0},
    ),
    "stepdir swapped": (
        "G21 G90 F600\nG1 X10 Y3 Z-4 A90\nM2\n",
        {"x": 10.0, "y": 3.0, "z": -4.0, "a": 90.0},
    ),
    "smc1500 Y": ("G21 G90 F300\nG1 Y33\nM2\n", {"y": 33.0}),
    "smc1500 X Z": ("G21 G90 F300\nG1 X3 Z-3\nM2\n", {"x": 3.0, "z": -3.0}),
}


@pytest.mark.parametrize("kind", PROGRAMS)
def test_a_program(kind: str, tmp_path: Path) -> None:
    text, end = PROGRAMS[kind]
    path = tmp_path / "part.ngc"
    path.write_text(text, "utf-8")
    made = referenced(kind)
    program = open_program(path)
    facts = program.check(made.controller, plan=True)
    assert facts.ok, facts.errors
    program.start(made.controller, facts)
    done(made)
    stands_at(made, **end)


def test_a_remain_of_a_sum_takes_no_time(tmp_path: Path) -> None:
    """X stands but for 5e-17 mm; so the inverse time is that of the turn."""
    path = tmp_path / "part.ngc"
    path.write_text("G21 G91 F600\nG1 X0.1\nX0.1\nX0.1\nG90 G93 G1 X0.3 A90 F2\nM2\n", "utf-8")
    made = referenced("stepdir X Y Z A")
    made.controller.home(["a"])
    done(made)
    facts = open_program(path).check(made.controller, plan=True)
    assert facts.duration_s == pytest.approx(30, abs=0.5)


@pytest.mark.parametrize("kind", PROGRAMS)
def test_the_frame_of_a_program(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "part.ngc"
    path.write_text(PROGRAMS[kind][0], "utf-8")
    made = referenced(kind)
    open_program(path).drive_frame(made.controller)
    done(made)
    assert mill(made).mill.lost_steps() == (0.0,) * len(made.controller.machine.axes)


@pytest.mark.parametrize("kind", PROGRAMS)
def test_a_coordinate_list(kind: str, tmp_path: Path) -> None:
    made = referenced(kind)
    there = place_of(made, 6.0)
    letters = list(there)
    path = tmp_path / "points.csv"
    lines = [";".join(letters).upper(), ";".join(str(mm) for mm in there.values())]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    program = open_program(path)
    program.start(made.controller, program.check(made.controller, plan=True))
    done(made)
    stands_at(made, **there)
