"""A held key, from the terminal's strokes to the carriage, in the machine's own time.

Whatever is pressed, held, let go and lost at whatever times: the carriage comes to rest within a
width of where it was when the key came up, or within the way that the silence and the brake take.
"""

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.heldjog import Hold
from fraese.control.jogging import Jogs
from fraese.control.state import Status
from fraese.ui.heldkeys import HeldKeys, Manners, Stroke
from tests.helpers import carriages, homed, look

DELAY_S, INTERVAL_S, JITTER_S = 0.5, 1 / 30, 0.008
MEASURED = Manners(DELAY_S, INTERVAL_S, JITTER_S)
SPEED_MM_S = 10.0
STEPS_PER_MM = 200
#: The longest round of the run loop on a virtual clock, twice: it looks, and it brakes.
ROUND_S = 0.2
BRAKING_MM = 1.0


@dataclass
class Hand:
    """A finger on one key after the other; the terminal and the line between it and the machine.

    Attributes:
        told: releases are told.
        manners: what is known of the terminal.
        width_mm: of one press.
    """

    told: bool
    manners: Manners
    width_mm: float

    def __post_init__(self) -> None:
        self.plant: Plant = homed()
        self.controller = self.plant.controller
        self.controller.move_to({"x": 150.0, "y": 100.0}, machine_coordinates=True)
        assert self.controller.run() is Status.OK
        self.said: list[str] = []
        self.jogs = Jogs(self.controller, self.said.append, self.said.append)
        self.keys = HeldKeys()
        self.keys.tells, self.keys.manners = self.told, self.manners
        self.hold: Hold | None = None
        self.delivering = False
        self.events: list[tuple[float, Callable[[], object]]] = []
        self.end_s = self.now_s() + 0.1

    def now_s(self) -> float:
        return self.plant.clock.now_ns() / 1e9

    def at_mm(self, axis: int = 0) -> float:
        return carriages(self.plant)[axis] / STEPS_PER_MM

    # --- what is done ------------------------------------------------------------------------

    def at(self, when_s: float, what: Callable[[], object]) -> None:
        self.events.append((when_s, what))

    def holds(self, key: str, for_s: float, late_s: float = 0.0) -> float:
        """A key is down for so long, from now on; when it comes up."""
        begun_s = self.end_s
        self.at(begun_s, lambda: self.stroke(key))
        for n in range(int(max(0.0, for_s - DELAY_S) / INTERVAL_S)):
            at_s = begun_s + DELAY_S + n * INTERVAL_S + JITTER_S / 2 * (-1) ** n
            # What was held up somewhere arrives together.
            at_s = max(at_s, late_s and begun_s + late_s)
            self.at(at_s, lambda: self.stroke(key))
        self.end_s = begun_s + for_s
        if self.told:
            self.at(max(self.end_s, late_s and begun_s + late_s), lambda: self.up(key))
        return self.end_s

    def stroke(self, key: str) -> None:
        held = self.keys.holds
        stroke = self.keys.press(key, self.due_s)
        if held and held != self.keys.holds:
            self.let_go()
        axis, sign = key[0], 1 if key[1] == "+" else -1
        if stroke is Stroke.TAP:
            self.jogs.press(axis, mm=sign * self.width_mm)
        elif stroke is Stroke.HOLD:
            self.hold = Hold(self.seen_s, self.manners.silence_s, self.due_s)
            self.jogs.hold(axis, sign, self.hold)
        elif self.hold is not None:
            self.hold.hold(self.due_s)

    def up(self, key: str) -> None:
        if self.keys.up(key):
            self.let_go()

    def let_go(self) -> None:
        self.jogs.let_go()

    def lose_focus(self) -> None:
        if self.keys.holds:
            self.let_go()
        self.keys.all_up()

    # --- what becomes of it ------------------------------------------------------------------

    def run(self) -> None:
        """Until all has been done, and the machine stands."""
        self.events.sort(key=lambda event: event[0])
        self.controller.set_break_key(self.deliver)
        while self.events or self.jogs.waiting or self.hold is not None:
            self.jogs.start()
            if self.controller.status is Status.RUN:
                status = self.controller.run()
                assert status is Status.OK, self.controller.state().message
            elif self.events:
                wait_ns = round((self.events[0][0] - self.now_s()) * 1e9)
                self.plant.clock.pass_by(max(0, wait_ns) + 1)
                self.deliver()
            else:
                return

    def seen_s(self) -> float:
        """The time, for who holds: what happens at the keys happens in a thread of its own."""
        if self.delivering:
            return self.due_s
        self.deliver()
        return self.now_s()

    def deliver(self) -> None:
        while self.events and self.events[0][0] <= self.now_s():
            self.due_s, what = self.events.pop(0)
            self.delivering = True
            what()
            self.delivering = False

    def is_sound(self) -> None:
        """Counters and carriages agree, and nothing was lost."""
        seen = look(self.plant)
        assert seen.lost_steps == (0, 0, 0)
        zero = (400, 400, 11_600)
        where = self.controller.position.position_steps
        assert tuple(a - z for a, z in zip(seen.carriages_steps, zero, strict=True)) == where


