"""Panel, ``move``, ``zero`` and program mean the same by work coordinates, whatever is in force."""

from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.errors import LimitError
from tests.helpers import after_slices, homed, program, run_program

TOOLS: dict[str, Any] = {"tools": {"1": {"length_mm": 3}, "2": {"length_mm": 12.5}}}
#: Rotated, shifted, with G92 and a tool.
CROOKED = (
    "G10 L2 P1 X100 Y40 Z-5 R30\nG43 H1\nG0 X20 Y10 Z-5\nG92 X18 Y12 Z-4\nM2\n",
    "G10 L2 P2 X150 Y80 Z-7 R-90\nG55\nG43 H1\nG52 X1 Y2 Z-1\nG0 X20 Y10 Z-5\n"
    "G10 L2 P1 X150 Y80 Z-7 R-90\nM2\n",
)


def after(folder: Path, text: str, **config: Any) -> Plant:
    """A referenced machine on which a program has run."""
    made = homed(**{**TOOLS, **config})
    assert run_program(made, program(folder, text)) is Status.OK, made.controller.state().message
    return made


def about(*values: float) -> Any:
    return pytest.approx(values, abs=1e-9)


def test_a_rotated_system_is_rotated_on_the_panel(tmp_path: Path) -> None:
    state = after(tmp_path, "G10 L2 P1 R90\nG0 X10 Y0\nM2\n").controller.state()
    assert state.position_mm == (0, 10, 0)
    assert state.work_mm == about(10, 0, 0)


def test_the_length_of_the_tool_is_in_the_work_coordinates(tmp_path: Path) -> None:
    state = after(tmp_path, "G43 H1\nG0 Z-5\nM2\n").controller.state()
    assert state.position_mm == (0, 0, -2)
    assert state.work_mm == about(0, 0, -5)
    assert (state.work.tool_offset_mm, state.work.tool) == ((0, 0, 3), 0)


def test_a_tool_and_its_length_outlive_the_program(tmp_path: Path) -> None:
    made = after(tmp_path, "M61 Q2 G43\nM2\n")
    assert (made.controller.state().work.tool, made.controller.state().work_mm[2]) == (2, -12.5)
    assert run_program(made, program(tmp_path, "G0 Z-13\nM2\n")) is Status.OK
    assert made.controller.state().position_mm[2] == -0.5
    # G43 without H is of the tool that is in the spindle.
    assert run_program(made, program(tmp_path, "G49\nG0 Z-1\nG43\nM2\n")) is Status.OK
    assert made.controller.state().work_mm[2] == -13.5


def test_a_tool_length_is_kept_in_the_state(tmp_path: Path) -> None:
    made = after(tmp_path, "M61 Q1 G43\nG0 Z-5\nM2\n")
    again = homed(**TOOLS)
    again.controller.take_up(made.controller.keep())
    assert again.controller.state().work == made.controller.state().work
    assert again.controller.state().work_mm == made.controller.state().work_mm


@pytest.mark.parametrize("text", CROOKED)
def test_a_program_and_the_panel_agree(tmp_path: Path, text: str) -> None:
    made = after(tmp_path, text)
    assert run_program(made, program(tmp_path, "G0 X11 Y7 Z-9\nM2\n")) is Status.OK
    assert made.controller.state().work_mm == pytest.approx((11, 7, -9), abs=0.005)


@pytest.mark.parametrize("text", CROOKED)
def test_a_move_goes_where_the_program_would(tmp_path: Path, text: str) -> None:
    made = after(tmp_path, text)
    controller = made.controller
    assert run_program(made, program(tmp_path, "G0 X11 Y7\nM2\n")) is Status.OK
    by_program = controller.state().position_steps
    assert run_program(made, program(tmp_path, "G0 X1 Y-2\nM2\n")) is Status.OK
    controller.move_to({"x": 11, "y": 7})
    assert controller.run() is Status.OK
    assert controller.state().position_steps == by_program
    controller.move_to({"x": -1, "y": 2}, relative=True)
    assert controller.run() is Status.OK
    assert controller.state().work_mm[:2] == pytest.approx((10, 9), abs=0.005)
    z_steps = controller.state().position_steps[2]
    controller.run_curve([(9, 9, -9), (11, 7, controller.state().work_mm[2])])
    assert controller.run() is Status.OK
    assert controller.state().position_steps == (*by_program[:2], z_steps)


