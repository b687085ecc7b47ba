"""Presses of jog keys on top of running jogs: the carriages do what was pressed."""

import re
from collections.abc import Callable, Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.jogging import Jogs
from fraese.control.presses import Group, Press, Waiting
from fraese.control.state import Status
from fraese.errors import StateError
from tests.helpers import axes, carriages, homed, look, plant, put

WIDTH_MM, WIDTH_STEPS = 4.0, 800


class Hand:
    """Somebody at the keys of a machine."""

    def __init__(self, made: Plant | None = None) -> None:
        self.plant = made or plant()
        self.controller = self.plant.controller
        self.told: list[str] = []
        self.refused: list[str] = []
        self.jogs = Jogs(self.controller, self.told.append, self.refused.append)
        self._start = carriages(self.plant)

    def press(self, axis: str, sign: int, mm: float = 1.0, *, held: bool = False) -> None:
        self.jogs.press(axis, mm=sign * mm, held=held)

    def presses(self, keys: str, mm: float = 1.0) -> None:
        """Several at once, "x+ y-"."""
        for key in keys.split():
            self.press(key[0], 1 if key[1] == "+" else -1, mm)

    def run(self, *plan: tuple[int, Callable[[], object]]) -> Status:
        """Work off what waits; at these slices of the run loop something is done."""
        slices = 0
        pending = list(plan)

        def due(at: int) -> None:
            while pending and pending[0][0] <= at:
                pending.pop(0)[1]()

        def break_key() -> None:
            nonlocal slices
            slices += 1
            due(slices)

        self.controller.set_break_key(break_key)
        while True:
            self.jogs.start()
            # What comes at once comes before the first step.
            due(slices + 1)
            status = self.controller.run()
            if status is not Status.OK or not (pending or self.jogs.waiting):
                return status
            # Nothing runs: the next press comes in its own time.
            slices = max(slices, pending[0][0] - 1) if pending else slices
            break_key()

    @property
    def moved(self) -> tuple[float, ...]:
        return tuple(b - a for a, b in zip(self._start, carriages(self.plant), strict=True))


def test_taps_add_up() -> None:
    hand = Hand()
    for _ in range(3):
        hand.press("x", 1, 10)
    assert hand.jogs.waiting == (("x", 3),)
    hand.run((3, lambda: hand.press("x", 1, 10)), (5, lambda: hand.press("x", 1, 10)))
    assert hand.moved == (10_000, 0, 0)
    assert hand.told == hand.refused == []
    assert not hand.jogs.waiting


def test_what_waits_is_shown_while_it_moves() -> None:
    hand, seen = Hand(), []
    hand.press("x", 1)
    hand.run(
        (1, lambda: hand.presses("x+ x+ y-")),
        (2, lambda: seen.append(hand.jogs.waiting)),
    )
    assert seen == [(("x", 2), ("y", -1))]
    assert hand.moved == (600, -200, 0)


def test_turned_before_it_has_set_out_it_stays() -> None:
    """Also then the press in hand counts as made."""
    hand = Hand()
    hand.presses("x+ x+", 10)
    hand.jogs.start()
    hand.press("x", -1, 10)
    hand.controller.run()
    assert hand.moved == (0, 0, 0)
    assert hand.told == ["X+ was turned round: 1 press that had not begun is left out."]


def test_the_opposite_key_brakes_at_once_and_then_goes_the_other_way() -> None:
    hand, at = Hand(), []
    hand.press("x", 1, 10)

    def turn() -> None:
        at.append(hand.moved[0])
        hand.press("x", -1, 10)

    furthest = 0.0

    def watch() -> None:
        nonlocal furthest
        furthest = max(furthest, hand.moved[0])

    hand.press("x", 1, 10)
    hand.run((4, turn), *((n, watch) for n in range(5, 60)))
    axis = hand.controller.machine.axes[0]
    slice_steps = axis.to_steps(1)
    assert 0 < at[0] < furthest < at[0] + slice_steps
    assert hand.moved == (0, 0, 0), "the press in hand counts as made, the other one had not begun"
    assert hand.told == ["X+ was turned round: 1 press that had not begun is left out."]
    assert look(hand.plant).lost_steps == (0, 0, 0)


def test_it_never_goes_on_in_the_old_direction_for_a_finer_press() -> None:
    hand, at = Hand(), []
    hand.press("x", 1, 10)
    hand.run((4, lambda: at.append(hand.moved[0])), (4, lambda: hand.press("x", -1, 1)))
    assert hand.moved[0] < at[0]


def test_pressed_both_ways_while_it_brakes() -> None:
    hand = Hand()
    hand.press("x", 1, 10)
    hand.run((4, lambda: hand.presses("x- x+", 10)))
    assert hand.moved == (2000, 0, 0)
    hand.press("x", 1, 10)
    hand.run((4, lambda: hand.presses("x- x- x+", 10)))
    assert hand.moved == (2000, 0, 0)


def test_another_axis_waits_its_turn() -> None:
    hand, seen = Hand(), []
    hand.press("x", 1)
    hand.run(
        (1, lambda: hand.presses("y+ x-")),
        *((n, lambda: seen.append(hand.moved[:2])) for n in range(2, 60)),
    )
    assert hand.moved == (0, 200, 0)
    assert all(x in (0, 200) or y == 0 for x, y in seen)


