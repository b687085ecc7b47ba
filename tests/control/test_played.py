"""What was dropped was not played: the carriages of the simulated mill are the truth.

The spindles of these mills have the very play that is configured, so that a carriage stands where
the position says, to the step, whatever ended the job.
"""

from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.motor.ports.sim import SimulatedMill
from tests.helpers import (
    STEPDIR,
    after_slices,
    axes,
    carriages,
    homed,
    merged,
    mill,
    plant,
    program,
    put,
    run_program,
)

BACKLASH_MM = 0.1
#: Slow enough for a stop without ramp; several blocks of the zigzag are in the queue.
SLOW_MM_MIN = 200
PLAY: dict[str, Any] = {
    "axes": axes(backlash_mm=str(BACKLASH_MM)),
    "simulation": {"backlash_mm": BACKLASH_MM},
}
CARDS = pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])
#: Every line turns round, so that there is a take-up before each of them.
ZIGZAG = [(0.3, -0.2, 0), (-0.2, 0.4, 0), (0.5, -0.1, 0), (0, 0.3, 0)] * 4


def assert_true(made: Plant, start: tuple[float, ...]) -> None:
    """Every carriage has moved by as much as the position."""
    controller = made.controller
    signs = [axis.motor_sign for axis in controller.machine.axes]
    moved = [sign * (now - then)
             for sign, now, then in zip(signs, carriages(made), start, strict=True)]  # fmt: skip
    assert tuple(moved) == controller.position.position_steps


@CARDS
@pytest.mark.parametrize("number", [2, 5, 14, 20, 26, 32, 35])
@pytest.mark.parametrize("ending", ["stop", "cancel"])
def test_stopped_or_cancelled_the_position_is_the_carriages(
    card: dict[str, Any], ending: str, number: int
) -> None:
    made = plant(**merged(card, PLAY))
    controller = made.controller
    start = carriages(made)
    controller.run_curve(ZIGZAG, SLOW_MM_MIN)
    after_slices(controller, number, getattr(controller, ending))
    assert controller.run() is Status.CANCEL
    assert_true(made, start)
    # Also on the next way, which takes up what slack is thought to be there.
    controller.set_break_key(lambda: None)
    controller.acknowledge()
    controller.move_to({"x": 3, "y": -3})
    assert controller.run() is Status.OK
    assert_true(made, start)
    assert controller.state().position_mm == (3, -3, 0)


@CARDS
@pytest.mark.parametrize("room_steps", [4, 26, 59])
def test_at_a_contact_the_position_is_the_carriages(card: dict[str, Any], room_steps: int) -> None:
    made = plant(**merged(card, PLAY))
    controller = made.controller
    put(made, "x", 60_000 - room_steps)
    start = carriages(made)
    controller.run_curve(ZIGZAG, SLOW_MM_MIN)
    assert controller.run() is Status.ERROR
    assert "xmax" in controller.state().ends
    assert_true(made, start)


@pytest.mark.parametrize("number", range(2, 14))
@pytest.mark.parametrize("ending", ["stop", "cancel"])
def test_a_work_offset_that_was_only_read_ahead_is_not_in_force(
    tmp_path: Path, ending: str, number: int
) -> None:
    made = homed(**PLAY)
    controller = made.controller
    text = "G10 L2 P2 X5\nG1 X1 F200\nX0\nG55\nX-1\nX0\nX1\nM2\n"
    program_ = program(tmp_path, text)
    after_slices(controller, number, getattr(controller, ending))
    assert run_program(made, program_) is Status.CANCEL
    state = controller.state()
    assert state.job is not None
    assert 1 < state.job.line < 7
    assert state.offset_mm[0] == (5 if state.job.line > 4 else 0)


