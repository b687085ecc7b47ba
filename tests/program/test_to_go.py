"""What is left of the move in hand: of a line, an arc, merged points, and by hand in between."""

from pathlib import Path

import pytest

from fraese.control.aims import Aims
from fraese.control.state import MachineState, Status
from tests.helpers import homed, program, run_program

START = "G21 G90 G17 G64\nG0 X20 Y20\n"


def watched(folder: Path, text: str) -> list[MachineState]:
    """A look at every slice of a run."""
    made, seen = homed(), []
    made.controller._loop.runner._slice_s = 0.02
    made.controller.set_break_key(lambda: seen.append(made.controller.state()))
    assert run_program(made, program(folder, text)) is Status.OK
    assert made.controller.state().to_go_mm == ()
    return seen


def of_line(seen: list[MachineState], line: int) -> list[MachineState]:
    found = [each for each in seen if each.job is not None and each.job.line == line]
    assert len(found) > 5
    return found


def ends_mm(state: MachineState) -> tuple[float, ...]:
    """Where it would be if it went what it says."""
    pairs = zip(state.position_mm, state.to_go_mm, strict=True)
    return tuple(round(at + way, 6) for at, way in pairs)


def test_of_a_line_it_is_the_way_to_its_end(tmp_path: Path) -> None:
    seen = watched(tmp_path, START + "G1 X50 Y30 F600\nX10\nM2\n")
    first, second = of_line(seen, 3), of_line(seen, 4)
    assert {ends_mm(each) for each in first} == {(50, 30, 0)}
    assert {ends_mm(each) for each in second} == {(10, 30, 0)}
    assert all(each.to_go_mm[2] == 0 for each in first + second)
    ways = [each.to_go_mm[0] for each in first]
    assert ways == sorted(ways, reverse=True)
    assert ways[0] > 25


def test_of_an_arc_it_is_the_way_to_its_end(tmp_path: Path) -> None:
    seen = watched(tmp_path, START + "G2 X40 Y20 I10 J0 F600\nM2\n")
    assert {ends_mm(each) for each in of_line(seen, 3)} == {(40, 20, 0)}


def test_of_merged_points_it_is_the_way_to_the_last_of_them(tmp_path: Path) -> None:
    points = "".join(f"X{20 + n} Y20\n" for n in range(1, 31))
    text = "G21 G90 G17 G64 P0.01\nG0 X20 Y20\nG1 F600\n" + points + "Y40\nM2\n"
    seen = watched(tmp_path, text)
    merged = [each for each in seen if each.job is not None and 2 < each.job.line < 34]
    assert len(merged) > 5
    assert {ends_mm(each) for each in merged} == {(50, 20, 0)}


def test_in_a_question_it_is_that_of_what_is_done_by_hand(tmp_path: Path) -> None:
    made, seen = homed(), []
    controller = made.controller
    controller._loop.runner._slice_s = 0.02

    def at_the_keys() -> None:
        state = controller.state()
        if not state.to_go_mm:
            return
        if not state.question:
            seen.append((state.job.line if state.job else 0, state.to_go_mm, ends_mm(state)))
        elif len(moved) == 0:
            moved.append(True)
            assert not any(state.to_go_mm)
            controller.jog("z", -5.0)
        else:
            controller.answer()

    moved: list[bool] = []
    controller.set_break_key(at_the_keys)
    assert run_program(made, program(tmp_path, START + "M0\nG1 X50 F600\nM2\n")) is Status.OK
    by_hand = [end for line, way, end in seen if line == 3 and way[2] < 0]
    assert by_hand
    assert set(by_hand) == {(20, 20, -5)}
    back = [end for line, way, end in seen if line == 3 and way[2] > 0]
    assert back
    assert set(back) == {(20, 20, 0)}


def test_what_has_been_played_is_forgotten_in_time() -> None:
    class Queue:
        tag = 0

    aims = Aims(Queue(), homed().controller.position)  # type: ignore[arg-type]
    note = aims.begin()
    for number in range(100_000):
        Queue.tag = max(0, number - 50)
        note(number, (0.0, 0.0, 0.0))
        assert len(aims._ends) < 5000
    Queue.tag = 99_999
    assert aims.to_go_mm == (0, 0, 0)


@pytest.mark.parametrize("ahead", [10, 20_000])
def test_however_far_it_is_planned_ahead_the_end_of_the_move_in_hand_is_known(ahead: int) -> None:
    class Queue:
        tag = 0

    aims = Aims(Queue(), homed().controller.position)  # type: ignore[arg-type]
    note = aims.begin()
    for number in range(1, 60_000):
        note(number, (float(number % 50), 0.0, 0.0))
        Queue.tag = max(1, number - ahead)
        if not number % 97:
            assert aims.to_go_mm[0] == Queue.tag % 50
