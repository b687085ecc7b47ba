"""Reference runs: from anywhere, to either end, with switches as bad as they come."""

from itertools import permutations, product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.state import Status
from fraese.errors import HomingError, StateError
from tests.helpers import (
    AXES,
    STEPDIR,
    TRAVEL_STEPS,
    ZERO_STEPS,
    after_slices,
    axes,
    carriages,
    end,
    look,
    merged,
    mill,
    plant,
    put,
)

#: Behind its switch a carriage has two millimetres, 400 steps.
OVERRUN_STEPS = 400
#: A short mill: reference runs of seconds.
SHORT: dict[str, Any] = {
    "axes": {name: {"travel_mm": "20"} for name in AXES},
}
SHORT_STEPS = 4000


def reference(made: Plant, *names: str, measure: bool | None = None) -> str:
    """Run it; what was said."""
    made.controller.home(names, measure=measure)
    status = made.controller.run()
    assert status is Status.OK, made.controller.state().message
    return made.controller.state().message


def assert_zero(made: Plant, expected: tuple[float, ...]) -> None:
    state = made.controller.state()
    assert state.referenced == (True, True, True)
    assert state.position_steps == (0, 0, 0)
    assert carriages(made) == expected
    assert not state.switch_closed
    assert look(made).pressed == ()


# --- where zero is -------------------------------------------------------------------------------


@pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])
@pytest.mark.parametrize("inverted", [False, True])
def test_zero_lies_at_the_pull_off_distance(card: dict[str, Any], inverted: bool) -> None:
    made = plant(**merged(card, SHORT, {"axes": axes(inverted=inverted)}))
    assert reference(made) == "Referenced: Z, X, Y."
    # The mill counts in motor direction: an inverted axis stands at its other switch.
    low, high = 400, SHORT_STEPS - 400
    assert_zero(made, (high, high, low) if inverted else (low, low, high))
    assert look(made).lost_steps == (0, 0, 0)


@pytest.mark.parametrize("ends", list(product(("min", "max"), repeat=3)))
def test_every_combination_of_home_ends(ends: tuple[str, ...]) -> None:
    sections = {"axes": {n: {"home_end": e} for n, e in zip(AXES, ends, strict=True)}}
    made = plant(**merged(SHORT, sections))
    reference(made)
    assert_zero(made, tuple(400 if e == "min" else SHORT_STEPS - 400 for e in ends))
    state = made.controller.state()
    assert state.low_mm == tuple(0 if e == "min" else -16 for e in ends)
    assert state.high_mm == tuple(16 if e == "min" else 0 for e in ends)


@pytest.mark.parametrize("order", list(permutations(AXES)))
def test_every_order(order: tuple[str, ...]) -> None:
    made = plant(**merged(SHORT, {"homing": {"order": list(order)}}))
    begun: list[int] = []

    def show() -> None:
        for motor, steps in enumerate(made.controller.state().position_steps):
            if abs(steps) > 2 and motor not in begun:
                begun.append(motor)

    made.controller.set_show_pos(show)
    assert reference(made) == "Referenced: " + ", ".join(order).upper() + "."
    assert begun == [AXES.index(name) for name in order]


def test_chosen_axes_only_in_the_configured_order() -> None:
    made = plant(**SHORT)
    assert reference(made, "y", "z") == "Referenced: Z, Y."
    assert made.controller.state().referenced == (False, True, True)


def test_an_axis_missing_in_the_order_can_be_referenced_by_name() -> None:
    made = plant(**merged(SHORT, {"homing": {"order": ["z"]}}))
    assert reference(made) == "Referenced: Z."
    assert reference(made, "x") == "Referenced: X."


def test_the_other_end_measures_the_travel() -> None:
    made = plant(
        **merged(SHORT, {"axes": axes(backlash_mm="0.1"), "simulation": {"backlash_mm": 0.1}})
    )
    said = reference(made, measure=True)
    assert "X (travel 20.000 mm, configured 20 mm)" in said
    assert made.controller.state().referenced == (True, True, True)
    assert made.controller.state().position_mm == (0, 0, 0)


def test_a_travel_configured_too_long_is_measured() -> None:
    made = plant(**merged(SHORT, {"homing": {"measure": True}}))
    mill(made).mill.switches_steps[0] = (0, 3900)
    assert "X (travel 19.500 mm, configured 20 mm)" in reference(made)


@pytest.mark.parametrize("turned", [False, True])
def test_backlash_does_not_shift_zero(turned: bool) -> None:
    sections = {
        "axes": axes(backlash_mm="0.2", inverted=turned),
        "simulation": {"backlash_mm": 0.2},
    }
    made = plant(**merged(SHORT, sections))
    reference(made)
    low, high = 400, SHORT_STEPS - 400
    assert_zero(made, (high, high, low) if turned else (low, low, high))
    for target in (5, 2, 3):
        made.controller.move_to({"x": target, "z": -target})
        assert made.controller.run() is Status.OK
    sign = -1 if turned else 1
    now = carriages(made)
    assert now[0] == (high if turned else low) + sign * 600
    assert now[2] == (low if turned else high) - sign * 600