@pytest.mark.parametrize("number", range(24, 36, 2))
def test_a_way_aside_counts_for_nothing(tmp_path: Path, number: int) -> None:
    """Held with G55 read ahead, lifted, brought back, and stopped: as without the hold."""
    made = homed(**merged(PLAY, {"run": {"retract_mm": 1.0, "lead_s": 1.0}}))
    controller = made.controller
    text = "G10 L2 P2 X5\nG1 X1 F200\nX0\nX1\nG55\nX-1\nX0\nX1\nM2\n"
    slices: list[int] = []
    heights_mm: list[float] = []

    def break_key() -> None:
        slices.append(1)
        heights_mm.append(controller.state().position_mm[2])
        if len(slices) == 2:
            controller.hold()
        if len(slices) == 20:
            controller.resume()
        if len(slices) == number:
            assert controller.blocks_finished() <= controller.blocks_pushed()
            controller.stop()

    program_ = program(tmp_path, "G0 Z-3\n" + text)
    controller.set_break_key(break_key)
    assert run_program(made, program_) is Status.CANCEL
    state = controller.state()
    assert state.job is not None
    assert heights_mm[15] > -3
    assert state.position_mm[2] == -3
    assert state.offset_mm[0] == (5 if state.job.line > 6 else 0)


LINES = st.lists(st.tuples(*[st.integers(-60, 60)] * 3).filter(any), min_size=1, max_size=12)
#: Readings of the inputs: one after every motor movement, some between the jobs.
MOMENTS = st.integers(1, 2_000)
ENDINGS = st.sampled_from(["stop", "cancel", "contact", "hold"])


def at_reading(made: Plant, number: int, action: Callable[[], object]) -> None:
    """Do something at the n-th reading of the inputs from now on, in the middle of motion."""
    port, readings = mill(made), count(1)
    read = SimulatedMill.read_status

    def read_status() -> int:
        if next(readings) == number:
            action()
        return read(port)

    port.read_status = read_status  # type: ignore[method-assign]


def actions(made: Plant) -> dict[str, Callable[[], object]]:
    controller = made.controller
    return {
        "stop": controller.stop,
        "cancel": controller.cancel,
        "contact": lambda: made.press("ymax", True),
        "hold": controller.hold,
    }


@settings(max_examples=150)
@given(LINES, st.lists(st.tuples(ENDINGS, MOMENTS), max_size=3), st.sampled_from([{}, STEPDIR]))
def test_the_position_is_the_carriages_always(
    lines: list[tuple[int, int, int]], endings: list[tuple[str, int]], card: dict[str, Any]
) -> None:
    """Random lines, broken off at any tick: the hand at the break key is as quick as the port."""
    made = plant(**merged(card, PLAY))
    controller = made.controller
    start = carriages(made)
    for ending, moment in endings:
        at_reading(made, moment, actions(made)[ending])
        # A hold is lifted by the operator, who looks at the machine now and then.
        controller.set_break_key(lambda: controller.resume() if controller.state().held else None)
        where = list(controller.position.position_steps)
        points = []
        for line in lines:
            where = [at + n for at, n in zip(where, line, strict=True)]
            points.append(controller.machine.to_mm(tuple(where)))
        controller.drive_points("lines", points, SLOW_MM_MIN)
        controller.run()
        controller.acknowledge()
        assert_true(made, start)
        made.press("ymax", False)
        controller.idle(1.0)


@pytest.mark.parametrize("order", ["hold", "cancel", "stop"])
def test_an_order_that_comes_while_a_job_starts_counts_for_it(order: str) -> None:
    """Neither is it lost, nor do the motors stand braked with nobody to lift it."""
    made = plant()
    controller = made.controller
    driver: Any = controller._driver
    flush = driver.flush

    def flush_with_an_order() -> None:
        flush()
        getattr(controller, order)()
        driver.flush = flush

    driver.flush = flush_with_an_order
    before = carriages(made)
    controller.jog("x", 5)
    seen: list[tuple[float, ...]] = []

    def break_key() -> None:
        seen.append(carriages(made))
        if len(seen) == 10:
            controller.resume()

    controller.set_break_key(break_key)
    if order == "hold":
        assert controller.run() is Status.OK
        assert set(seen[:10]) == {before}
        assert controller.state().position_mm[0] == 5
    else:
        assert controller.run() is Status.CANCEL
        assert carriages(made) == before