def noted(hand: Hand, when_s: float) -> list[float]:
    """Where X will be at that time."""
    seen: list[float] = []
    hand.at(when_s, lambda: seen.append(hand.at_mm()))
    return seen


KINDS = {
    "told": (True, MEASURED),
    "told, not measured": (True, Manners()),
    "measured": (False, MEASURED),
    "guessed": (False, Manners()),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("width_mm", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("for_s", [0.05, 0.45, 0.56, 0.9, 2.0, 4.0])
def test_a_held_key_ends_soon_after_its_release(kind: str, width_mm: float, for_s: float) -> None:
    told, manners = KINDS[kind]
    hand = Hand(told, manners, width_mm)
    begun_mm = hand.at_mm()
    at_release = noted(hand, hand.holds("x+", for_s))
    hand.run()
    hand.is_sound()
    silence_mm = 0.0 if told else SPEED_MM_S * manners.silence_s
    brake_mm = silence_mm + SPEED_MM_S * ROUND_S + BRAKING_MM
    # Unmeasured, the first repeat is taken for a second tap.
    taps = 2 if kind == "guessed" and for_s > DELAY_S else 1
    assert hand.at_mm() - at_release[0] <= max(taps * width_mm, brake_mm) + 1e-6
    if for_s < DELAY_S:
        assert hand.at_mm() - begun_mm == pytest.approx(width_mm)
    if for_s >= 2:
        assert hand.at_mm() - begun_mm > SPEED_MM_S * (for_s - DELAY_S - 0.25) - 1


@pytest.mark.parametrize("kind", KINDS)
def test_a_stalled_line_never_runs_on(kind: str) -> None:
    """Held for two seconds, and heard all at once five seconds later."""
    told, manners = KINDS[kind]
    hand = Hand(told, manners, 10.0)
    begun_mm = hand.at_mm()
    hand.holds("x+", 2.0, late_s=5.0)
    hand.run()
    hand.is_sound()
    assert hand.at_mm() - begun_mm <= 20 + SPEED_MM_S * (manners.silence_s + ROUND_S) + BRAKING_MM


DOINGS = st.lists(
    st.tuples(
        st.sampled_from(("x+", "x-", "y+", "rest", "focus")),
        st.floats(0.02, 1.6),
        st.sampled_from((0.0, 0.0, 0.0, 1.0)),
    ),
    min_size=1,
    max_size=8,
)


@settings(deadline=None, max_examples=20)
@given(DOINGS, st.sampled_from(sorted(KINDS)), st.sampled_from((0.1, 1.0, 10.0)))
def test_whatever_is_done_the_carriage_ends_near_its_last_release(
    doings: list[tuple[str, float, float]], kind: str, width_mm: float
) -> None:
    told, manners = KINDS[kind]
    hand = Hand(told, manners, width_mm)
    presses = 0
    for what, for_s, late_s in doings:
        if what == "rest":
            hand.end_s += for_s
        elif what == "focus":
            hand.at(hand.end_s, hand.lose_focus)
        else:
            hand.holds(what, for_s, late_s)
            presses += 1
        hand.end_s += 0.02
    at_release = noted(hand, hand.end_s)
    hand.run()
    hand.is_sound()
    silence_mm = SPEED_MM_S * (manners.silence_s + ROUND_S) + BRAKING_MM
    # Taps that were not made yet at the last release, of which a held key has two at most.
    ahead_mm = max(2 * presses * width_mm, silence_mm) + silence_mm
    late_mm = SPEED_MM_S * max(late for _, _, late in doings)
    assert abs(hand.at_mm() - at_release[0]) <= ahead_mm + late_mm
    assert not hand.jogs.waiting