@pytest.mark.parametrize("text", CROOKED)
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_zero_is_of_the_axis_that_was_asked_for(tmp_path: Path, text: str, axis: int) -> None:
    made = after(tmp_path, text)
    wanted = list(made.controller.state().work_mm)
    wanted[axis] = 4.5
    made.controller.set_zero("xyz"[axis], 4.5)
    assert made.controller.state().work_mm == about(*wanted)
    # As G10 L20 has it: the program finds itself at the same place.
    steps = made.controller.state().position_steps
    words = " ".join(f"{name}{mm:.9f}" for name, mm in zip("XYZ", wanted, strict=True))
    assert run_program(made, program(tmp_path, f"G1 F600 {words}\nM2\n")) is Status.OK
    assert made.controller.state().position_steps == steps


@pytest.mark.parametrize("text", CROOKED)
@pytest.mark.parametrize("letter", ["X", "Y", "Z", "XY", "XYZ"])
def test_zero_is_what_g10_l20_does(tmp_path: Path, text: str, letter: str) -> None:
    by_hand, by_program = after(tmp_path, text), after(tmp_path, text)
    by_hand.controller.set_zero(letter.lower())
    words = " ".join(f"{name}0" for name in letter)
    assert run_program(by_program, program(tmp_path, f"G10 L20 P0 {words}\nM2\n")) is Status.OK
    kept = [made.controller.keep().parameters for made in (by_hand, by_program)]
    assert kept[0] == pytest.approx(kept[1], abs=1e-9)


def test_what_is_in_force_is_that_of_the_block_in_hand(tmp_path: Path) -> None:
    made = homed(**TOOLS)
    controller = made.controller
    seen: list[tuple[float, tuple[float, ...]]] = []
    controller.set_show_pos(
        lambda: seen.append((controller.state().work.rotation_deg, controller.state().work_mm))
    )
    text = "G1 X20 F1200\nG10 L2 P1 R90\nG43 H2\nG1 X40\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.OK
    plain = [work_mm for rotation_deg, work_mm in seen if not rotation_deg]
    turned = [work_mm for rotation_deg, work_mm in seen if rotation_deg == 90]
    assert len(plain) + len(turned) == len(seen)
    assert len(plain) > 3
    assert len(turned) > 3
    assert all(x >= 0 and y == z == 0 for x, y, z in plain)
    assert all(y == pytest.approx(-20, abs=1e-9) and z == -12.5 for _x, y, z in turned)


def test_a_tool_length_that_was_only_read_does_not_count(tmp_path: Path) -> None:
    made = homed(**TOOLS)
    after_slices(made.controller, 15, made.controller.cancel)
    text = "G43 H1\nG1 X20 F300\nG43 H2\nG1 X0\nM2\n"
    assert run_program(made, program(tmp_path, text)) is Status.CANCEL
    assert 2 < made.controller.state().position_mm[0] < 19
    assert made.controller.state().work.tool_offset_mm == (0, 0, 3)


def test_the_way_that_is_left_is_said_in_work_coordinates(tmp_path: Path) -> None:
    controller = after(tmp_path, "G10 L2 P1 X100\nG43 H1\nM2\n").controller
    with pytest.raises(LimitError, match=r"\(work -100\.000 to 196\.000\)"):
        controller.move_to({"x": 200})
    with pytest.raises(LimitError, match=r"\(work -59\.000 to -3\.000\)"):
        controller.move_to({"z": 1})


def test_a_rotated_axis_has_no_way_of_its_own(tmp_path: Path) -> None:
    controller = after(tmp_path, "G10 L2 P1 R45\nM2\n").controller
    with pytest.raises(LimitError) as refused:
        controller.move_to({"x": 290, "y": 0})
    assert "Y 205.060 mm is outside the travel" in str(refused.value)
    assert "work" not in str(refused.value)
