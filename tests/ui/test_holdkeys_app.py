"""Jog keys that are held, in the app: what ends them."""

import os
import re
import sys
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

pytest.importorskip("termios")

from textual import events
from textual.events import Key
from textual.widgets import Input

from fraese.ui.heldkeys import Manners
from fraese.ui.messages import KeyUp
from tests.terminals import PATIENCE_S
from tests.ui.helpers import Bench, bench, play
from tests.x4step.kittyterminal import RELEASE, REPEAT, ROOT, Screen, encoded


@dataclass(frozen=True)
class Patient(Manners):
    """Of a terminal that may be silent for long: this machine may be busy with something else."""

    patience_s: float = PATIENCE_S

    @property
    def silence_s(self) -> float:
        return self.patience_s


async def held(b: Bench, key: str = "right", manners: Manners = Patient()) -> None:
    """A jog key is held in a terminal that tells releases, and the axis runs."""
    b.app.tells_releases(True)
    b.app._strokes.manners = manners
    await b.press(key, key, key)
    await b.wait(lambda: b.app.link.moving)
    assert b.app.link.is_held


async def ends(b: Bench) -> None:
    """It is held no more, and stays where it is whatever the key repeats."""
    assert not b.app.link.is_held
    await b.settled()
    at = b.moved_steps
    await b.press("right", "right", "right")
    await b.settled()
    assert b.moved_steps == at
    assert b.mill.look().lost_steps == (0, 0, 0)


async def lose_focus(b: Bench) -> None:
    b.app.post_message(events.AppBlur())
    await b.pilot.pause()


async def resize(b: Bench) -> None:
    await b.pilot.resize_terminal(100, 30)


async def click(b: Bench) -> None:
    await b.pilot.click("#position")


ENDS: dict[str, Callable[[Bench], Awaitable[None]]] = {
    "another key": lambda b: b.press("v"),
    "the stop key": lambda b: b.press("escape"),
    "another size": resize,
    "the mouse": click,
    "another view": lambda b: b.press("f6"),
    "a dialog": lambda b: b.press("g"),
}


@pytest.mark.parametrize("what", ENDS)
def test_what_ends_a_held_key(what: str) -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await held(b)
            await ENDS[what](b)
            await ends(b)

    play(scene)


def test_a_lost_focus_ends_it() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await held(b)
            await lose_focus(b)
            assert not b.app.link.is_held
            await b.settled()

    play(scene)


def test_a_release_ends_it_and_the_next_press_is_one_width() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await held(b)
            b.app.post_message(KeyUp("right"))
            await b.pilot.pause()
            assert not b.app.link.is_held
            await b.settled()
            at = b.moved_steps[0]
            assert at > 0
            await b.jog("right")
            assert b.moved_steps[0] == at + 200

    play(scene)


def test_a_silent_terminal_ends_it() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await held(b, manners=Patient(patience_s=2.0))
            await b.wait(lambda: not b.app.link.is_held)
            await b.settled()
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)


def test_it_is_let_go_in_the_thread_that_reads_the_terminal() -> None:
    """Whatever the app's own thread is at."""

    async def scene() -> None:
        async with bench(clock="paced") as b:
            await held(b)
            b.app.lets_go("left")
            assert b.app.link.is_held
            b.app.lets_go("right")
            assert not b.app.link.is_held

    play(scene)


def test_at_the_width_of_one_step_a_held_key_makes_steps() -> None:
    async def scene() -> None:
        async with bench() as b:
            b.app.tells_releases(True)
            b.app._strokes.manners = Patient()
            await b.press("1", *["right"] * 5)
            await b.settled()
            assert b.moved_steps[0] == 5

    play(scene)


def test_what_comes_all_at_once_is_one_press_and_that_is_said() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("5")
            for number in range(8):
                key = Key("right", None)
                key.time = 1000 + number / 1000
                b.app.post_message(key)
            await b.settled()
            assert b.moved_steps[0] == 2000
            assert any("all at once" in event.text for event in b.app._events.events)

    play(scene)


@pytest.mark.parametrize("key", ["g", "m", "n", "o"])
def test_jog_keys_are_dead_while_text_is_typed(key: str) -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press(key)
            assert isinstance(b.app.screen.focused, Input)
            await b.press("left", "right", "up", "down", "home", "end")
            await b.settled()
            assert b.moved_steps == (0, 0, 0)

    play(scene)


@pytest.mark.alone
def test_in_a_terminal_that_tells_releases(tmp_path: Path) -> None:
    screen = Screen()
    folders = {"XDG_STATE_HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path)}
    screen.start_program(
        [sys.executable, "-m", "fraese", "--fresh"],
        {**os.environ, "PYTHONPATH": str(ROOT), **folders},
    )
    screen.until("Hold")
    screen.until_flags([27])
    until_s = time.monotonic() + PATIENCE_S
    while not _held_beyond(screen, 3.0):
        # On a busy machine the dead man may let go first; it is not revived.
        assert time.monotonic() < until_s, screen.seen[-2000:]
        screen.type(encoded("RIGHT", RELEASE))
        _read(screen, 0.7)
    screen.type(encoded("RIGHT", RELEASE))
    _read(screen, 0.7)
    stood = _furthest_mm(screen)
    _read(screen, 0.5)
    assert _furthest_mm(screen) == stood
    screen.type(encoded("q") + encoded("q", RELEASE))
    assert screen.end() == 0
    assert screen.terminal.flags == []


def _read(screen: Screen, seconds: float) -> None:
    """What is drawn meanwhile."""
    import select

    until_s = time.monotonic() + seconds
    while select.select([screen.master], [], [], max(0.0, until_s - time.monotonic()))[0]:
        screen.read()


def _furthest_mm(screen: Screen) -> float:
    return max((float(n) for n in re.findall(r"Jog|(\d+\.\d{3})", screen.seen) if n), default=0.0)


def _held_beyond(screen: Screen, mm: float) -> bool:
    """A key that is held for a second moves so far."""
    wanted_mm = _furthest_mm(screen) + mm
    screen.type(encoded("RIGHT"))
    for _ in range(40):
        screen.type(encoded("RIGHT", REPEAT))
        time.sleep(0.03)
        _read(screen, 0.0)
        if _furthest_mm(screen) > wanted_mm:
            return True
    return False
