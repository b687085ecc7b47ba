"""Programs from file on the simulated mill: what runs, what is refused, what is left behind."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.control.jobs import line_of, move_of
from fraese.control.state import Status
from fraese.errors import LimitError, ProgramError, StateError
from fraese.motor.seams import CONTROL
from fraese.program.check import check_program
from fraese.program.context import ProgramContext
from fraese.program.program import Program, open_program
from tests.helpers import (
    STEPDIR,
    after_slices,
    axes,
    carriages,
    homed,
    look,
    merged,
    mill,
    plant,
    program,
    record,
    run_program,
    touching_at,
)

SQUARE = "G21 G90 G0 Z-1\nG1 X10 F600\nY10\nX0\nY0\nG0 Z0\nM2\n"


def messages(made: Plant) -> list[str]:
    told: list[str] = []
    made.controller.set_tell(told.append)
    return told


def answering(made: Plant) -> list[str]:
    """Answer every question; the list says which were asked."""
    asked: list[str] = []

    def break_key() -> None:
        if made.controller.question:
            asked.append(made.controller.question)
            made.controller.answer()

    made.controller.set_break_key(break_key)
    return asked


# --- running -------------------------------------------------------------------------------------


@pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])
@pytest.mark.parametrize("backlash", ["0", "0.1"])
def test_a_program_ends_where_it_says(tmp_path: Path, card: dict[str, Any], backlash: str) -> None:
    played = axes(backlash_mm=backlash)
    made = homed(**merged(card, {"axes": played, "simulation": {"backlash_mm": float(backlash)}}))
    zero = carriages(made)
    text = "G21 G90\nG1 X10 Y5 F600\nG2 X20 Y5 I5 J0\nG0 Z-3\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    state = made.controller.state()
    assert state.position_mm == (20, 5, -3)
    moved = tuple(now - then for now, then in zip(carriages(made), zero, strict=True))
    assert moved == state.position_steps
    assert look(made).lost_steps == (0, 0, 0)
    assert state.job is not None
    assert state.job.lines == 5
    assert state.job.blocks > 3


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("points.csv", "x;y;z\n1,5;2;-1\n10;20;-2\n"),
        ("points.txt", "# unit: mm\n1.5 2 -1\n10 20 -2\n"),
        ("points.xyz", "1.5,2,-1,300\n10,20,-2\n"),
    ],
)
def test_lists_of_coordinates_run_too(tmp_path: Path, name: str, text: str) -> None:
    made = homed()
    assert run_program(made, program(tmp_path, text, name)) is Status.OK
    assert made.controller.state().position_mm == (10, 20, -2)


def test_the_first_refused_line_is_found_before_the_first_step(tmp_path: Path) -> None:
    made = homed()
    before = carriages(made)
    with pytest.raises(ProgramError, match="line 4"):
        run_program(made, program(tmp_path, "G21\nG1 X5 F100\nX6\nG5 X7\nX8\n"))
    assert carriages(made) == before
    assert made.controller.status is Status.OK


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("G0 X10\nX297\n", 2),
        ("G0 X10\nG1 X-0.003 F100\n", 2),
        ("G0 Z-5\nX50 Y50\nG2 I-60 F500\n", 3),
        ("G0 X296\nG91\nG0 X0.004\n", 3),
    ],
)
def test_a_program_that_leaves_the_travel_is_refused_by_line(
    tmp_path: Path, text: str, line: int
) -> None:
    made = homed()
    before = carriages(made)
    with pytest.raises(LimitError, match=f"line {line}: "):
        run_program(made, program(tmp_path, text))
    assert carriages(made) == before


def test_a_program_to_the_very_limits_runs(tmp_path: Path) -> None:
    made = homed()
    text = "G0 X296.002 Y196 Z-56\nG1 X0 Y0 F2000\nX-0.0024\nG0 Z0\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert made.controller.state().position_steps == (0, 0, 0)


def test_without_the_look_through_limits_count_all_the_same(tmp_path: Path) -> None:
    made = homed()
    made_program = program(tmp_path, "G0 X20\nX10\nX400\n")
    made_program.start(made.controller)
    assert made.controller.run() is Status.ERROR
    assert "line 3" in made.controller.state().message
    assert carriages(made)[0] <= 400 + 20 * 200
    assert look(made).lost_steps == (0, 0, 0)


def test_unreferenced_runs_slow_or_not_at_all(tmp_path: Path) -> None:
    def duration_s(made: Plant) -> float:
        before_ns = made.clock.now_ns()
        assert run_program(made, program(tmp_path, "G1 X20 F300\nM2\n")) is Status.OK
        return (made.clock.now_ns() - before_ns) / 1e9

    assert duration_s(homed()) == pytest.approx(4, rel=0.05)
    assert duration_s(plant()) == pytest.approx(8, rel=0.05)
    assert duration_s(plant(run={"unreferenced_percent": 20})) == pytest.approx(20, rel=0.05)
    forbidden = plant(run={"unreferenced": "forbid"})
    with pytest.raises(StateError, match="reference"):
        run_program(forbidden, program(tmp_path, SQUARE))
    with pytest.raises(StateError, match="reference"):
        program(tmp_path, SQUARE).drive_frame(forbidden.controller)


def test_cancel_brakes_and_nothing_is_lost(tmp_path: Path) -> None:
    for number in (1, 3, 6, 9, 15):
        made = homed()
        zero = carriages(made)
        after_slices(made.controller, number, made.controller.cancel)
        assert run_program(made, program(tmp_path, SQUARE)) is Status.CANCEL
        moved = tuple(int(a - b) for a, b in zip(carriages(made), zero, strict=True))
        assert moved == made.controller.state().position_steps
        assert look(made).lost_steps == (0, 0, 0)
        assert made.controller.state().referenced == (True, True, True)


def test_hold_and_resume_leave_the_path_unchanged(tmp_path: Path) -> None:
    def data(hold_at: int) -> list[int]:
        made = homed()
        recorder = record(made)
        slices: list[int] = []

        def break_key() -> None:
            slices.append(1)
            if len(slices) == hold_at:
                made.controller.hold()
            if len(slices) == hold_at + 8:
                made.controller.resume()

        made.controller.set_break_key(break_key)
        assert run_program(made, program(tmp_path, SQUARE)) is Status.OK
        return [value for register, value in recorder.writes() if register != CONTROL]

    whole = data(10_000)
    for hold_at in (2, 5, 11):
        assert data(hold_at) == whole


@pytest.mark.parametrize("again", ["", "away", "back"])
def test_held_the_tool_is_lifted_and_comes_back(tmp_path: Path, again: str) -> None:
    made = homed(run={"retract_mm": 5.0})
    controller = made.controller
    heights: list[float] = []
    slices: list[int] = []

    def break_key() -> None:
        slices.append(1)
        heights.append(controller.state().position_mm[2])
        number = len(slices)
        if number == 5 or (again == "away" and number == 8) or (again == "back" and number == 33):
            controller.hold()
        if number in (30, 60):
            controller.resume()

    controller.set_break_key(break_key)
    text = "G0 Z-20\nG1 X10 F400\nX0\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert controller.state().position_mm == (0, 0, -20)
    assert max(heights[15:29]) > -20 + 4
    assert look(made).lost_steps == (0, 0, 0)


def test_cancel_while_lifted(tmp_path: Path) -> None:
    for number in range(24, 42, 3):
        made = homed(run={"retract_mm": 5.0})
        controller = made.controller
        slices: list[int] = []

        def break_key(
            controller: Any = controller, slices: list[int] = slices, number: int = number
        ) -> None:
            slices.append(1)
            if len(slices) == 5:
                controller.hold()
            if len(slices) == 30:
                controller.resume()
            if len(slices) == number:
                controller.cancel()

        controller.set_break_key(break_key)
        text = "G0 Z-20\nG1 X50 F400\nX0\nM2\n"
        assert run_program(made, program(tmp_path, text)) is Status.CANCEL
        assert len(slices) < number + 12
        assert look(made).lost_steps == (0, 0, 0)


def test_an_override_is_felt_soon_even_in_one_long_move(tmp_path: Path) -> None:
    def duration_s(factor: float) -> float:
        made = homed()
        before_ns = made.clock.now_ns()
        after_slices(made.controller, 3, lambda: made.controller.handling.set_feed(factor))
        assert run_program(made, program(tmp_path, "G1 X40 F120\nM2\n")) is Status.OK
        return (made.clock.now_ns() - before_ns) / 1e9

    assert duration_s(1.0) == pytest.approx(20, rel=0.05)
    assert duration_s(2.0) == pytest.approx(10, abs=2)
    assert duration_s(0.5) == pytest.approx(40, abs=3)


def test_m49_holds_the_feed_against_an_override_that_comes_while_it_moves(tmp_path: Path) -> None:
    made = homed()
    controller = made.controller
    after_slices(controller, 20, lambda: controller.handling.set_feed(0.5))
    assert run_program(made, program(tmp_path, "M49\nG1 X20 F120\nM2\n")) is Status.OK
    job = controller.state().job
    assert job is not None
    # M2 gives the override back, but not for moves that were planned before it.
    assert job.elapsed_s == pytest.approx(10.1, abs=0.1)


def test_an_override_from_before_holds_and_m49_takes_it_away(tmp_path: Path) -> None:
    def duration_s(text: str) -> float:
        made = homed()
        made.controller.handling.set_feed(2)
        before_ns = made.clock.now_ns()
        assert run_program(made, program(tmp_path, text)) is Status.OK
        return (made.clock.now_ns() - before_ns) / 1e9

    assert duration_s("G1 X20 F120\nM2\n") == pytest.approx(5, abs=0.6)
    assert duration_s("M49\nG1 X20 F120\nM2\n") == pytest.approx(10, abs=0.6)


@pytest.mark.parametrize("path", ["", "G64 P0.01\n"])
def test_m48_and_m49_hold_for_the_moves_behind_them_alone(tmp_path: Path, path: str) -> None:
    """Twice as long with half the feed; not where the program does not allow it."""

    def duration_s(text: str, factor: float) -> float:
        made = homed()
        made.controller.handling.set_feed(factor)
        before_ns = made.clock.now_ns()
        assert run_program(made, program(tmp_path, path + text + "M2\n")) is Status.OK
        return (made.clock.now_ns() - before_ns) / 1e9

    follows, keeps = "M48\nG1 X2 F120\nX4\n", "M49\nG1 X5 F60\nX6\n"
    for text in (follows + keeps, keeps.replace("5", "1").replace("6", "2") + follows):
        whole_s = duration_s(text, 1.0)
        way_mm = 4 if text.startswith("M48") else 2
        assert duration_s(text, 0.5) == pytest.approx(whole_s + way_mm / 2, abs=0.1)


@pytest.mark.parametrize("factor", [0.09, 2.01, float("nan")])
def test_an_override_is_10_to_200_per_cent(factor: float) -> None:
    with pytest.raises(LimitError):
        plant().controller.handling.set_feed(factor)


# --- offsets shared by panel and program ---------------------------------------------------------


def test_panel_and_program_share_work_offsets(tmp_path: Path) -> None:
    made = homed()
    controller = made.controller
    controller.move_to({"x": 50, "y": 50, "z": -10})
    controller.run()
    controller.set_zero("xyz")
    assert run_program(made, program(tmp_path, "G0 X1 Y2 Z3\nM2\n")) is Status.OK
    assert controller.state().position_mm == (51, 52, -7)
    assert controller.state().work_mm == (1, 2, 3)
    text = "G10 L2 P2 X100 Y0 Z0\nG55 G0 X1\nG10 L20 P1 X0\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert controller.state().position_mm[0] == 101
    assert controller.state().offset_mm == (101, 50, -10)  # M2: back to G54
    assert run_program(made, program(tmp_path, "G55\nG0 X2\n")) is Status.OK
    assert controller.state().position_mm[0] == 102


def test_g92_is_seen_on_the_panel_and_taken_into_account_by_set_zero(tmp_path: Path) -> None:
    made = homed()
    controller = made.controller
    assert run_program(made, program(tmp_path, "G0 X10\nG92 X3\nM2\n")) is Status.OK
    assert controller.state().work_mm[0] == 3
    controller.set_zero("x", 7)
    assert controller.state().work_mm[0] == pytest.approx(7)
    assert run_program(made, program(tmp_path, "G0 X8\nG92.1\nM2\n")) is Status.OK
    assert controller.state().position_mm[0] == 11
    assert controller.state().work_mm[0] == pytest.approx(15)


def test_what_was_read_ahead_but_not_reached_does_not_move_the_work_zero(tmp_path: Path) -> None:
    made = homed()
    controller = made.controller
    text = "G0 X1\nG10 L20 P1 X0\nG1 X20 F300\nG10 L20 P1 X0\nX5\nM2\n"
    after_slices(controller, 15, controller.cancel)
    assert run_program(made, program(tmp_path, text)) is Status.CANCEL
    assert 2 < controller.state().position_mm[0] < 19
    assert controller.state().offset_mm[0] == pytest.approx(1)


@pytest.mark.parametrize("slices", [6, 8, 12, 19, 23])
def test_a_work_zero_moves_when_the_motors_come_to_it(tmp_path: Path, slices: int) -> None:
    """Every fifth of a millimetre another zero, several of them read ahead at any time."""
    made = homed()
    controller = made.controller
    after_slices(controller, slices, controller.cancel)
    text = "G1 X0.2 F30\nG10 L20 P1 X0\n" * 20
    assert run_program(made, program(tmp_path, text + "M2\n")) is Status.CANCEL
    state = controller.state()
    lines_done = int(state.position_mm[0] / 0.2 + 1e-6)
    assert 0 < lines_done < 19
    assert state.offset_mm[0] == pytest.approx(0.2 * lines_done)


@pytest.mark.parametrize("slices", [10, 25, 50])
@pytest.mark.parametrize("change", ["G55", "G92 X1", "G10 L2 P1 R45", "G10 L20 P1 X0"])
def test_offsets_behind_a_merged_line_wait_for_its_end(
    tmp_path: Path, change: str, slices: int
) -> None:
    """A line that is merged from points becomes many blocks, and one more for the backlash."""
    made = homed(axes=axes(backlash_mm="0.05"), simulation={"backlash_mm": 0.05})
    controller = made.controller
    before = controller.state()
    after_slices(controller, slices, controller.cancel)
    text = f"G64 P0.01\nG1 X30 F600\nX60\n{change}\nG1 X80 Y60\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.CANCEL
    state = controller.state()
    assert 5 < state.position_mm[0] < 59.5
    assert state.work == before.work


def test_offsets_in_the_middle_of_a_straight_way_change_there(tmp_path: Path) -> None:
    made = homed()
    controller = made.controller
    text = "G64 P0.01\nG1 X10 F600\nG10 L20 P1 X0\nG1 X20\nM2\n"
    after_slices(controller, 25, controller.cancel)
    assert run_program(made, program(tmp_path, text)) is Status.CANCEL
    assert 11 < controller.state().position_mm[0] < 30
    assert controller.state().offset_mm[0] == pytest.approx(10)


# --- probing -------------------------------------------------------------------------------------


def test_probe_against_the_shared_switch_and_go_away_again(tmp_path: Path) -> None:
    made = homed(axes=axes(backlash_mm="0.05"), simulation={"backlash_mm": 0.05})
    touching_at(made, 11_600 - 2000)
    text = (
        "G21 G90\nG38.2 Z-30 F100\n#1=#5063\n(PRINT,touched at#5063)\n"
        "G0 Z-9.5\nX5\nG0 Z-5\nG38.2 Z-30 F60\nG0 Z0\nM2\n"
    )
    told = messages(made)
    assert run_program(made, program(tmp_path, text)) is Status.OK, made.controller.state().message
    assert made.controller.state().position_mm == (5, 0, 0)
    assert told[-1].startswith("touched at-10.0")


def test_after_a_probe_nothing_goes_further_in(tmp_path: Path) -> None:
    made = homed()
    touching_at(made, 11_600 - 2000)
    text = "G38.2 Z-30 F100\nG0 Z-20\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.ERROR
    assert made.controller.state().position_mm[2] > -10.2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("G38.2 Z-5 F100\n", "never touched"),
        ("G38.2 Z-15 F100\nG38.2 Z-16 F100\n", "touches already"),
        ("G38.4 Z-5 F100\n", "is free already"),
    ],
)
def test_probes_that_fail_say_so(tmp_path: Path, text: str, said: str) -> None:
    made = homed()
    touching_at(made, 11_600 - 2000)
    assert run_program(made, program(tmp_path, text)) is Status.ERROR
    assert said in made.controller.state().message
    assert "line " in made.controller.state().message


def test_probes_that_may_fail_go_on(tmp_path: Path) -> None:
    made = homed()
    touching_at(made, 11_600 - 2000)
    told = messages(made)
    text = "G38.3 Z-5 F100\n(PRINT,#5070)\nG38.3 Z-15\n(PRINT,#5070)\nG38.5 Z0\nG0 Z0\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK, made.controller.state().message
    assert told[:2] == ["0.000000", "1.000000"]


def test_a_probe_on_an_input_of_its_own(tmp_path: Path) -> None:
    made = homed(probe={"pin": 12, "closed_reads": 1})
    port = mill(made)
    read = port.read_status
    port.read_status = lambda: (  # type: ignore[method-assign]
        read() | 0x20 if carriages(made)[2] <= 10_000 else read() & ~0x20
    )
    assert run_program(made, program(tmp_path, "G38.2 Z-30 F100\nG0 Z0\n")) is Status.OK
    assert made.controller.state().position_mm[2] == 0


def test_a_program_may_find_its_limits_only_while_it_runs(tmp_path: Path) -> None:
    made = homed()
    touching_at(made, 11_600 - 2000)
    text = "G38.2 Z-30 F100\nG0 Z0\nG0 Z[#5063 + 15]\nM2\n"
    # The look through takes the probe to its target: -15 there, +5 when it touches at -10.
    assert run_program(made, program(tmp_path, text)) is Status.ERROR
    assert "outside the travel" in made.controller.state().message
    assert made.controller.state().position_mm[2] == 0


# --- questions, outputs, messages ----------------------------------------------------------------


def test_pauses_and_tools_ask_and_wait(tmp_path: Path) -> None:
    made = homed()
    asked = answering(made)
    text = "G0 X1\nM0\nG0 X2\nT3 M6\nM1\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert asked == [
        "Program stop in line 2: go on?",
        "Tool change in line 4: put in tool 3.",
    ]
    optional = homed(run={"optional_stop": True})
    asked = answering(optional)
    assert run_program(optional, program(tmp_path, "M1\nM2\n")) is Status.OK
    assert len(asked) == 1


def test_an_answer_given_early_does_not_pass_the_next_question(tmp_path: Path) -> None:
    made = homed()
    controller = made.controller
    waited: list[str] = []

    def break_key() -> None:
        if not controller.question:
            controller.answer()
            return
        waited.append(controller.question)
        if len(waited) in (5, 10):
            controller.answer()
            controller.answer()

    controller.set_break_key(break_key)
    assert run_program(made, program(tmp_path, "M0\nG0 X1\nM0\nM2\n")) is Status.OK
    assert [waited.count(question) for question in dict.fromkeys(waited)] == [5, 5]


def test_cancel_at_a_question(tmp_path: Path) -> None:
    made = homed()
    after_slices(made.controller, 6, made.controller.cancel)
    assert run_program(made, program(tmp_path, "M0\nG0 X10\nM2\n")) is Status.CANCEL
    assert made.controller.state().position_mm == (0, 0, 0)
    assert made.controller.question == ""


def test_outputs_that_hang_on_nothing_are_told_and_never_refused(tmp_path: Path) -> None:
    made = homed(run={"confirm_spindle": "never"})
    told = messages(made)
    text = "M3 S1000\nM8\nM7\nM4 S200\nM5\nM9\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert "Spindle on, clockwise, 1000 rev/min" in told[0]
    assert "coolant mist and flood on" in told[2]
    assert "counter-clockwise" in told[3]


@pytest.mark.parametrize(("when", "times"), [(None, 1), ("first", 1), ("every", 4), (True, 4)])
def test_that_a_spindle_switched_by_hand_runs_is_confirmed(
    tmp_path: Path, when: object, times: int
) -> None:
    """By default the first time in a job that it is to run: before the cutter goes down."""
    made = homed(run={} if when is None else {"confirm_spindle": when})
    asked = answering(made)
    text = "M5\nM3 S1000\nG1 X1 F600\nM4 S200\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert asked.count("Spindle on, clockwise, 1000 rev/min: confirm.") == 1
    assert len(asked) == times


@pytest.mark.parametrize("active_high", [True, False])
def test_configured_outputs_are_switched_at_rest(tmp_path: Path, active_high: bool) -> None:
    """Pin 14 is control bit 1, inverted; pin 17 is bit 3, inverted."""
    made = homed(
        outputs={
            "spindle": {"pin": 14, "active_high": active_high},
            "coolant": {"pin": 17, "active_high": active_high},
        },
        run={"spin_up_s": 1.5},
    )
    recorder = record(made)
    told = messages(made)
    before_ns = made.clock.now_ns()
    text = "M3 S1000\nG1 X1 F300\nM8\nX2\nM5\nM9\nX3\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    seen: list[tuple[bool, bool]] = []
    for access in recorder.accesses:
        if access.register == CONTROL:
            now = tuple((access.value & bit == 0) == active_high for bit in (0b0010, 0b1000))
            if not seen or seen[-1] != now:
                seen.append((now[0], now[1]))
    assert seen == [
        *([(False, False)] if seen[0] == (False, False) else []),
        (True, False),
        (True, True),
        (False, True),
        (False, False),
    ]
    assert told == []
    assert (made.clock.now_ns() - before_ns) / 1e9 > 1.5


def test_after_a_cancel_no_spindle_runs(tmp_path: Path) -> None:
    made = homed(outputs={"spindle": {"pin": 14}}, run={"spin_up_s": 0})
    recorder = record(made)
    after_slices(made.controller, 8, made.controller.cancel)
    assert run_program(made, program(tmp_path, "M3 S1\nG1 X20 F300\nM2\n")) is Status.CANCEL
    values = [value for register, value in recorder.writes() if register == CONTROL]
    assert any(value & 2 == 0 for value in values)
    assert values[-1] & 2


# --- from a line, frame --------------------------------------------------------------------------


def test_from_a_line_starts_with_what_was_in_force(tmp_path: Path) -> None:
    made = homed()
    text = "G21 G90 G0 Z-2\nX10 Y10\nG1 Z-5 F120\nX20\nX30\nY20\nG0 Z-1\nM2\n"
    part = program(tmp_path, text)
    way = part.way_from(made.controller, 5)
    assert carriages(made) == (400, 400, 11_600)
    # It stands at the height of the way already.
    assert way[1].strip().startswith("rapid to X 20.000 Y 10.000 Z 0.000 mm")
    assert way[2].strip() == "feed 120 mm/min to X 20.000 Y 10.000 Z -5.000 mm (machine)"
    lows: list[float] = []
    made.controller.set_show_pos(lambda: lows.append(made.controller.state().position_mm[0]))
    assert run_program(made, part, from_line=5) is Status.OK
    assert made.controller.state().position_mm == (30, 20, -1)


@pytest.mark.parametrize("line", [9, 100])
def test_from_a_line_behind_the_end_is_refused(tmp_path: Path, line: int) -> None:
    made = homed()
    with pytest.raises(ProgramError, match="nothing to run"):
        program(tmp_path, SQUARE).way_from(made.controller, line)


def test_from_a_line_repeats_spindle_and_tool(tmp_path: Path) -> None:
    made = homed()
    asked = answering(made)
    text = "T2 M6\nM3 S500\nG1 X5 F200\nX10\nM2\n"
    assert run_program(made, program(tmp_path, text), from_line=4) is Status.OK
    assert asked == [
        "Tool change in line 1: put in tool 2.",
        "Spindle on, clockwise, 500 rev/min: confirm.",
    ]


def test_a_spindle_turns_above_the_work_before_the_tool_goes_down(tmp_path: Path) -> None:
    made = homed(outputs={"spindle": {"pin": 14}}, run={"spin_up_s": 1})
    recorder = record(made)
    heights: list[tuple[bool, float, float]] = []

    def look() -> None:
        written = [access.value for access in recorder.accesses if access.register == CONTROL]
        turns = bool(written) and not written[-1] & 2
        x_mm, _, z_mm = made.controller.state().position_mm
        # At the end of the program it is switched off.
        if x_mm < 29:
            heights.append((turns, z_mm, made.clock.now_ns() / 1e9))

    made.controller.set_show_pos(look)
    text = "M3 S500\nG0 Z-2\nX10\nG1 Z-5 F300\nX20\nX30\nM2\n"
    assert run_program(made, program(tmp_path, text), from_line=6) is Status.OK
    down = [(turns, at_s) for turns, height, at_s in heights if height < -0.5]
    assert all(turns for turns, _ in down)
    assert not heights[0][0]
    # It had its time to come up to speed.
    on_s = next(at_s for turns, _, at_s in heights if turns)
    assert down[0][1] - on_s >= 1


def _numbers(made: Plant, part: Program, **how: int) -> list[tuple[int, int]]:
    """Number and line of every move that was seen being played, in order."""
    seen: list[tuple[int, int]] = []

    def look() -> None:
        tag = made.controller._queue.report.tag
        if tag and (move_of(tag), line_of(tag)) not in seen[-1:]:
            seen.append((move_of(tag), line_of(tag)))

    made.controller.set_show_pos(look)
    assert run_program(made, part, **how) is Status.OK
    return seen


def test_moves_are_numbered_through_loops(tmp_path: Path) -> None:
    text = "G21 G90 F600\nO1 REPEAT [3]\nG1 X10\nG1 X0\nO1 ENDREPEAT\nG1 Y5\nM2\n"
    seen = _numbers(homed(), program(tmp_path, text))
    lines = [line for _, line in seen]
    assert lines == [3, 4, 3, 4, 3, 4, 6]
    numbers = [number for number, _ in seen]
    assert numbers == sorted(set(numbers))
    assert [b - a for a, b in pairwise(numbers)] == [1] * 6


def test_a_program_from_a_line_has_the_numbers_of_the_whole_one(tmp_path: Path) -> None:
    text = "G21 G90 F600\nG1 X10\nG1 X0\nG1 Z-1\nG1 X20\nG1 Y5\nM2\n"
    whole = _numbers(homed(), program(tmp_path, text))
    part = _numbers(homed(), program(tmp_path, text), from_line=5)
    # The way there is made as that of the move to which it leads.
    assert set(part) == set(whole[3:])


def test_the_frame_goes_round_at_a_safe_height(tmp_path: Path) -> None:
    made = homed()
    text = "G0 X20 Y20 Z-3\nG1 Z-10 F300\nX60 Y30\nG3 X60 Y50 I0 J10\nG0 Z-1\nM2\n"
    seen: set[tuple[float, float]] = set()
    heights: set[float] = set()

    def show() -> None:
        x_mm, y_mm, z_mm = made.controller.state().position_mm
        seen.add((x_mm, y_mm))
        heights.add(z_mm)

    made.controller.set_show_pos(show)
    program(tmp_path, text).drive_frame(made.controller)
    assert made.controller.run() is Status.OK
    assert heights == {0}
    assert max(x for x, _ in seen) == 70
    assert max(y for _, y in seen) == 50
    assert made.controller.state().position_mm == (20, 20, 0)


def test_the_frame_leaves_out_where_nothing_is_cut(tmp_path: Path) -> None:
    made = homed()
    text = (
        "G21 G90\nG53 G0 Z0\nG53 G0 X250 Y150\nT1 M6\nG0 X10 Y10\nG0 Z-2\nG1 Z-3 F200\n"
        "G1 X40 F600\nG1 Y30\nG1 X10\nG1 Y10\nG0 Z-1\nG53 G0 Z0\nG28\nM2\n"
    )
    seen: set[tuple[float, ...]] = set()
    made.controller.set_show_pos(lambda: seen.add(made.controller.state().position_mm))
    program(tmp_path, text).drive_frame(made.controller)
    assert made.controller.run() is Status.OK
    assert max(x for x, _, _ in seen) == 40
    assert max(y for _, y, _ in seen) == 30
    assert {z for _, _, z in seen} == {0}
    assert made.controller.state().position_mm == (10, 10, 0)


@pytest.mark.parametrize("line", ["G28", "G91 G28 Z0", "G30 X0", "G53 G0 Z0"])
def test_places_of_the_machine_are_refused_where_nobody_knows_them(
    tmp_path: Path, line: str
) -> None:
    made = plant()
    part = program(tmp_path, f"G21 G90\n{line}\nM2\n")
    with pytest.raises(ProgramError, match=r"line 2: .* not referenced") as refused:
        part.check(made.controller)
    assert ("axes X Y Z are" in str(refused.value)) is (line == "G28")
    assert program(tmp_path, f"G21 G90\n{line}\nM2\n").check(homed().controller).ok


def test_of_an_axis_that_is_referenced_the_place_is_known(tmp_path: Path) -> None:
    made = plant()
    made.controller.home("z")
    assert made.controller.run() is Status.OK
    part = program(tmp_path, "G21 G90\nG53 G0 Z0\nG91 G28 Z0\nG28.1\nM2\n")
    assert part.check(made.controller).ok


def test_a_program_without_motion_has_no_frame(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match="nothing moves"):
        program(tmp_path, "M3\nM5\n").drive_frame(homed().controller)


def test_a_motion_code_alone_is_no_part_of_the_bounds(tmp_path: Path) -> None:
    made = homed()
    facts = program(tmp_path, "G21 G90 G1 F900\nX20 Y10 Z-1\nX30\nM2\n").check(made.controller)
    assert facts.low_mm == (20.0, 10.0, -1.0)
    assert facts.high_mm == (30.0, 10.0, -1.0)


def test_an_axis_that_stands_outside_and_is_not_moved_does_not_refuse_a_program(
    tmp_path: Path,
) -> None:
    made = homed()
    made.controller.position.set_reference("x", -20)
    facts = program(tmp_path, "G21 G90 G1 Y5 F900\nM2\n").check(made.controller)
    assert facts.ok
    with pytest.raises(LimitError, match=r"line 1: X -1\.000"):
        program(tmp_path, "G21 G90 G1 X-1 F900\nM2\n").check(made.controller)


def test_a_stop_while_the_job_steps_aside_is_not_lost(tmp_path: Path) -> None:
    made = homed(run={"retract_mm": 5})
    part = program(tmp_path, "G21 G90 G1 Z-10 F600\nX20\nX0\nM2\n")
    part.start(made.controller, part.check(made.controller))
    after_slices(made.controller, 15, made.controller.hold)
    driver = made.controller._driver
    flush = driver.flush

    def flush_after_a_stop() -> None:
        made.controller.stop()
        flush()

    driver.flush = flush_after_a_stop  # type: ignore[method-assign]
    assert made.controller.run() is Status.CANCEL
    assert made.controller.state().position_mm[2] == -10


def test_a_large_file_is_looked_through_in_a_process_of_its_own(tmp_path: Path) -> None:
    made = homed()
    text = "G21 G90 F900\n" + "G1 X10 Y10\nG1 X20 Y5\n" * 10_000 + "M2\n"
    part = program(tmp_path, text)
    apart = open_program(part.path, apart=True)
    assert apart.check(made.controller) == part.check(made.controller)
    with pytest.raises(ProgramError, match=r"part\.ngc, line 20002: "):
        open_program(program(tmp_path, text.replace("M2", "G1 X[1/0]")).path, apart=True).check(
            made.controller
        )


def test_a_frame_takes_up_backlash(tmp_path: Path) -> None:
    made = homed(axes=axes(backlash_mm="0.1"), simulation={"backlash_mm": 0.1})
    program(tmp_path, SQUARE).drive_frame(made.controller)
    assert made.controller.run() is Status.OK
    there = made.controller.state().position_steps
    program(tmp_path, SQUARE).drive_frame(made.controller)
    assert made.controller.run() is Status.OK
    assert made.controller.state().position_steps == there == (0, 0, 0)
    made.controller.run_curve([(3, 2, -1), (1, 1, -1), (2, 0.5, -1)])
    assert made.controller.run() is Status.OK
    assert made.controller.state().position_mm == (2, 0.5, -1)
    assert carriages(made)[:2] == (400 + 400, 400 + 100)


COMPUTES = "G21 G90 G1 X1 F600\no1 while [#1 lt 40000]\n#1=[#1+1]\no1 endwhile\nG1 X2\nM2\n"


def test_a_program_that_computes_for_long_does_not_keep_the_run_loop(tmp_path: Path) -> None:
    made = homed()
    zero = carriages(made)
    slices = after_slices(made.controller, 0)
    program(tmp_path, COMPUTES).start(made.controller)
    assert made.controller.run() is Status.OK
    assert len(slices) > 80
    assert carriages(made)[0] - zero[0] == 400


def test_it_is_cancelled_while_it_computes(tmp_path: Path) -> None:
    made = homed()
    zero = carriages(made)
    slices = after_slices(made.controller, 30, made.controller.cancel)
    program(tmp_path, COMPUTES.replace("lt 40000", "gt -1")).start(made.controller)
    assert made.controller.run() is Status.CANCEL
    assert len(slices) < 40
    assert carriages(made)[0] - zero[0] == made.controller.state().position_steps[0]


def test_lines_that_are_only_read_do_not_keep_it_either(tmp_path: Path) -> None:
    made = homed()
    zero = carriages(made)
    text = "G21 G90 F600\n" + "G1 X1\nG1 X2\n" * 10_000 + "G1 X3\nM2\n"
    slices = after_slices(made.controller, 0)
    places: list[float] = []
    made.controller.set_show_pos(lambda: places.append(carriages(made)[0]))
    program(tmp_path, text).start(made.controller, from_line=20_002)
    assert made.controller.run() is Status.OK
    assert len(slices) > 40
    assert places[:35] == [zero[0]] * 35
    assert carriages(made)[0] - zero[0] == 600


def test_a_move_to_no_place_is_refused_and_not_planned(tmp_path: Path) -> None:
    """Cut into pieces of a second, it would be planned for ever."""
    made = homed()
    for text in ("G0 X1\nX1e39\nX0\n", "G0 X1\nG1 X[10**39] F1\nX0\n", "G2 I1e30 F600\n"):
        with pytest.raises((LimitError, ProgramError), match="line "):
            program(tmp_path, text.replace("X1e39", "X" + "9" * 39)).check(made.controller)
    facts = check_program(
        program(tmp_path, "G0 X1\nX40000\nX0\n").taken, ProgramContext.of(made.controller)
    )
    assert facts.outside[0].line == 2
    assert facts.lines == 3
    assert facts.blocks < 10
