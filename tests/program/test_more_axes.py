"""Programs on machines of one to four axes, by the carriages of the simulated mill."""

from pathlib import Path
from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.errors import LimitError, ProgramError
from tests.helpers import carriages, plant, program, run_program


def machine(axes: str, **tables: Any) -> Plant:
    """A, B and C turn, 36000 half-steps once round."""
    turning = {name: {"travel_deg": 360, "gear": "90"} for name in axes if name in "abc"}
    table = {"names": list(axes), **turning, **tables}
    return plant(card={"kind": "stepdir"}, axes=table, run={"unreferenced_percent": 100})


def moved(made: Plant, before: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(now - then for now, then in zip(carriages(made), before, strict=True))


@pytest.mark.parametrize("axes", ["xyza", "azxy", "xyzu"])
def test_four_axes_end_where_the_program_says(tmp_path: Path, axes: str) -> None:
    made = machine(axes)
    before = carriages(made)
    fourth = (set(axes) - set("xyz")).pop()
    text = (
        f"G21 G90 G1 X10 Y5 Z-1 {fourth}20 F600\nG2 X20 Y5 I5 J0 {fourth}30\nG0 {fourth}0.9\nM2\n"
    )
    assert run_program(made, program(tmp_path, text)) is Status.OK, made.controller.state().message
    wanted = {"x": 20.0, "y": 5.0, "z": -1.0, fourth: 0.9}
    steps = tuple(axis.to_steps(wanted[axis.name]) for axis in made.controller.machine.axes)
    assert made.controller.state().position_steps == steps
    linear = [axis.kind == "linear" for axis in made.controller.machine.axes]
    seen = zip(moved(made, before), steps, linear, strict=True)
    assert all(by == wanted_steps for by, wanted_steps, counts in seen if counts)


@pytest.mark.parametrize(
    ("text", "wanted_s"),
    [
        ("G1 A60 F60\n", 60),
        ("G1 X10 A60 F60\n", 10),
        ("G93 G1 X10 A60 F2\n", 30),
        ("G20 G1 A60 F60\n", 60),
    ],
)
def test_the_feed_of_a_rotary_axis(tmp_path: Path, text: str, wanted_s: float) -> None:
    made = machine("xyza")
    assert run_program(made, program(tmp_path, text)) is Status.OK
    job = made.controller.state().job
    assert job is not None
    assert job.elapsed_s == pytest.approx(wanted_s, rel=0.02)


def test_a_plotter_draws_arcs_and_drives_round_its_frame(tmp_path: Path) -> None:
    made = machine("xy")
    part = program(tmp_path, "G1 X10 F600\nG2 X20 I5\nG1 Y10\nM2\n")
    assert run_program(made, part) is Status.OK
    assert made.controller.state().position_mm == (20, 10)
    part.drive_frame(made.controller)
    assert made.controller.run() is Status.OK
    assert made.controller.state().position_mm == (10, 10)
    assert part.way_from(made.controller, 3)[1:3] == [
        "  rapid to X 20.000 Y 10.000 mm (machine)",
        "  feed 600 mm/min to X 20.000 Y 10.000 mm (machine)",
    ]


def test_a_frame_without_x_and_y_is_refused(tmp_path: Path) -> None:
    made = machine("za")
    with pytest.raises(ProgramError, match="no frame"):
        program(tmp_path, "G0 A10 Z-1\nM2\n").drive_frame(made.controller)


def test_a_frame_of_one_axis_is_a_line(tmp_path: Path) -> None:
    made = machine("xz")
    part = program(tmp_path, "G0 X5\nG1 Z-1 F600\nX20\nM2\n")
    seen: list[float] = []
    made.controller.set_show_pos(lambda: seen.append(made.controller.state().position_mm[0]))
    part.drive_frame(made.controller)
    assert made.controller.run() is Status.OK
    assert max(seen) == pytest.approx(20, abs=2)
    assert made.controller.state().position_mm == (5, 0)


def test_from_a_line_a_rotary_axis_goes_over_with_the_others(tmp_path: Path) -> None:
    made = machine("xyza")
    part = program(tmp_path, "G0 X10 A90\nG1 Z-5 F120\nX20 A100\nX30\nM2\n")
    assert part.way_from(made.controller, 4)[1:3] == [
        "  rapid to X 20.000 Y 0.000 Z 0.000 mm A 100.000° (machine)",
        "  feed 120 mm/min to X 20.000 Y 0.000 Z -5.000 mm A 100.000° (machine)",
    ]
    assert run_program(made, part, from_line=4) is Status.OK
    assert made.controller.state().position_mm == (30, 0, -5, 100)


def test_a_feed_of_degrees_is_called_that(tmp_path: Path) -> None:
    made = machine("xa")
    part = program(tmp_path, "G0 X0\nF360\nG1 A30\nG1 A60 X1\nM2\n")
    way = part.way_from(made.controller, 3)
    assert way[-2] == "  feed 360 °/min to X 0.000 mm A 30.000° (machine)"
    assert "with feed 360 mm/min or 360 °/min," in way[-1]
    seen: dict[int, set[str]] = {}

    def look() -> None:
        state = made.controller.state()
        if state.running and state.job:
            seen.setdefault(state.job.line, set()).add(state.speed_unit)

    made.controller.set_show_pos(look)
    assert run_program(made, part) is Status.OK
    assert seen == {3: {"°"}, 4: {"mm"}}


def test_from_a_line_the_way_is_never_below_the_place(tmp_path: Path) -> None:
    made = plant(run={"safe_z_mm": -10})
    part = program(tmp_path, "G0 X10 Z-2\nG1 X20 F120\nX30\nM2\n")
    heights = [
        line.split("Z")[1].split()[0] for line in part.way_from(made.controller, 3) if "Z" in line
    ]
    assert heights == ["-2.000", "-2.000"]


def test_the_travel_of_a_rotary_axis_is_seen_to(tmp_path: Path) -> None:
    made = machine("xyza")
    with pytest.raises(LimitError, match=r"A would move 400\.000°, further than its whole travel"):
        run_program(made, program(tmp_path, "G0 A400\nM2\n"))


def test_a_survey_counts_lengths_only(tmp_path: Path) -> None:
    made = machine("xyza")
    facts = program(tmp_path, "G0 X10 A5\nA90\nG1 F100 X13 Y4\nM2\n").check(made.controller)
    assert facts.length_mm == pytest.approx(15)
    assert (facts.low_mm, facts.high_mm) == ((10, 0, 0, 5), (13, 4, 0, 90))
