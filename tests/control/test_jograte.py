"""How fast jogs go: chosen by a person, within what the axes can, obeyed by taps and by holds."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.control.heldjog import DEAD_MAN_S, Hold
from fraese.control.jogging import Jogs
from fraese.control.state import Status
from fraese.errors import LimitError
from tests.helpers import homed, look, plant

#: The longest round of the run loop, s: it looks, and it brakes.
ROUND_S = 0.2


def jogs_of(made: Plant) -> tuple[Jogs, list[str]]:
    said: list[str] = []
    return Jogs(made.controller, said.append, said.append), said


@pytest.mark.parametrize("feed_mm_min", [60.0, 300.0, 900.0])
def test_a_tap_takes_as_long_as_the_rate_says(feed_mm_min: float) -> None:
    made = homed()
    jogs, said = jogs_of(made)
    jogs.rate.choose(feed_mm_min)
    jogs.press("x", mm=20.0)
    jogs.start()
    begun_ns = made.clock.now_ns()
    assert made.controller.run() is Status.OK
    took_s = (made.clock.now_ns() - begun_ns) / 1e9
    assert took_s == pytest.approx(20 / feed_mm_min * 60, rel=0.1, abs=ROUND_S)
    assert made.controller.state().position_mm[0] == 20
    assert said == []


def test_it_counts_from_the_next_line_on() -> None:
    made = homed()
    jogs, _ = jogs_of(made)
    fastest: list[float] = []

    def at_the_keys() -> None:
        state = made.controller.state()
        if state.position_mm[0] < 9:
            fastest[:] = [max([*fastest, state.speed_mm_min])]
        jogs.rate.choose(60)

    jogs.press("x", mm=10.0)
    jogs.press("y", mm=1.0)
    jogs.start()
    made.controller.set_break_key(at_the_keys)
    begun_ns = made.clock.now_ns()
    assert made.controller.run() is Status.OK
    assert fastest[0] == pytest.approx(600, rel=0.02), "what was being made kept its rate"
    assert (made.clock.now_ns() - begun_ns) / 1e9 > 1 + 0.9, "Y took a second"


@given(feed_mm_min=st.floats(20, 1200), held_s=st.floats(0.1, 2))
@settings(max_examples=25, deadline=None)
def test_whatever_the_rate_silence_ends_a_hold_in_time(feed_mm_min: float, held_s: float) -> None:
    made = homed()
    jogs, _ = jogs_of(made)
    jogs.rate.choose(feed_mm_min)

    def now_s() -> float:
        return made.clock.now_ns() / 1e9

    hold, begun_s = Hold(now_s), now_s()
    jogs.hold("x", 1, hold)
    jogs.start()
    made.controller.set_break_key(lambda: hold.hold() if now_s() - begun_s < held_s else None)
    assert made.controller.run() is Status.OK
    longest_mm = feed_mm_min / 60 * (held_s + DEAD_MAN_S + 2 * ROUND_S) + 1.0
    assert made.controller.state().position_mm[0] <= longest_mm
    assert look(made).lost_steps == (0, 0, 0)


def test_as_configured_until_somebody_chooses_and_again_when_he_has_enough() -> None:
    made = plant(jog={"feed_mm_min": 90})
    jogs, _ = jogs_of(made)
    assert jogs.rate.feed_mm_min == 90
    jogs.rate.choose(120)
    assert (jogs.rate.feed_mm_min, jogs.rate.configured_mm_min) == (120, 90)
    jogs.rate.choose(None)
    assert jogs.rate.feed_mm_min == 90


@pytest.mark.parametrize("feed_mm_min", [0.0, -5.0, math.nan, math.inf, 1e6, 1e-9])
def test_what_nothing_can_do_is_refused_and_changes_nothing(feed_mm_min: float) -> None:
    jogs, _ = jogs_of(plant())
    jogs.rate.choose(120)
    with pytest.raises(LimitError):
        jogs.rate.choose(feed_mm_min)
    assert jogs.rate.feed_mm_min == 120


def test_the_sentence_says_how_fast_the_fastest_axis_is() -> None:
    jogs, _ = jogs_of(plant())
    with pytest.raises(LimitError, match="No axis goes with 50000 mm/min: the fastest one can"):
        jogs.rate.choose(50_000)
