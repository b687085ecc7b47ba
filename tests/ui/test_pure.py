"""The parts of the UI that need no screen."""

from dataclasses import replace

import pytest
from textual.events import Key

from fraese.alarms import END_SWITCH
from fraese.control.state import MachineState, Status, three_decimals
from fraese.control.switchtest import SwitchTest
from fraese.ui.feed import StateFeed
from fraese.ui.fingers import Fingers
from fraese.ui.heldkeys import HeldKeys
from fraese.ui.keyrows import GROUPS, KeyTable
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.statebar import Seen, seen
from fraese.ui.widgets.status import clock_words, lost_words, switch_words
from fraese.ui.widths import RepeatRule, widths

AXES = ("x", "y", "z")
MILL = Shape(tuple(AxisShape(name, "mm", 0.005) for name in AXES), "half-step")


def state(**facts: object) -> MachineState:
    nil = (0.0, 0.0, 0.0)
    given: dict[str, object] = {
        "status": Status.OK,
        "message": "",
        "axes": AXES,
        "position_steps": (0, 0, 0),
        "position_mm": nil,
        "work_mm": nil,
        "offset_mm": nil,
        "referenced": (False,) * 3,
        "low_mm": nil,
        "high_mm": nil,
    }
    given.update(facts)
    return MachineState(**given)  # type: ignore[arg-type]


def test_repeat_rule_counts_single_to_20_then_tenfold() -> None:
    rule = RepeatRule()
    factors = []
    for _ in range(25):
        factors.append(rule.press("right"))
    assert factors == [1] * 20 + [10] * 5


@pytest.mark.parametrize("other", ["left", "w", "escape", "g"])
def test_only_another_key_resets_the_repeat_rule(other: str) -> None:
    rule = RepeatRule()
    for _ in range(30):
        rule.press("right")
    rule.press(other)
    assert rule.press("right") == 1


def test_every_command_has_its_own_keys_and_a_group() -> None:
    commands = KeyTable(MILL).commands
    keys = [(row.area, key) for row in commands for key in row.keys.split(",")]
    assert len(keys) == len(set(keys))
    assert {command.group for command in commands} | {"Macros"} == set(GROUPS)
    assert all(command.help.endswith(".") for command in commands)


def test_widths_reach_from_a_half_step_to_10_mm() -> None:
    assert [width.mm for width in widths(MILL)] == [None, 0.01, 0.1, 1.0, 10.0]


def test_feed_keeps_the_latest_and_posts_once() -> None:
    posts: list[int] = []
    feed = StateFeed(lambda: posts.append(1))
    for steps in range(5):
        feed.offer(state(position_steps=(steps, 0, 0)))
    assert len(posts) == 1
    taken = feed.take()
    assert taken is not None
    assert taken.position_steps == (4, 0, 0)
    feed.offer(taken)
    assert len(posts) == 1
    feed.offer(state())
    assert len(posts) == 2


def test_a_pause_resets_the_repeat_rule() -> None:
    rule = RepeatRule()
    for n in range(25):
        factor = rule.press("right", n * 0.12)
    assert factor == 10
    assert rule.press("right", 25 * 0.12 + 1) == 1


class Silent:
    """A timer that never rings."""

    def stop(self) -> None:
        pass


def test_a_press_counts_what_it_counted_when_it_was_made() -> None:
    """Also if it is done late, with others behind it already."""
    rule, held = RepeatRule(), HeldKeys()
    fingers = Fingers(rule, held, lambda *_: Silent(), *(lambda: None,) * 3)  # type: ignore[arg-type]
    keys = [Key("right", None) for _ in range(25)] + [Key("left", None)]
    for key in keys:
        fingers.press(key)
    counted = []
    for key in keys:
        fingers.does(key)
        counted.append(rule.factor)
    assert counted == [1] * 20 + [10] * 5 + [1]
    rule.forget()
    assert rule.factor == 1


def test_words() -> None:
    assert three_decimals(-0.0001) == "0.000"
    assert clock_words(59.9) == "0:59"
    assert clock_words(3725) == "1:02:05"
    assert switch_words(state()) == "switch open"
    assert switch_words(state(switch_closed=True, ends=("xmax",))) == "switch xmax"
    both = state(switch_closed=True, ends=("xmax", "ymin"))
    assert switch_words(both) == "switch xmax or ymin?"
    run = {"status": Status.RUN}
    known = {"referenced": (True,) * 3}
    assert seen(state(**run), False) == Seen("MOVING", "-run", "NOT REFERENCED X Y Z: no limits")
    assert seen(state(**run, **known), False) == Seen("MOVING", "-run")
    assert seen(state(held=True, **run), False).word == "HOLD"
    assert seen(state(question="Change the tool.", **run), False).word == "WAIT"
    assert seen(state(held=True, **run), True).word == "STOPPING"
    assert seen(state(held=True), True) == Seen("NOT REFERENCED", "-warn", "X Y Z: no limits")
    assert seen(state(**known), False) == Seen("READY", "-good")


def test_a_closed_switch_is_loud_whatever_the_machine_does() -> None:
    """Nobody is told that all is well while a contact is closed."""
    closed = state(switch_closed=True, ends=("xmax",), referenced=(True,) * 3)
    assert seen(closed, False) == Seen("SWITCH CLOSED", "-alarm", "xmax")
    moving = replace(closed, status=Status.RUN)
    assert seen(moving, False) == Seen("MOVING", "-run", "SWITCH CLOSED xmax")
    two = replace(closed, ends=("xmax", "ymin"))
    assert seen(two, False).beside == "xmax or ymin?"
    alarm = replace(closed, status=Status.ERROR, alarm=END_SWITCH)
    assert seen(alarm, False) == Seen("ALARM xmax", "-alarm", "alarm 10")
    assert seen(state(status=Status.ERROR), False).word == "ERROR"


def test_lost_steps_in_words() -> None:
    assert lost_words(state()) == ""
    none = state(lost_steps=(0.0, 0.0, 0.0), lost_why=("", "", ""))
    assert lost_words(none) == ""
    some = state(lost_steps=(1984.0, 0.0, -3.5), lost_why=("too fast", "", "blocked"))
    assert lost_words(some) == "LOST STEPS  X 1984 steps (too fast), Z 3.5 steps (blocked)"


def test_switch_test_ticks_off_in_order() -> None:
    test = SwitchTest(("x", "z"))
    assert test.names == ("xmin", "xmax", "zmin", "zmax")
    seen = []
    for _ in test.names:
        assert test.look(False) == ""
        seen.append(test.look(True))
        assert test.look(True) == ""
        assert "Let go" in test.sentence()
    test.look(False)
    assert seen == ["xmin", "xmax", "zmin", "zmax"]
    assert test.done
    assert "All 4" in test.sentence()


def test_switch_test_says_when_the_input_is_closed_from_the_start() -> None:
    test = SwitchTest(("x",))
    assert test.look(True) == ""
    assert test.stuck
    assert "stuck" in test.sentence()
    test.look(False)
    assert test.look(True) == "xmin"
    assert not test.stuck


def test_switch_test_asks_for_a_chosen_one() -> None:
    test = SwitchTest(("x", "y"))
    test.ask("ymax")
    test.look(False)
    assert test.look(True) == "ymax"
    test.look(False)
    assert test.asked == "xmin"
    test.step(-1)
    assert test.asked == "ymax"
    with pytest.raises(ValueError, match="not in tuple"):
        test.ask("amin")