# --- from where ----------------------------------------------------------------------------------


@settings(max_examples=30)
@given(st.tuples(*(st.integers(-90, travel + 90) for travel in (SHORT_STEPS,) * 3)))
def test_zero_is_the_same_to_the_step_from_anywhere(start: tuple[int, ...]) -> None:
    made = plant(**SHORT)
    for name, steps in zip(AXES, start, strict=True):
        put(made, name, steps)
    reference(made)
    assert_zero(made, (400, 400, SHORT_STEPS - 400))
    assert look(made).lost_steps == (0, 0, 0)


CORNERS = [corner for corner in product((None, 0, SHORT_STEPS), repeat=3) if any(
    place is not None for place in corner
)]  # fmt: skip


@pytest.mark.parametrize("corner", CORNERS, ids=str)
def test_from_a_switch_or_a_corner(corner: tuple[int | None, ...]) -> None:
    made = plant(**SHORT)
    for name, place in zip(AXES, corner, strict=True):
        if place is not None:
            put(made, name, place)
    assert made.controller.state().switch_closed
    reference(made)
    assert_zero(made, (400, 400, SHORT_STEPS - 400))
    assert look(made).lost_steps == (0, 0, 0)


@pytest.mark.parametrize("place", [-OVERRUN_STEPS, SHORT_STEPS + OVERRUN_STEPS])
@pytest.mark.parametrize("axis", AXES)
def test_from_the_mechanical_end(axis: str, place: int) -> None:
    """The tries push against it: the rotor slips, the mill says so, and zero is right."""
    made = plant(**SHORT)
    put(made, axis, place)
    reference(made)
    assert_zero(made, (400, 400, SHORT_STEPS - 400))
    assert look(made).lost_steps[AXES.index(axis)] != 0


def test_resolved_with_the_switch_in_sight_and_the_first_guess_undone() -> None:
    """The wrong candidates come first; what they moved is taken back."""
    made = plant()
    put(made, "x", TRAVEL_STEPS[0])
    at = carriages(made)
    positions: set[tuple[int, ...]] = set()
    made.controller.set_show_pos(lambda: positions.add(made.controller.state().position_steps))
    reference(made)
    assert carriages(made) == ZERO_STEPS
    assert (0, 0, 0) in positions
    assert at[0] == TRAVEL_STEPS[0]


def test_what_did_not_help_is_undone_before_the_next_is_tried() -> None:
    """Three axes in the middle, and a hand on the last switch that is tried."""
    made = plant()
    mill(made).press(end("ymax"))
    for _ in range(made.config.switches.readings):
        made.controller.idle()
    start = carriages(made)
    tried: set[int] = set()

    def look_closely() -> None:
        moved = [n for n, (a, b) in enumerate(zip(carriages(made), start, strict=True)) if a != b]
        tried.update(moved)
        assert len(moved) <= 1
        if moved == [1] and carriages(made)[1] < start[1]:
            mill(made).let_go(end("ymax"))
            made.controller.cancel()

    made.controller.set_show_pos(look_closely)
    made.controller.home()
    assert made.controller.run() is Status.CANCEL
    assert tried == {0, 1, 2}


# --- bad switches --------------------------------------------------------------------------------


@pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])
@pytest.mark.parametrize("readings", [1, 3, 20])
@pytest.mark.parametrize("lag_ms", [0, 5, 60])
def test_lag_and_bounce_do_not_spoil_repeatability(
    card: dict[str, Any], readings: int, lag_ms: float
) -> None:
    zeros = set()
    bounce = min(readings - 1, 6)
    for start in (1000, 2345, 3501):
        sections = {
            "switches": {"readings": readings},
            "simulation": {"lag_ms": lag_ms, "bounce_readings": bounce},
        }
        made = plant(**merged(card, SHORT, sections))
        for name in AXES:
            put(made, name, start)
        reference(made)
        zeros.add(carriages(made))
        assert look(made).lost_steps == (0, 0, 0)
    assert len(zeros) == 1
    # One step is 5 ms at the slow feed: lag and bounce are that much behind the switch.
    assert 400 - lag_ms / 5 - bounce - 1 <= zeros.pop()[0] <= 400


@pytest.mark.parametrize("pin", [10, 12, 13, 15])
@pytest.mark.parametrize("closed_reads", [0, 1])
def test_other_wirings(pin: int, closed_reads: int) -> None:
    made = plant(**merged(SHORT, {"switches": {"pin": pin, "closed_reads": closed_reads}}))
    put(made, "y", SHORT_STEPS)
    reference(made)
    assert_zero(made, (400, 400, SHORT_STEPS - 400))


