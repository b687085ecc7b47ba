"""The feed override acts on what is moved by hand, soon, and says where it does not."""

from collections.abc import Callable

import pytest

from fraese.assembly import Plant
from fraese.control.heldjog import Hold
from fraese.control.jogging import Jogs
from fraese.control.state import MachineState, Status
from tests.helpers import homed, look, plant

#: It is felt within this time, a round of the run loop included.
SOON_S = 0.3


def speeds(
    made: Plant, turned: Callable[[MachineState, float], float | None]
) -> list[tuple[float, MachineState]]:
    """Run what was begun; what is seen in each round. ``turned``: what the override is to be."""
    seen: list[tuple[float, MachineState]] = []
    begun_s = made.clock.now_ns() / 1e9

    def look_at_it() -> None:
        state, at_s = made.controller.state(), made.clock.now_ns() / 1e9 - begun_s
        seen.append((at_s, state))
        wanted = turned(state, at_s)
        if wanted is not None:
            made.controller.handling.set_feed(wanted)

    made.controller.set_break_key(look_at_it)
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert look(made).lost_steps == (0, 0, 0)
    return seen


def at(seen: list[tuple[float, MachineState]], when_s: float) -> float:
    return next(state.speed_mm_min for at_s, state in seen if at_s >= when_s)


def jog(made: Plant) -> None:
    made.controller.jog("x", 50.0)


def held(made: Plant) -> None:
    jogs = Jogs(made.controller, print, print)
    jogs.hold("x", 1, Hold(lambda: 0.0))
    jogs.start()


def move(made: Plant) -> None:
    made.controller.move_to({"x": 60.0}, feed_mm_min=600)


@pytest.mark.parametrize("begin", [jog, held, move])
@pytest.mark.parametrize("factor", [0.1, 0.5, 1.5, 2.0])
def test_it_is_felt_soon(begin: Callable[[Plant], None], factor: float) -> None:
    made = homed()
    begin(made)
    seen = speeds(made, lambda state, at_s: factor if at_s >= 1.0 else None)
    assert at(seen, 0.9) == pytest.approx(600, rel=0.01)
    first_s = next(at_s for at_s, _ in seen if at_s >= 1.0)
    assert at(seen, first_s + SOON_S) == pytest.approx(600 * factor, rel=0.02)


@pytest.mark.parametrize("begin", [jog, held, move])
def test_what_was_lowered_before_holds_from_the_first_step(begin: Callable[[Plant], None]) -> None:
    made = homed()
    made.controller.handling.set_feed(0.3)
    begin(made)
    seen = speeds(made, lambda state, at_s: None)
    assert max(state.speed_mm_min for _, state in seen) <= 600 * 0.3 * 1.02
    assert made.controller.handling.feed == 0.3


def test_as_fast_as_the_axes_can_obeys_too_and_is_not_raised() -> None:
    made = homed()
    made.controller.move_to({"x": 100.0})
    seen = speeds(made, lambda state, at_s: 0.5 if at_s >= 1.0 else None)
    fast = at(seen, 0.9)
    first_s = next(at_s for at_s, _ in seen if at_s >= 1.0)
    assert at(seen, first_s + SOON_S) == pytest.approx(fast / 2, rel=0.02)
    made.controller.handling.set_feed(2.0)
    made.controller.move_to({"x": 0.0})
    seen = speeds(made, lambda state, at_s: None)
    assert max(state.speed_mm_min for _, state in seen) <= fast * 1.01


def test_the_next_job_is_as_wanted_then() -> None:
    made = homed()
    made.controller.handling.set_feed(0.5)
    jog(made)
    speeds(made, lambda state, at_s: None)
    made.controller.handling.set_feed(1.0)
    jog(made)
    seen = speeds(made, lambda state, at_s: None)
    assert max(state.speed_mm_min for _, state in seen) == pytest.approx(600, rel=0.01)


def test_a_reference_run_is_slowed_but_not_where_it_measures() -> None:
    made, usual = plant(), plant()
    for each in (made, usual):
        each.controller.home(("x",))
    made.controller.handling.set_feed(0.8)
    slowed = speeds(made, lambda state, at_s: None)
    as_configured = speeds(usual, lambda state, at_s: None)
    homing = made.config.homing
    top = max(state.speed_mm_min for _, state in slowed)
    assert top == pytest.approx(homing.approach_mm_min * 0.8, rel=0.02)
    measured = [state for _, state in slowed if state.running and not state.obeys_override]
    assert measured
    assert max(state.speed_mm_min for state in measured) <= homing.slow_mm_min * 1.01
    assert max(state.speed_mm_min for _, state in as_configured) == pytest.approx(
        homing.approach_mm_min, rel=0.01
    )
    assert made.controller.position.position_steps == usual.controller.position.position_steps


def test_a_reference_run_is_not_hurried() -> None:
    made = plant()
    made.controller.home(("x",))
    made.controller.handling.set_feed(2.0)
    seen = speeds(made, lambda state, at_s: None)
    top = max(state.speed_mm_min for _, state in seen)
    assert top == pytest.approx(made.config.homing.approach_mm_min, rel=0.01)


def test_bands_to_avoid_are_avoided_at_100_per_cent() -> None:
    made = homed(axes={"x": {"avoid_hz": [[1900, 2100]]}})
    made.controller.jog("x", 50.0)
    seen = speeds(made, lambda state, at_s: None)
    assert max(state.speed_mm_min for _, state in seen) <= 1900 / 200 * 60 * 1.01
