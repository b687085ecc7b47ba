"""Where the work lies: the way to its zero, and the nine work offsets."""

import pytest

from fraese.control.state import Status
from fraese.control.workcommands import (
    go_to_zero,
    select_system,
    store_system,
    systems,
    way_to_zero,
)
from fraese.errors import LimitError, StateError, UsageError
from tests.helpers import homed, plant


def test_the_way_to_the_work_zero_is_up_over_down() -> None:
    made = homed()
    controller = made.controller
    for target in ({"x": 50.0, "y": 40.0}, {"z": -20.0}):
        controller.move_to(target, machine_coordinates=True)
        assert controller.run() is Status.OK
    controller.set_zero(("x", "y", "z"))
    controller.move_to({"x": 30, "y": -10})
    assert controller.run() is Status.OK
    assert way_to_zero(controller) == [(80, 30, 0), (50, 40, 0), (50, 40, -20)]
    go_to_zero(controller)
    assert controller.state().work_mm == (30, -10, 0), "nothing has moved before it runs"
    assert controller.run() is Status.OK
    assert controller.state().work_mm == (0, 0, 0)
    assert controller.state().position_mm == (50, 40, -20)


def test_without_a_reference_the_tool_is_lifted_a_little() -> None:
    controller = plant().controller
    controller.set_zero(("x",), -3)
    assert way_to_zero(controller) == [(0, 0, 5), (3, 0, 5), (3, 0, 0)]


def test_a_zero_outside_the_travel_moves_nothing() -> None:
    controller = homed().controller
    controller.set_zero(("x",), 400)
    with pytest.raises(LimitError):
        go_to_zero(controller)
    assert controller.state().position_mm == (0, 0, 0)


def test_work_offsets_are_chosen_changed_and_cleared() -> None:
    controller = homed().controller
    store_system(controller, "G59.1", {"x": 12.5, "z": -3})
    assert controller.state().work_mm == (0, 0, 0)
    select_system(controller, "G59.1")
    assert controller.state().work.system == "G59.1"
    assert controller.state().work_mm == (-12.5, 0, 3)
    assert dict(systems(controller))["G59.1"] == (12.5, 0, -3)
    assert [name for name, _ in systems(controller)][0::8] == ["G54", "G59.3"]
    store_system(controller, "G59.1", {})
    assert controller.state().work_mm == (0, 0, 0)
    with pytest.raises(UsageError, match="no work offset G60"):
        select_system(controller, "G60")


def test_work_offsets_stay_while_the_machine_runs() -> None:
    controller = homed().controller
    controller.move_to({"x": 10})
    with pytest.raises(StateError):
        select_system(controller, "G55")
    with pytest.raises(StateError):
        store_system(controller, "G54", {"x": 1})
    assert controller.run() is Status.OK
    assert controller.state().work_mm == (10, 0, 0)