def test_a_held_key_ends_within_one_width_of_its_release() -> None:
    hand, at = Hand(), []
    for _ in range(3):
        hand.press("x", 1, 10)
    repeats = [(n, lambda: hand.press("x", 1, 10, held=True)) for n in range(2, 40)]
    hand.run(*repeats, (40, lambda: at.append(hand.moved[0])), (40, hand.jogs.let_go))
    assert at[0] < hand.moved[0] <= at[0] + 2000
    assert hand.moved[0] % 2000 == 0
    assert hand.told == []


def test_nothing_left_of_what_waits_after_a_stop() -> None:
    hand = Hand()
    hand.press("x", 1, 10)
    stop = (lambda: hand.presses("y+"), hand.jogs.forget, hand.controller.cancel)
    assert hand.run(*((4, action) for action in stop)) is Status.CANCEL
    assert 0 < hand.moved[0] < 2000
    assert hand.moved[1] == 0
    hand.controller.acknowledge()
    before = hand.moved[0]
    hand.press("x", 1)
    hand.run()
    assert hand.moved[0] == before + 200


def test_what_is_refused_on_the_way_is_said_and_the_rest_is_done() -> None:
    made = homed()
    made.controller.move_to({"x": 1.5, "y": 20}, machine_coordinates=True)
    made.controller.run()
    hand = Hand(made)
    for _ in range(3):
        hand.press("x", -1)
    hand.press("y", 1)
    hand.run()
    assert hand.moved == (-300, 200, 0)
    assert hand.told == ["X has stopped at its soft limit, 1.500 mm short of what was pressed."]
    hand.press("x", -1)
    hand.press("y", 1)
    hand.run()
    assert hand.refused == ["X stands at its soft limit."]
    assert hand.moved == (-300, 400, 0)


def test_an_error_that_waits_drops_what_was_pressed() -> None:
    hand = Hand()
    put(hand.plant, "x", 300 * 200 - 100)
    hand.press("x", 1)
    assert hand.run() is Status.ERROR
    hand.press("x", -1)
    with pytest.raises(StateError, match="Acknowledge"):
        hand.jogs.start()
    assert hand.jogs.waiting == ()


def test_a_long_row_of_presses_is_cut_into_jogs() -> None:
    hand = Hand(plant(jog={"max_mm": 5}))
    for _ in range(12):
        hand.press("y", 1)
    hand.run()
    assert hand.moved == (0, 2400, 0)


def test_no_rounding_adds_up() -> None:
    hand = Hand(plant(axes=axes(pitch_mm="3", gear="7/5")))
    step_mm = hand.controller.machine.axes[0].step_mm
    for sign in (1, -1):
        for count in range(1, 8):
            hand.press("x", sign, 0.01)
            hand.run()
            so_far = 0.01 * (count if sign > 0 else 7 - count)
            assert abs(hand.moved[0] * step_mm - so_far) <= step_mm / 2 + 1e-9
    assert hand.moved[0] == 0


PRESSES = st.lists(
    st.tuples(st.integers(0, 12), st.sampled_from("xyz"), st.sampled_from((1, -1))), max_size=14
)


def left_out(told: Sequence[str]) -> dict[str, int]:
    """Presses per axis, signed, that were left out, as it was said."""
    gone = dict.fromkeys("xyz", 0)
    for sentence in told:
        found = re.match(r"([XYZ])([+−]) was turned round: (\d+) press", sentence)
        assert found, sentence
        gone[found[1].lower()] += int(found[3]) * (1 if found[2] == "+" else -1)
    return gone


@settings(deadline=None, max_examples=60)
@given(PRESSES)
def test_carriages_agree_with_what_was_pressed(presses: list[tuple[int, str, int]]) -> None:
    hand, at = Hand(), 0
    plan: list[tuple[int, Callable[[], object]]] = []
    for after, axis, sign in presses:
        at += after
        plan.append((at, lambda axis=axis, sign=sign: hand.press(axis, sign, WIDTH_MM)))  # type: ignore[misc]
    assert hand.run(*plan) is Status.OK
    gone = left_out(hand.told)
    for n, axis in enumerate("xyz"):
        pressed = sum(sign for _, name, sign in presses if name == axis)
        assert hand.moved[n] == WIDTH_STEPS * (pressed - gone[axis]), hand.told
    where = hand.controller.position.position_steps
    assert where == hand.moved
    assert look(hand.plant).lost_steps == (0, 0, 0)
    assert hand.jogs.waiting == ()


@given(st.lists(st.sampled_from((1.0, -1.0, 0.1, -0.1)), max_size=20))
def test_a_group_goes_one_way_and_keeps_the_sum(widths: list[float]) -> None:
    axis = plant().controller.machine.axes[0]
    group, waiting = Group(0), Waiting((axis,))
    for mm in widths:
        group.add(Press(0, mm=mm), axis)
        waiting.add(Press(0, mm=mm))
    assert sum(press.mm for press in group.presses) == pytest.approx(sum(widths), abs=1e-6)
    assert len({press.mm > 0 for press in group.presses}) <= 1
    assert [press.mm for press in waiting.of_axis(0)] == [p.mm for p in group.presses]
