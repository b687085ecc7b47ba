"""How a terminal repeats a key: measured, believed or not, kept for this terminal."""

import json
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from textual.events import Key

from fraese.errors import UsageError
from fraese.ui.dialogs.heldkey import HeldKeyPage
from fraese.ui.eventlog import Kind
from fraese.ui.heldkeys import HeldKeys, Manners, Stroke
from fraese.ui.measuring import REPEATS, Measurement, terminal_name
from fraese.ui.session import Session, with_manners
from tests.ui.helpers import Bench, bench, play

KEYBOARD = Manners(0.4, 0.03, 0.01)


def held_s(
    manners: Manners = KEYBOARD, begun_s: float = 5.0, repeats: int = REPEATS + 1
) -> list[float]:
    """When strokes come of a key that is held, every other one off as far as it may be."""
    first_s = begun_s + manners.delay_s
    gaps_s = [manners.interval_s + (-1) ** n * manners.jitter_s for n in range(repeats - 1)]
    return [begun_s, first_s, *(first_s + sum(gaps_s[: n + 1]) for n in range(repeats - 1))]


def measured(times_s: list[float]) -> Measurement:
    measurement = Measurement()
    for at_s in times_s:
        measurement.stroke(at_s)
    return measurement


# --- what is measured ----------------------------------------------------------------------------


@given(
    st.floats(0.25, 1.9),
    st.floats(0.01, 0.09),
    st.floats(0, 0.9),
    st.floats(0, 1e6),
)
def test_what_a_keyboard_sends_is_found_and_held_by_the_second_repeat(
    delay_s: float, interval_s: float, share: float, begun_s: float
) -> None:
    sent = Manners(delay_s, interval_s, share * min(interval_s, 0.019))
    found = measured(held_s(sent, begun_s)).manners()
    assert found.delay_s == pytest.approx(delay_s, abs=1e-6)
    assert found.interval_s == pytest.approx(interval_s, abs=1e-6)
    assert found.jitter_s == pytest.approx(sent.jitter_s, abs=1e-6)
    keys = HeldKeys()
    keys.manners = found
    strokes = [keys.press("right", at_s) for at_s in held_s(sent, begun_s + 100, 4)]
    queued = sent.interval_s - sent.jitter_s < 0.009
    assert queued or strokes[:3] == [Stroke.TAP, Stroke.REPEAT, Stroke.HOLD]


@pytest.mark.parametrize(
    "times_s",
    [
        [n * 0.15 for n in range(REPEATS + 2)],
        [n * 0.08 for n in range(REPEATS + 2)],
        [0.0 for n in range(REPEATS + 2)],
        held_s(Manners(0.4, 0.001, 0)),
        held_s(Manners(0.05, 0.02, 0)),
        held_s(Manners(0.9, 0.15, 0)),
        held_s(Manners(0.5, 0.08, 0.05)),
    ],
)
def test_fingers_and_uneven_lines_are_not_believed(times_s: list[float]) -> None:
    measurement = measured(times_s)
    assert measurement.is_enough
    with pytest.raises(UsageError, match="cannot be told from fingers"):
        measurement.manners()


def test_who_lets_go_too_early_begins_anew() -> None:
    measurement = measured(held_s(repeats=10))
    assert measurement.gaps == 9
    measurement.stroke(8.0)
    assert measurement.gaps == 0
    for at_s in held_s(begun_s=20.0):
        measurement.stroke(at_s)
    assert measurement.manners().delay_s == pytest.approx(0.4)


def test_what_is_more_than_enough_changes_nothing() -> None:
    times_s = held_s(repeats=REPEATS + 50)
    assert measured(times_s).manners() == measured(times_s[: REPEATS + 2]).manners()


def test_a_keyboard_that_was_set_slower_since_makes_no_row_of_taps() -> None:
    keys = HeldKeys()
    keys.manners = Manners(0.2, 0.015, 0.002)
    strokes = [keys.press("right", at_s) for at_s in held_s(Manners(0.5, 0.04, 0.0), repeats=20)]
    assert strokes.count(Stroke.TAP) == 2
    assert Stroke.HOLD in strokes


def test_terminals_are_told_apart_and_named_in_plain_text() -> None:
    assert terminal_name({}) == "terminal"
    assert terminal_name({"TERM": "xterm-256color"}) == "xterm-256color"
    far = {"TERM": "xterm", "TERM_PROGRAM": "iTerm.app", "SSH_TTY": "/dev/pts/1"}
    assert terminal_name(far) == "xterm iTerm.app ssh"
    strange = terminal_name({"TERM": "\udcff\x1b[2J" * 50, "TERM_PROGRAM": "ü" * 500})
    assert strange.isascii()
    assert strange.isprintable()
    assert len(strange) <= 60


# --- what is kept --------------------------------------------------------------------------------


def test_of_each_terminal_the_last_is_kept_and_of_many_the_latest() -> None:
    kept: dict[str, Manners] = {}
    for n in range(80):
        kept = with_manners(kept, f"terminal {n}", KEYBOARD)
    assert len(kept) == 50
    assert list(kept)[-1] == "terminal 79"
    assert with_manners(kept, "other", Manners()) == kept
    assert Session.model_validate_json(Session(held_keys=kept).model_dump_json()).held_keys == kept


