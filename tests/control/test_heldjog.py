"""A held jog runs while it is held, and not a moment longer than the dead man's time."""

from fraese.assembly import Plant
from fraese.control.heldjog import DEAD_MAN_S, Hold
from fraese.control.jogging import Jogs
from fraese.control.state import Status
from tests.helpers import homed, look, plant

#: The longest round of the run loop; 10 mm/s.
ROUND_MM = 1.1


class Holding:
    """Jogs of a machine, and what was said."""

    def __init__(self, made: Plant) -> None:
        self.made = made
        self.told: list[str] = []
        self.refused: list[str] = []
        self.jogs = Jogs(made.controller, self.told.append, self.refused.append)

    def seconds(self) -> float:
        return self.made.clock.now_ns() / 1e9

    def hold(self, axis: str, sign: int, hold: Hold | None = None) -> Hold:
        hold = hold or Hold(lambda: 0.0)
        assert not self.jogs.hold(axis, sign, hold), "there is no job yet"
        self.jogs.start()
        return hold

    def at_mm(self, axis: int = 0) -> float:
        return self.made.controller.state().position_mm[axis]


def test_it_brakes_when_it_is_let_go() -> None:
    made = homed()
    hand = Holding(made)
    begun_s = hand.seconds()
    hold = hand.hold("x", 1)
    made.controller.set_break_key(lambda: hold.let_go() if hand.seconds() - begun_s >= 1 else None)
    assert made.controller.run() is Status.OK, made.controller.state().message
    assert 9 < hand.at_mm() < 10 + 2 * ROUND_MM
    assert look(made).lost_steps == (0, 0, 0)
    assert made.controller.state().referenced == (True,) * 3
    assert hand.told == hand.refused == []


def test_it_brakes_when_nobody_says_that_he_holds_it() -> None:
    made = homed()
    hand = Holding(made)
    begun_s = hand.seconds()
    hold = hand.hold("x", 1, Hold(hand.seconds))
    made.controller.set_break_key(lambda: hold.hold() if hand.seconds() - begun_s < 1 else None)
    assert made.controller.run() is Status.OK
    whole_mm = 10 * (1 + DEAD_MAN_S)
    assert 10 < hand.at_mm() < whole_mm + 2 * ROUND_MM


def test_it_ends_at_the_limit_and_does_not_set_out_there() -> None:
    made = homed()
    hand = Holding(made)
    hand.hold("x", 1)
    assert made.controller.run() is Status.OK
    assert hand.at_mm() == 296
    assert hand.told == ["X has stopped at its soft limit."]
    hand.hold("x", 1)
    assert made.controller.status is Status.OK
    assert hand.refused == ["X stands at its soft limit."]


def test_without_a_reference_it_is_no_longer_than_a_jog() -> None:
    made = plant()
    hand = Holding(made)
    hand.hold("y", -1)
    assert made.controller.run() is Status.OK
    assert hand.at_mm(1) == -made.controller.config.jog.max_mm
    assert "not referenced" in hand.told[0]


def test_what_was_let_go_before_it_began_moves_nothing() -> None:
    made = homed()
    hold = Hold(lambda: 0.0)
    hold.let_go()
    Holding(made).hold("x", 1, hold)
    assert made.controller.status is Status.OK


def test_it_begins_behind_the_width_in_hand_and_in_place_of_those_that_wait() -> None:
    made = homed()
    hand, hold = Holding(made), Hold(lambda: 0.0)
    for _ in range(3):
        hand.jogs.press("x", mm=2.0)
    hand.jogs.press("y", mm=1.0)
    hand.jogs.start()
    rounds = 0

    def at_the_keys() -> None:
        nonlocal rounds
        rounds += 1
        if rounds == 2:
            assert hand.jogs.hold("x", 1, hold)
        if hand.at_mm() > 20:
            hold.let_go()

    made.controller.set_break_key(at_the_keys)
    assert made.controller.run() is Status.OK
    assert 20 < hand.at_mm() < 20 + 2 * ROUND_MM
    assert hand.at_mm(1) == 1
    assert hand.told == hand.refused == []


def test_another_press_ends_it_and_is_done() -> None:
    made = homed()
    hand = Holding(made)
    hold = hand.hold("x", 1)
    pressed_at: list[float] = []

    def at_the_keys() -> None:
        if not pressed_at and hand.at_mm() > 5:
            pressed_at.append(hand.at_mm())
            hand.jogs.press("x", mm=-1.0)

    made.controller.set_break_key(at_the_keys)
    assert made.controller.run() is Status.OK
    assert not hold.is_held
    assert pressed_at[0] - 1 < hand.at_mm() < pressed_at[0] + 2 * ROUND_MM - 1


def test_what_is_over_stays_over_and_late_words_are_as_old_as_they_are() -> None:
    now_s = 10.0
    hold = Hold(lambda: now_s, 0.2)
    now_s = 10.15
    hold.hold(10.05)
    now_s = 10.24
    assert hold.is_held
    now_s = 10.26
    hold.hold()
    assert not hold.is_held
    assert not Hold(lambda: now_s, 0.2, since_s=10.0).is_held
