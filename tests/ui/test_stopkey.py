"""The stop key acts where the terminal is read, whatever the app's thread is doing."""

import asyncio
import threading
from pathlib import Path
from typing import Any, cast

import pytest
from textual.driver import Driver
from textual.events import Key
from textual.message import Message
from textual.widgets import Button

from fraese.config import Config
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.keyrows.everywhere import STOP_KEYS
from fraese.ui.stopkey import EarlyStop
from tests.ui.helpers import Bench, FakeProgram, bench, play


class Terminal(Driver):
    """A terminal in name only; what it hears goes to the app as usual."""

    def __init__(self, app: object) -> None:
        self.app = app

    def write(self, data: str) -> None: ...

    def start_application_mode(self) -> None: ...

    def disable_input(self) -> None: ...

    def stop_application_mode(self) -> None: ...

    def process_message(self, message: Message) -> None:
        message.set_sender(self.app)  # type: ignore[arg-type]
        self.app.post_message(message)  # type: ignore[attr-defined]


def press_without_app(b: Bench, *keys: str) -> None:
    """Keys from the input's thread, all before the app's thread comes to the first of them."""
    terminal = b.app._early_stop.driver(Terminal)(b.app)

    def type_them() -> None:
        for key in keys:
            terminal.process_message(Key(key, None))

    typist = threading.Thread(target=type_them)
    typist.start()
    typist.join()


async def the_app_has_come_to_it(b: Bench) -> None:
    """And to what was pressed before it: from app to screen, and back to the app."""
    await b.wait(lambda: not b.app._early_stop._heard and b.app._heard is None)
    for pump in (b.view, b.app):
        done = asyncio.Event()
        pump.call_later(done.set)
        await done.wait()


def test_the_motors_brake_while_the_app_draws() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            press_without_app(b, "ctrl+c")
            assert b.plant.controller.cancelling
            await b.settled()
            assert "Cancelled" in b.text("#message")
            assert "without ramp" not in b.text("#message"), "one key stops once"
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)


def test_a_second_key_stops_without_ramp() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            press_without_app(b, "ctrl+c", "escape")
            await b.settled()
            assert "without ramp" in b.text("#message")

    play(scene)


def test_what_was_pressed_before_it_does_not_move_for_long() -> None:
    async def scene() -> None:
        config = Config.model_validate({"jog": {"feed_mm_min": 60}})
        async with bench(clock="paced", config=config) as b:
            await b.press("5")
            press_without_app(b, "right", "right", "ctrl+c")
            await b.settled()
            assert b.moved_steps[0] < 1900

    play(scene)


def test_what_was_ordered_before_it_and_has_not_begun_never_moves() -> None:
    """The start key has been to the screen and waits to be done when the stop key is heard."""

    async def scene() -> None:
        gate = threading.Event()
        begun = threading.Event()

        def wait_at_the_gate() -> None:
            begun.set()
            assert gate.wait(60)

        program = FakeProgram(["G1 X1"], distance_mm=100, at_the_gate=wait_at_the_gate)
        async with bench(
            clock="paced", program=Path("fake.nc"), open_program=lambda path: program
        ) as b:
            await b.wait(lambda: "Start it" in b.text("#message"))
            await b.settled()
            await b.ask_to_start()
            start = Key("enter", None)
            start._set_forwarded()
            b.app.post_message(start)
            press_without_app(b, "ctrl+c")
            # Whichever the dialog hears first: a start that is cancelled, or none.
            await b.wait(lambda: begun.is_set() or b.app.screen is b.view)
            await the_app_has_come_to_it(b)
            gate.set()
            await b.settled()
            assert b.moved_steps == (0, 0, 0)
            assert not program.started or "Cancelled" in b.text("#message")

    play(scene)


def test_a_button_that_is_heard_after_it_orders_nothing() -> None:
    """Of a dialog that the stop key has closed."""

    async def scene() -> None:
        async with bench() as b:
            await b.press("g")
            await b.type("X5")
            dialog = b.app.screen
            assert isinstance(dialog, GoToDialog)
            await b.press("ctrl+c")
            await b.wait(lambda: b.app.screen is b.view)
            dialog.post_message(Button.Pressed(Button(id="yes")))
            dialog._yes()
            dialog._back()
            await b.settled()
            assert b.moved_steps == (0, 0, 0)
            assert b.app.screen is b.view

    play(scene)


@pytest.mark.parametrize("keys", [["s"], ["right"], ["right", "right"], ["g", "right"]])
def test_what_was_pressed_before_it_and_comes_later_is_not_done(keys: list[str]) -> None:
    """The stop key does not go to the screen first, and so overtakes it."""

    async def scene() -> None:
        program = FakeProgram(["G1 X1"], distance_mm=100)
        async with bench(program=Path("fake.nc"), open_program=lambda path: program) as b:
            await b.wait(lambda: "Start it" in b.text("#message"))
            await b.settled()
            press_without_app(b, *keys, "ctrl+c")
            await the_app_has_come_to_it(b)
            await b.settled()
            assert (program.started, b.moved_steps) == (0, (0, 0, 0))
            assert b.app.screen is b.view
            await b.jog("right")
            assert b.moved_steps == (200, 0, 0)

    play(scene)


@pytest.mark.parametrize("early", [True, False])
def test_jog_keys_work_again_after_it_dropped_one_that_waited(early: bool) -> None:
    async def scene() -> None:
        config = Config.model_validate({"jog": {"feed_mm_min": 60}})
        async with bench(clock="paced", config=config) as b:
            await b.press("5", "right")
            await b.wait(lambda: b.plant.controller.state().running)
            if early:
                second = Key("right", None)
                second._set_forwarded()
                b.app.post_message(second)
                press_without_app(b, "ctrl+c")
                await the_app_has_come_to_it(b)
            else:
                await b.press("right", "ctrl+c")
            await b.settled()
            stood = b.moved_steps[0]
            assert 0 < stood < 1900
            await b.press("3")
            await b.jog("right")
            assert b.moved_steps[0] == stood + 20

    play(scene)


def test_only_stop_keys_are_heard_and_each_once() -> None:
    acts: list[bool] = []

    def act() -> bool:
        acts.append(True)
        return True

    class Deaf(Terminal):
        def process_message(self, message: Message) -> None: ...

    early = EarlyStop(STOP_KEYS, act)
    terminal = early.driver(Deaf)(cast(Any, None))
    jog, stop = Key("right", None), Key("escape", None)
    for key in (jog, stop):
        terminal.process_message(key)
    assert acts == [True]
    assert early.of(jog) is None
    assert early.of(stop) == (stop, True)
    assert early.of(stop) is None
