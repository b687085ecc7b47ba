"""The pad: a click is one width, a button that is held runs until it is let go."""

from functools import partial

from fraese.ui.widgets.jogpad import HELD_S, JogButton
from tests.ui.helpers import LONG_MOVE_MM, Bench, bench, play


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
