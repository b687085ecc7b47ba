"""Which strokes are taps, and from when on a key is held."""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.ui.heldkeys import HeldKeys, Manners, Stroke
from fraese.ui.widths import PAUSE_S

TAP, REPEAT, HOLD = Stroke.TAP, Stroke.REPEAT, Stroke.HOLD
STILL, SPENT, QUEUED = Stroke.STILL, Stroke.SPENT, Stroke.QUEUED
MEASURED = Manners(delay_s=0.5, interval_s=0.033, jitter_s=0.01)


def strokes(keys: HeldKeys, times_s: Sequence[float], key: str = "right") -> list[Stroke]:
    return [keys.press(key, at_s) for at_s in times_s]


def held_times_s(begun_s: float = 10.0, repeats: int = 6) -> list[float]:
    """A key that is held: half a second, then thirty a second."""
    return [begun_s, *(begun_s + 0.5 + n / 30 for n in range(repeats))]


def test_where_nobody_has_measured_four_repeats_are_held() -> None:
    assert strokes(HeldKeys(), held_times_s()) == [TAP, TAP, REPEAT, REPEAT, HOLD, STILL, STILL]


def test_where_it_was_measured_the_second_repeat_is_enough() -> None:
    keys = HeldKeys()
    keys.manners = MEASURED
    assert strokes(keys, held_times_s()) == [TAP, REPEAT, HOLD] + [STILL] * 4


def test_where_releases_are_told_repeats_are_no_presses() -> None:
    keys = HeldKeys()
    keys.tells = True
    assert strokes(keys, held_times_s()) == [TAP, REPEAT, HOLD] + [STILL] * 4
    assert keys.up("right")
    assert not keys.holds
    assert strokes(keys, [10.8, 10.9]) == [TAP, REPEAT]
    assert not keys.up("right")
    for n in range(10):
        assert keys.press("right", 11 + n / 100) is TAP
        assert not keys.up("right")


def test_fast_fingers_hold_nothing() -> None:
    keys = HeldKeys()
    keys.manners = MEASURED
    assert strokes(keys, [n * 0.08 for n in range(20)]) == [TAP] * 20


def test_what_comes_all_at_once_is_no_row_of_taps() -> None:
    for manners in (Manners(), MEASURED):
        keys = HeldKeys()
        keys.manners = manners
        assert strokes(keys, [5 + n * 0.001 for n in range(10)]) == [TAP] + [QUEUED] * 9


def test_a_silence_ends_a_hold() -> None:
    keys = HeldKeys()
    keys.manners = MEASURED
    strokes(keys, held_times_s())
    late_s = keys._at_s + MEASURED.silence_s
    assert keys.press("right", late_s) is TAP
    keys.tells = True
    keys.all_up()
    strokes(keys, held_times_s(20.0))
    assert keys.press("right", keys._at_s + 1) is SPENT
    assert keys.press("right", keys._at_s + 0.03) is SPENT
    keys.up("right")
    assert keys.press("right", keys._at_s + 0.03) is TAP


def test_another_key_spends_what_was_held() -> None:
    for tells in (False, True):
        keys = HeldKeys()
        keys.tells, keys.manners = tells, MEASURED
        strokes(keys, held_times_s())
        at_s = keys._at_s
        assert keys.press("escape", at_s + 0.02) is TAP
        assert strokes(keys, [at_s + 0.03 * n for n in range(2, 30)]) == [SPENT] * 28
        keys.up("right")
        assert keys.press("right", keys._at_s + 0.3) is TAP


def test_a_stop_of_another_kind_spends_it_too() -> None:
    keys = HeldKeys()
    keys.manners = MEASURED
    strokes(keys, held_times_s())
    keys.end()
    assert not keys.holds
    assert strokes(keys, [keys._at_s + 0.03 * n for n in range(1, 9)]) == [SPENT] * 8


def test_after_a_loss_of_focus_nobody_waits_for_a_release() -> None:
    keys = HeldKeys()
    keys.tells = True
    strokes(keys, held_times_s())
    keys.all_up()
    assert keys.press("right", 30.0) is TAP
    # Its release was never told.
    assert keys.press("right", 33.0) is TAP


def test_manners_are_bounded() -> None:
    assert Manners().silence_s == pytest.approx(0.15)
    assert Manners(0.3, 0.001, 0).silence_s == 0.08
    assert Manners(0.3, 1.0, 1.0).silence_s == 0.4


GAPS = st.lists(
    st.tuples(
        st.sampled_from(("right", "left", "escape", "up:right", "end", "blur")),
        st.floats(0.0, 1.5),
    ),
    max_size=30,
)


@given(GAPS, st.booleans(), st.booleans())
def test_whatever_comes_a_hold_has_strokes_close_together_before_it(
    happened: list[tuple[str, float]], tells: bool, measured: bool
) -> None:
    keys, now_s, rows = HeldKeys(), 10.0, 0
    keys.tells, keys.manners = tells, MEASURED if measured else Manners()
    for what, gap_s in happened:
        now_s += gap_s
        if what == "end":
            keys.end()
        elif what == "blur":
            keys.all_up()
        elif what.startswith("up:"):
            keys.up(what[3:])
        else:
            before_s = keys._at_s
            stroke = keys.press(what, now_s)
            rows = rows + 1 if what == keys.holds or stroke in (TAP, REPEAT) else 0
            if stroke in (HOLD, STILL):
                assert now_s - before_s < max(PAUSE_S, 2.0)
                assert keys.holds == what
                assert rows >= 3
            continue
        assert not keys.holds or what.startswith("up:")
