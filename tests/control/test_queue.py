"""The motion queue: what is finished, how much lies ahead, and when an input is known."""

from pathlib import Path

import pytest

from fraese.control.about import About
from fraese.control.jobs import Job
from fraese.control.state import Status
from fraese.errors import StateError
from fraese.planner.lines import plan_line
from tests.helpers import after_slices, axes, carriages, homed, look, plant, program, run_program


def test_a_block_is_finished_when_its_last_step_is_made() -> None:
    made = plant()
    controller = made.controller
    for _job in range(2):
        start = carriages(made)[0]
        seen: list[tuple[float, int]] = []

        def break_key(start: float = start, seen: list[tuple[float, int]] = seen) -> None:
            seen.append((carriages(made)[0] - start, controller.blocks_finished()))

        controller.set_break_key(break_key)
        # Every point is a block of 100 steps, and its end is between two looks.
        controller.run_curve([(at / 2, 0, 0) for at in range(1, 9)], 199)
        assert controller.run() is Status.OK
        assert {finished for _, finished in seen} >= set(range(8))
        assert all(finished == min(steps // 100, 8) for steps, finished in seen), seen
        assert (controller.blocks_finished(), controller.blocks_pushed()) == (8, 8)
        controller.set_break_key(lambda: None)
        controller.move_to({"x": 0})
        controller.run()


@pytest.mark.parametrize("bounce", range(1, 12, 2))
def test_an_input_that_bounces_is_known_before_anything_moves(bounce: int) -> None:
    made = plant(simulation={"bounce_readings": bounce})
    controller = made.controller
    before = carriages(made)
    made.press("ymin", True)
    with pytest.raises(StateError, match="is closed"):
        controller.move_to({"x": 5})
    made.press("ymin", False)
    controller.move_to({"x": 5})
    assert controller.run() is Status.OK
    assert carriages(made)[0] - before[0] == 1000


def test_short_lines_of_a_machine_that_brakes_slowly_never_run_dry(tmp_path: Path) -> None:
    """The queue holds as much as braking takes, here two seconds, and not only ``lead_s``."""
    made = plant(axes=axes(acceleration_hz_s=2000), run={"lead_s": 0.1})
    controller = made.controller
    for name in controller.machine.names:
        controller.position.set_reference(name, 0)
    text = "F1200\n" + "".join(f"G1 X{mm}\n" for mm in range(1, 101)) + "M2\n"
    speeds: list[float] = []

    def show_pos() -> None:
        speeds.append(controller.state().speed_mm_min)
        assert controller.state().dry_queues == 0

    controller.set_show_pos(show_pos)
    assert run_program(made, program(tmp_path, text)) is Status.OK
    assert max(speeds) == pytest.approx(1200, rel=0.01)
    assert look(made).lost_steps == (0, 0, 0)


def test_a_jog_off_a_closed_switch_and_no_further_in() -> None:
    made = homed()
    controller = made.controller
    # Elsewhere in its travel no other end can be meant.
    controller.move_to({"x": 1, "y": 50, "z": -20})
    assert controller.run() is Status.OK
    made.press("xmin", True)
    stood = carriages(made)
    with pytest.raises(StateError, match="End switch xmin is closed"):
        controller.jog("x", -0.5)
    assert carriages(made) == stood
    controller.jog("x", 3)
    # The hand is taken away while it moves: from then on the switches count as usual again.
    after_slices(controller, 1, lambda: made.press("xmin", False))
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 4
    after_slices(controller, 1, lambda: made.press("xmin", True))
    controller.jog("x", -3)
    assert controller.run() is Status.ERROR
    assert 1 < controller.state().position_mm[0] < 4


def test_the_line_of_the_job_before_is_not_that_of_this_one() -> None:
    made = plant()
    controller = made.controller

    def job(tag: int) -> Job:
        block = plan_line(made.controller.machine, (200, 0, 0), 600.0, tag=tag)
        assert block is not None
        yield block

    controller.start("one", job(774), About(lines=1000))
    controller.run()
    progress = controller.state().job
    assert progress is not None
    assert progress.line == 774
    controller.start("two", job(3), About(lines=39))
    progress = controller.state().job
    assert progress is not None
    assert progress.line == 0
    controller.run()
    progress = controller.state().job
    assert progress is not None
    assert progress.line == 3
