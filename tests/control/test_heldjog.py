"""A held jog runs while it is held, and not a moment longer than the dead man's time."""

import pytest

from fraese.assembly import Plant
from fraese.control.heldjog import DEAD_MAN_S, HeldJog
from fraese.control.state import Status
from fraese.errors import LimitError
from tests.helpers import homed, mill, plant

#: The longest round of the run loop; 10 mm/s.
ROUND_MM = 1.1


def seconds(made: Plant) -> float:
    return made.clock.now_ns() / 1e9


def test_it_brakes_when_it_is_let_go() -> None:
    made = homed()
    held = HeldJog(lambda: 0.0)
    begun_s = seconds(made)
    held.start(made.controller, "x", 1)
    made.controller.set_break_key(lambda: held.let_go() if seconds(made) - begun_s >= 1 else None)
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert 9 < made.controller.state().position_mm[0] < 10 + 2 * ROUND_MM
    assert mill(made).look().lost_steps == (0, 0, 0)
    assert made.controller.state().referenced == (True,) * 3


def test_it_brakes_when_nobody_says_that_he_holds_it() -> None:
    made = homed()
    begun_s = seconds(made)
    held = HeldJog(lambda: seconds(made))
    held.start(made.controller, "x", 1)
    made.controller.set_break_key(lambda: held.hold() if seconds(made) - begun_s < 1 else None)
    assert made.controller.run() is Status.OK
    at_mm, whole_mm = made.controller.state().position_mm[0], 10 * (1 + DEAD_MAN_S)
    assert 10 < at_mm < whole_mm + 2 * ROUND_MM


def test_it_ends_at_the_limit_and_does_not_set_out_there() -> None:
    made = homed()
    held = HeldJog(lambda: 0.0)
    held.start(made.controller, "x", 1)
    assert made.controller.run() is Status.OK
    assert made.controller.state().position_mm[0] == 296
    with pytest.raises(LimitError):
        HeldJog(lambda: 0.0).start(made.controller, "x", 1)


def test_without_a_reference_it_is_no_longer_than_a_jog() -> None:
    controller = plant().controller
    HeldJog(lambda: 0.0).start(controller, "y", -1)
    assert controller.run() is Status.OK
    assert controller.state().position_mm[1] == -controller.config.jog.max_mm


def test_what_was_let_go_before_it_began_moves_nothing() -> None:
    made = homed()
    held = HeldJog(lambda: 0.0)
    held.let_go()
    held.start(made.controller, "x", 1)
    assert made.controller.status is Status.OK
