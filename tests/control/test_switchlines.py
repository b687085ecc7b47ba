"""Inputs of their own: fewer candidates, switches for referencing only, a probe apart."""

from functools import partial
from typing import Any

import pytest

from fraese.assembly import Plant
from fraese.config.file import from_table
from fraese.control.endswitches import contact_bits
from fraese.control.state import Status
from fraese.errors import ConfigError
from fraese.motor.switches import AnyOf, SwitchInput
from tests.helpers import merged, mill, plant

#: X4Step's five inputs: one for each axis, one to reference Z, one for a probe.
FIVE: dict[str, Any] = {
    "switches": {
        "own": {
            "x": {"pin": 10, "ends": ["xmin", "xmax"]},
            "y": {"pin": 11, "ends": ["ymin", "ymax"], "closed_reads": 1},
            "z": {"pin": 12, "ends": ["zmin", "zmax"]},
            "ref": {"pin": 13, "ends": ["zmax"], "stops": False},
        }
    },
    "probe": {"pin": 15},
    "card": {"kind": "stepdir"},
}
SOME: dict[str, Any] = {"switches": {"own": {"z": {"pin": 12, "ends": ["zmin", "zmax"]}}}}
#: Short ways.
SMALL = {"axes": {name: {"travel_mm": 15} for name in "xyz"}}
UPPER: dict[str, Any] = {
    "axes": {"x": {"inverted": True}},
    "simulation": {"axes": {"x": {"inverted": True}}},
}


def closed_names(made: Plant, *ends: str) -> tuple[str, ...]:
    for end in ends:
        made.press(end, True)
    for _ in range(made.config.switches.readings):
        made.controller.idle()
    return made.controller.state().ends


def test_any_of_the_bits_is_a_contact_and_none_of_them_is_none() -> None:
    """Also with levels that differ; with one bit it is what it was, with none it is never."""
    for mask, closed, status, contact in (
        (0x50, 0x10, 0x40, False),
        (0x50, 0x10, 0x50, True),
        (0x50, 0x10, 0x00, True),
        (0x50, 0x10, 0x10, True),
        (0x80, 0x00, 0x00, True),
        (0x80, 0x00, 0x80, False),
        (0x00, 0x01, 0x00, False),
        (0x00, 0x01, 0xFF, False),
    ):
        condition = AnyOf(mask, closed, 1)
        condition.take(status, lambda: ())
        assert condition.is_true is contact, (mask, closed, status)


def test_the_bits_are_those_of_all_inputs_that_stop() -> None:
    assert contact_bits(from_table(FIVE, "test")) == (0x40 | 0x80 | 0x20, 0x80)
    assert contact_bits(from_table(SOME, "test")) == (0x80 | 0x20, 0x00)
    assert SwitchInput(*contact_bits(from_table({}, "test"))) == SwitchInput()


@pytest.mark.parametrize(
    "tables", [FIVE, SOME, merged(FIVE, UPPER)], ids=["five", "some", "inverted"]
)
def test_a_reference_run_finds_every_end_on_its_input(tables: dict[str, Any]) -> None:
    made = plant(**merged(tables, SMALL))
    made.controller.home(measure=True)
    assert made.controller.run() is Status.OK, made.controller.state().message
    state = made.controller.state()
    assert state.position_mm == (0, 0, 0)
    assert state.lost_steps == (0, 0, 0)
    # The simulated mill, which is told where its switches really are, agrees.
    assert state.carriages_mm == pytest.approx((0, 0, 0), abs=0.006)


def test_it_is_referenced_by_the_switch_that_is_there_for_it() -> None:
    """A millimetre before the end, and no contact stops there."""
    by_end, by_reference = plant(**(FIVE | {"switches": {"own": {
        name: own for name, own in FIVE["switches"]["own"].items() if name != "ref"
    }}})), plant(**FIVE)  # fmt: skip
    for made in (by_end, by_reference):
        made.controller.home(["z"])
        assert made.controller.run() is Status.OK, made.controller.state().message
    z_steps = [mill(made).mill.carriages_steps()[2] for made in (by_end, by_reference)]
    assert z_steps[0] - z_steps[1] == pytest.approx(200, abs=2)


def test_fewer_ends_are_named_where_the_input_tells() -> None:
    # Standing: nothing has moved, so on one input it may be any.
    assert len(closed_names(plant(), "ymax")) == 6
    assert closed_names(plant(**FIVE), "ymax") == ("ymin", "ymax")
    assert closed_names(plant(**SOME), "zmin") == ("zmin", "zmax")
    assert closed_names(plant(**SOME), "ymax") == ("xmin", "xmax", "ymin", "ymax")
    assert closed_names(plant(**FIVE), "ymax", "zmin") == ("ymin", "ymax", "zmin", "zmax")


def test_on_a_diagonal_the_end_is_named_that_was_met() -> None:
    for tables, ends in (({}, ("xmax", "ymax")), (FIVE, ("ymax",))):
        made = plant(**tables)
        made.controller.set_break_key(partial(press_on_the_way, made))
        made.controller.move_to({"x": 20, "y": 20}, relative=True)
        assert made.controller.run() is Status.ERROR
        assert made.controller.state().ends == ends


def press_on_the_way(made: Plant) -> None:
    if made.controller.state().position_mm[0] > 5:
        made.press("ymax", True)


def test_two_closed_inputs_are_both_left_before_a_reference_run() -> None:
    """In a corner: one axis after the other backs off its own."""
    made = plant(**merged(FIVE, SMALL))
    mill(made).mill.place(0, -10, made.clock.now_ns())
    mill(made).mill.place(1, 3_010, made.clock.now_ns())
    for _ in range(10):
        made.controller.idle()
    assert made.controller.state().switch_closed
    made.controller.home()
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert made.controller.state().carriages_mm == pytest.approx((0, 0, 0), abs=0.006)


def test_a_probe_of_its_own_is_no_end_switch() -> None:
    made = plant(**FIVE)
    made.controller.idle()
    assert not made.controller.switches.probe_closed
    mill(made).inputs &= ~0x08
    for _ in range(5):
        made.controller.idle()
    assert made.controller.switches.probe_closed
    assert not made.controller.state().switch_closed


@pytest.mark.parametrize(
    ("own", "said"),
    [
        ({"x": {"pin": 11, "ends": ["xmin"]}}, "switches.own.x.pin 11 is that of switches already"),
        ({"x": {"pin": 10, "ends": ["amin"]}}, 'there is no end switch "amin"; there are xmin'),
        (
            {"a": {"pin": 10, "ends": ["xmin"]}, "b": {"pin": 12, "ends": ["xmin"]}},
            "switches.own.b.ends: xmin is on another input already",
        ),
        ({"X": {"pin": 10}}, r"inputs are named in small letters, as in \[switches.own.x\]"),
    ],
)
def test_inputs_that_cannot_be_are_a_sentence(own: Any, said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        from_table({"switches": {"own": own}}, "test")
