"""The pad: a click is one width, a button that is held runs until it is let go."""

from collections.abc import Awaitable, Callable
from functools import partial

import pytest
from textual import events

from fraese.config import Config
from fraese.ui.widgets.jogpad import HELD_S, JogButton
from tests.ui.helpers import LONG_MOVE_MM, Bench, bench, play

#: By itself it would be at the end of the longest jog after most of a minute.
SLOW = Config.model_validate({"jog": {"feed_mm_min": 60}})


def patiently(b: Bench) -> None:
    """This machine may be busy with something else for longer than a dead man's time."""
    b.app.link.hold_jog = partial(b.app.link.hold_jog, silence_s=60.0)  # type: ignore[method-assign]


def test_a_click_is_one_width() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.pilot.click("#jog-y-less")
            await b.settled()
            await b.press("5")
            await b.pilot.click("#jog-z-more")
            await b.settled()
            assert b.moved_steps == (0, -200, 2000)

    play(scene)


def test_a_button_that_is_held_runs_until_it_is_let_go() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            patiently(b)
            await b.pilot.mouse_down("#jog-x-more")
            await b.pilot.pause(HELD_S)
            await b.wait(lambda: b.moved_steps[0] > 2 * 200)
            button = b.view.query_one("#jog-x-more", JogButton)
            assert button.has_class("-down")
            await b.pilot.mouse_up("#jog-x-more")
            await b.settled()
            at = b.moved_steps[0]
            assert at < 0.9 * LONG_MOVE_MM * 200
            assert not button.has_class("-down")
            await b.pilot.pause(0.3)
            assert b.moved_steps[0] == at
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)


async def leave(b: Bench) -> None:
    await b.pilot.hover("#jog-y-more")


async def leave_window(b: Bench) -> None:
    """Nobody hears where the button is let go."""
    b.tell(events.MouseMove(None, -1, 30, 0, 0, 1, False, False, False, -1, 30))


async def lose_focus(b: Bench) -> None:
    b.tell(events.AppBlur())


async def ask_for_help(b: Bench) -> None:
    await b.press("question_mark")


async def resize(b: Bench) -> None:
    await b.pilot.resize_terminal(130, 50)


@pytest.mark.parametrize("lose", [leave, leave_window, lose_focus, ask_for_help, resize])
def test_a_button_whose_release_may_not_be_heard_counts_as_let_go(
    lose: Callable[[Bench], Awaitable[None]],
) -> None:
    async def scene() -> None:
        async with bench(clock="paced", config=SLOW) as b:
            patiently(b)
            await b.pilot.mouse_down("#jog-x-more")
            await b.wait(lambda: b.moved_steps[0] > 20)
            await lose(b)
            await b.settled()
            at = b.moved_steps[0]
            assert at < 0.5 * SLOW.jog.max_mm * 200
            await b.pilot.pause(0.3)
            assert b.moved_steps[0] == at, "what is still held does not set out again"

    play(scene)


def test_the_stop_key_stops_what_is_held() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            patiently(b)
            await b.pilot.mouse_down("#jog-x-less")
            await b.wait(lambda: b.moved_steps[0] < -200)
            await b.press("escape")
            await b.settled()
            at = b.moved_steps[0]
            await b.pilot.pause(0.3)
            assert b.moved_steps[0] == at, "what is still held does not set out again"
            await b.pilot.mouse_up("#jog-x-less")
            assert not b.app.link.moving

    play(scene)
