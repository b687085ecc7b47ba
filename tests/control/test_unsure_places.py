"""A work zero set before the reference run: it stays where it is on the table."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.savedstate import SavedState
from fraese.control.state import Status
from fraese.control.workoffsets import WorkOffsets
from fraese.workframe import ACTIVE_SYSTEM, G92_ACTIVE, WorkFrame, numbers
from tests.helpers import carriages, homed, plant

AXES = "xyz"


def _run(made: Plant) -> None:
    assert made.controller.run() is Status.OK, made.controller.state().message


def _home(made: Plant, *axes: str) -> None:
    made.controller.home(axes)
    _run(made)


def _stand(made: Plant, x: float, y: float) -> None:
    made.controller.move_to({"x": x, "y": y})
    _run(made)


def test_a_zero_of_before_the_reference_run_is_where_it_was_on_the_table() -> None:
    made = plant()
    _stand(made, 10, 5)
    made.controller.set_zero("xy")
    there = carriages(made)
    _home(made)
    assert "What was set before as G54 of X keeps its place." in made.controller.state().message
    made.controller.move_to({"x": 0, "y": 0})
    _run(made)
    assert carriages(made)[:2] == there[:2]


def test_a_zero_at_the_very_start_counts_too() -> None:
    made = plant()
    made.controller.set_zero("x")
    there = carriages(made)
    _home(made)
    made.controller.move_to({"x": 0})
    _run(made)
    assert carriages(made)[0] == there[0]


def test_what_was_never_set_is_machine_zero() -> None:
    made = plant()
    _stand(made, 10, 5)
    _home(made)
    assert made.controller.state().offset_mm == (0, 0, 0)
    assert "keeps its place" not in made.controller.state().message


def test_a_zero_of_a_referenced_machine_is_not_moved_by_another_reference_run() -> None:
    made = homed()
    _stand(made, 30, 20)
    made.controller.set_zero("xy")
    made.controller.position.lose_reference([0, 1])
    _stand(made, 2, 2)
    _home(made)
    assert made.controller.state().offset_mm == (30, 20, 0)


def test_it_outlives_the_program_in_between() -> None:
    made = plant()
    _stand(made, 10, 5)
    made.controller.set_zero("x")
    kept = made.controller.keep()
    again = SavedState.model_validate_json(kept.model_dump_json())
    made.controller.take_up(again)
    there = carriages(made)
    _home(made)
    made.controller.move_to({"x": 0})
    _run(made)
    assert carriages(made)[0] == there[0]


def test_of_axes_that_are_referenced_one_after_the_other_each_is_carried_once() -> None:
    made = plant()
    _stand(made, 10, 5)
    made.controller.set_zero("xy")
    there = carriages(made)
    for axis in ("x", "y", "x"):
        _home(made, axis)
    made.controller.move_to({"x": 0, "y": 0})
    _run(made)
    assert carriages(made)[:2] == there[:2]


@given(
    at=st.tuples(*[st.floats(-90, 90)] * 3),
    way=st.floats(-500, 500),
    system=st.integers(1, 9),
    rotation=st.sampled_from([0.0, 90.0, 30.0]),
    by_g92=st.booleans(),
)
def test_the_place_on_the_table_stays_whatever_set_it(
    at: tuple[float, ...], way: float, system: int, rotation: float, by_g92: bool
) -> None:
    referenced = [False] * 3
    offsets = WorkOffsets(AXES, lambda: referenced)
    first = 5201 + 20 * system
    offsets.take_up({ACTIVE_SYSTEM: system, first: 7.0, first + 9: rotation})
    if by_g92:
        shift = offsets.frame.to_work(at)
        places = dict(zip(numbers(5211, AXES), shift, strict=True))
        offsets.replace({**offsets.parameters, **places, G92_ACTIVE: 1.0})
    else:
        offsets.set_zero(AXES, at, 0.0)
    assert offsets.frame.to_work(at) == pytest.approx((0, 0, 0), abs=1e-6)
    for axis, letter in enumerate(AXES):
        referenced[axis] = True
        offsets.carry(letter, way)
    moved = tuple(mm + way for mm in at)
    assert offsets.frame.to_work(moved) == pytest.approx((0, 0, 0), abs=1e-6)
    assert offsets.frame == WorkFrame.of(offsets.parameters, AXES)


def test_what_is_kept_of_it_is_no_parameter_of_the_language() -> None:
    offsets = WorkOffsets(AXES, lambda: [False] * 3)
    offsets.set_zero("x", (4.0, 0.0, 0.0), 0.0)
    other = WorkOffsets(AXES, lambda: [True] * 3)
    other.take_up(offsets.kept())
    assert other.parameters == offsets.parameters
    assert other.carry("x", 3.0) == ("G54",)
    assert other.carry("x", 3.0) == ()


def test_a_zero_that_is_undone_is_as_sure_as_it_was() -> None:
    made = homed()
    _stand(made, 30, 20)
    made.controller.set_zero("x")
    made.controller.position.lose_reference([0])
    made.controller.set_zero("x", 5.0)
    made.controller.undo_zero()
    made.controller.move_to({"x": -20})
    _run(made)
    _home(made)
    assert made.controller.state().offset_mm[0] == 30