def failed(made: Plant, *names: str) -> str:
    made.controller.home(names)
    assert made.controller.run() is Status.ERROR
    assert isinstance(made.controller.error, HomingError)
    return made.controller.state().message


def test_an_end_that_is_not_found_is_an_error_within_the_configured_way() -> None:
    made = plant(**SHORT)
    port = mill(made)
    port.read_status = lambda: 0xF8  # type: ignore[method-assign]
    before_ns = made.clock.now_ns()
    message = failed(made)
    assert "zmax was not found within 22 mm" in message
    assert "axes.z.travel_mm" in message
    assert made.controller.state().referenced == (False, False, False)
    assert (made.clock.now_ns() - before_ns) / 1e9 < 5
    assert made.controller.state().position_mm[2] == 22


def test_a_blocked_carriage_does_not_find_its_end_and_the_mill_says_what_was_lost() -> None:
    made = plant(**SHORT)
    mill(made).mill.block(0)
    message = failed(made)
    assert "xmin was not found" in message
    assert made.controller.state().referenced == (False, False, True)
    sight = look(made)
    assert sight.carriages_steps[0] == SHORT_STEPS / 2
    assert sight.lost_steps[0] == pytest.approx(-22 * 200, abs=8)


def test_a_switch_pressed_for_good_names_wire_and_pin() -> None:
    made = plant(**merged(SHORT, {"switches": {"pin": 13}}))
    mill(made).press(end("ymin"))
    message = failed(made)
    assert "does not open" in message
    assert "DB25 pin 13" in message
    # All candidates were tried and undone.
    assert carriages(made) == (SHORT_STEPS / 2,) * 3
    assert look(made).lost_steps == (0, 0, 0)


def test_a_switch_that_sticks_after_contact_names_its_end() -> None:
    made = plant(**SHORT)
    port = mill(made)
    read = port.read_status
    stuck: list[bool] = []

    def read_status() -> int:
        status = read()
        if not status & 0x80:
            stuck.append(True)
        return status & ~0x80 if stuck else status

    port.read_status = read_status  # type: ignore[method-assign]
    message = failed(made)
    assert "zmax does not open again within 5 mm" in message
    assert "DB25 pin 11" in message
    assert made.controller.state().referenced == (False, False, False)


def test_a_switch_that_closes_once_only() -> None:
    made = plant(**SHORT)
    port = mill(made)
    read = port.read_status
    contacts: list[bool] = [False]

    def read_status() -> int:
        status = read()
        closed = not status & 0x80
        if closed != contacts[-1]:
            contacts.append(closed)
        return status | 0x80 if len(contacts) > 3 else status

    port.read_status = read_status  # type: ignore[method-assign]
    assert "closed once, but not again within 10 mm" in failed(made)


def test_a_pull_off_shorter_than_the_switch_needs() -> None:
    made = plant(**merged(SHORT, {"homing": {"pull_off_mm": 0.05}, "simulation": {"lag_ms": 300}}))
    assert "homing.pull_off_mm longer" in failed(made)


# --- broken off ----------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [1, 2, 5, 9, 14, 22, 30, 41, 60])
def test_cancel_at_any_slice(number: int) -> None:
    made = plant(**SHORT)
    before = carriages(made)
    after_slices(made.controller, number, made.controller.cancel)
    made.controller.home()
    status = made.controller.run()
    state = made.controller.state()
    assert status in (Status.CANCEL, Status.OK)
    if status is Status.CANCEL:
        assert not all(state.referenced)
    assert look(made).lost_steps == (0, 0, 0)
    for motor, referenced in enumerate(state.referenced):
        if not referenced:
            assert carriages(made)[motor] - before[motor] == state.position_steps[motor]
    made.controller.acknowledge()
    made.controller.set_break_key(lambda: None)
    reference(made)
    assert_zero(made, (400, 400, SHORT_STEPS - 400))


def test_a_second_run_loses_the_reference_until_it_is_found_again() -> None:
    made = plant(**SHORT)
    reference(made)
    seen: list[bool] = []
    made.controller.set_show_pos(lambda: seen.append(made.controller.state().referenced[2]))
    reference(made)
    assert seen[2] is False
    assert seen[-1] is True


def test_hold_and_resume_within_a_reference_run() -> None:
    made = plant(**SHORT)
    slices: list[int] = []

    def break_key() -> None:
        slices.append(1)
        if len(slices) % 12 == 5:
            made.controller.hold()
        if len(slices) % 12 == 11:
            made.controller.resume()

    made.controller.set_break_key(break_key)
    reference(made)
    assert_zero(made, (400, 400, SHORT_STEPS - 400))


def test_after_a_failure_it_must_be_acknowledged() -> None:
    made = plant(**SHORT)
    mill(made).press(end("xmin"))
    failed(made)
    with pytest.raises(StateError, match="Acknowledge"):
        made.controller.home()
    mill(made).let_go(end("xmin"))
    made.controller.acknowledge()
    reference(made)