@pytest.mark.parametrize(
    "nonsense",
    [
        {"delay_s": 0.4, "interval_s": 0.0, "jitter_s": 0.0},
        {"delay_s": 0.0, "interval_s": 0.04, "jitter_s": 0.0},
        {"delay_s": 0.4, "interval_s": 0.03, "jitter_s": 30.0},
        {"delay_s": 0.4, "interval_s": float("nan"), "jitter_s": 0.0},
        {"delay_s": float("inf"), "interval_s": 0.03, "jitter_s": 0.0},
        {"delay_s": "soon", "interval_s": 0.03, "jitter_s": 0.0},
        [0.4, 0.03, 0.01],
    ],
)
def test_nonsense_is_forgotten_with_a_word_in_the_log(tmp_path: Path, nonsense: object) -> None:
    path = tmp_path / "session.json"
    others = {"other": {"delay_s": 0.4, "interval_s": 0.03, "jitter_s": 0.001}}
    kept = {"version": 1, "theme": "x", "held_keys": {terminal_name(): nonsense, **others}}
    path.write_text(json.dumps(kept))

    async def scene() -> None:
        async with bench(session=path) as b:
            await b.settled()
            assert not b.app._strokes.manners.is_measured
            said = [event.title for event in b.app._events.of(tuple(Kind))]
            assert [each for each in said if "is damaged there" in each and "other" not in each]
            # One bad entry takes nothing else with it.
            assert b.app._session.found.theme == "x"
            assert list(b.app._session.found.held_keys) == ["other"]

    play(scene)


def test_more_terminals_than_are_ever_kept_are_refused() -> None:
    with pytest.raises(ValidationError):
        Session(held_keys={str(n): KEYBOARD for n in range(51)})


# --- the page ------------------------------------------------------------------------------------


async def page_of(b: Bench) -> HeldKeyPage:
    await b.press("h")
    await b.wait(lambda: isinstance(b.app.screen, HeldKeyPage) and b.app.screen.is_mounted)
    page = b.app.screen
    assert isinstance(page, HeldKeyPage)
    return page


async def hold(b: Bench, times_s: list[float]) -> None:
    """Strokes as the thread that reads the terminal hands them in, each with its time."""
    for at_s in times_s:
        key = Key("right", None)
        key.time = at_s
        key.set_sender(b.app)
        b.app.post_message(key)
    await b.pilot.pause()


def test_a_key_is_held_measured_used_and_kept_and_nothing_moves(tmp_path: Path) -> None:
    path = tmp_path / "session.json"

    async def before() -> None:
        async with bench(session=path) as b:
            page = await page_of(b)
            assert page._found.text == "Nobody has measured this terminal yet."
            await hold(b, held_s(begun_s=time.monotonic()))
            await b.wait(lambda: b.app._strokes.manners.is_measured)
            assert page._found.text.startswith("measured: the first repeat after 400 ms, then")
            await b.press("escape")
            await b.wait(lambda: b.app.screen is b.app.view)
            await b.settled()
            assert b.moved_steps == (0, 0, 0)

    async def after() -> None:
        async with bench(session=path) as b:
            await b.settled()
            assert b.app._strokes.manners.delay_s == pytest.approx(0.4)
            page = await page_of(b)
            assert page._found.text.startswith("measured:")

    play(before)
    play(after)


def test_what_is_not_believed_is_said_and_what_was_known_stays() -> None:
    async def scene() -> None:
        async with bench() as b:
            b.app._strokes.manners = KEYBOARD
            page = await page_of(b)
            await hold(b, [time.monotonic() + n * 0.15 for n in range(REPEATS + 2)])
            await b.wait(lambda: "fingers" in page._found.text)
            assert b.app._strokes.manners == KEYBOARD
            await b.settled()
            assert b.moved_steps == (0, 0, 0)

    play(scene)


def test_whoever_still_holds_the_key_when_the_page_closes_moves_nothing() -> None:
    async def scene() -> None:
        async with bench() as b:
            await page_of(b)
            begun_s = time.monotonic()
            times_s = held_s(begun_s=begun_s)
            await hold(b, times_s)
            await b.wait(lambda: b.app._strokes.manners.is_measured)
            escape = Key("escape", None)
            escape.time = times_s[-1] + 0.01
            escape.set_sender(b.app)
            b.app.post_message(escape)
            await b.wait(lambda: b.app.screen is b.app.view)
            await hold(b, [times_s[-1] + 0.03 * n for n in range(1, 20)])
            await b.settled()
            assert b.moved_steps == (0, 0, 0)

    play(scene)


def test_while_the_machine_moves_it_is_not_opened() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            await b.press("h")
            await b.pilot.pause()
            assert b.app.screen is b.app.view
            assert "The machine runs" in b.app.view.said[0]
            await b.press("escape")

    play(scene)


def test_the_palette_and_the_help_know_it() -> None:
    async def scene() -> None:
        async with bench(size=(120, 40)) as b:
            commands = {each.title: each for each in b.app.get_system_commands(b.app.screen)}
            await commands["Measure a held key …"].callback()
            await b.wait(lambda: isinstance(b.app.screen, HeldKeyPage))

    play(scene)
