"""Small things that were once misleading."""

import asyncio
from pathlib import Path
from typing import cast

import pytest
from rich.style import Style
from textual import events
from textual.app import App, ComposeResult
from textual.command import CommandList

from fraese.program.program import open_program
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.help import HelpPage
from fraese.ui.views.machine import MachineView
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.options import Options, Palette
from tests.ui.helpers import bench, play


def test_ctrl_c_at_standstill_closes_what_escape_closes() -> None:
    async def scene() -> None:
        async with bench() as b:
            for key, page in (("g", GoToDialog), ("question_mark", HelpPage)):
                await b.press(key)
                assert isinstance(b.app.screen, page)
                await b.press("ctrl+c")
                assert isinstance(b.app.screen, MachineView)
            await b.press("ctrl+p")
            assert b.app.screen is not b.view
            await b.press("ctrl+c")
            await b.wait(lambda: b.app.screen is b.view)
            await b.press("ctrl+c")
            assert b.app.screen is b.view

    play(scene)


@pytest.mark.parametrize(
    ("words", "where", "said"),
    [
        (
            "X1" + "0" * 24,
            "#complaint",
            "X 1e+24 is further than any machine: at most 10,000,000 mm either way.",
        ),
        (
            "X1 F99999999",
            "#message",
            "F 99999999 mm/min is more than the axes can: it goes with 1200.",
        ),
    ],
)
def test_numbers_that_no_machine_has(words: str, where: str, said: str) -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("g")
            await b.type(words)
            await b.press("enter")
            await b.wait(lambda: b.app.screen.query_one(where, Fact).text == said)
            await b.settled()
            assert b.app.screen.query_one(where, Fact).text == said

    play(scene)


def test_an_empty_file_is_no_program(tmp_path: Path) -> None:
    path = tmp_path / "empty.nc"
    path.write_text("\n  \n")

    async def scene() -> None:
        async with bench(program=path, open_program=open_program) as b:
            await b.wait(lambda: "is empty: there is nothing to run" in b.text("#message"))

    play(scene)


def test_the_tool_is_lifted() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("L")
            await b.settled()
            assert b.moved_steps == (0, 0, 2000), "a little, since nobody knows the travel"
            b.app.link.reference(("z",), measure=False)
            await b.settled()
            b.app.link.order_of(lambda controller: controller.jog("z", -20))
            await b.settled()
            await b.press("L")
            await b.settled()
            assert b.drawn.position_mm[2] == b.drawn.high_mm[2]
            await b.press("L")
            await b.wait(lambda: "is up already" in b.text("#message"))

    play(scene)


@pytest.mark.parametrize("key", ["pageup", "pagedown"])
@pytest.mark.parametrize("rows", [1, 3, 24])
def test_a_palette_without_a_line_in_sight_has_no_pages(rows: int, key: str) -> None:
    async def scene() -> None:
        async with bench(size=(80, rows)) as b:
            await b.press("ctrl+p")
            commands = b.app.screen.query_one(CommandList)
            await b.wait(lambda: commands.option_count > 1)
            await b.press(key)
            assert b.app.is_running
            await b.press("escape")
            assert b.app.screen is b.view

    play(scene)


class LowList(App[None]):
    """A list of which no line is to be seen."""

    def compose(self) -> ComposeResult:
        options = Options("one", "two")
        options.styles.height = 0
        yield options


def test_a_list_without_a_line_in_sight_has_no_pages_and_takes_no_late_click() -> None:
    async def scene() -> None:
        app = LowList()
        async with app.run_test() as pilot:
            options = app.query_one(Options)
            options.focus()
            options.highlighted = 1
            await pilot.press("pageup", "pagedown")
            gone = Style(meta={"option": 5})
            options.post_message(
                events.Click(options, 0, 0, 0, 0, 1, False, False, False, 0, 0, gone)
            )
            await pilot.pause()
            assert options.highlighted == 1

    play(scene)


def test_a_palette_that_has_gone_before_its_search_begins() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            palette = cast(Palette, b.app.screen)
            await palette.query_one(CommandList).remove()
            palette._gather_commands("")
            await b.settled()
            await palette.workers.wait_for_complete()

    play(scene)


@pytest.mark.parametrize("key", ["down", "up", "pagedown", "enter"])
def test_a_palette_whose_list_has_gone_hears_no_key(key: str) -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            await b.app.screen.query_one(CommandList).remove()
            await b.press(key)
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            await b.press("escape")

    play(scene)


def test_a_page_that_ends_below_the_palette_goes_when_that_goes() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("g")
            page = cast(GoToDialog, b.app.screen)
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            page.dismiss(None)
            page.dismiss(None)
            await b.settled()
            assert isinstance(b.app.screen, Palette)
            await b.press("escape")
            await b.wait(lambda: b.app.screen is b.view)

    play(scene)


def test_a_palette_that_is_closed_twice_at_once_is_closed_once() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            palette = b.app.screen
            palette.dismiss(None)
            palette.dismiss(None)
            await b.wait(lambda: b.app.screen is b.view)
            await b.press("g")
            assert isinstance(b.app.screen, GoToDialog)

    play(scene)


def test_what_is_typed_on_the_way_out_goes_nowhere() -> None:
    async def scene() -> None:
        async with bench() as b:
            pass
        await b.app.on_event(events.Key("x", "x"))
        assert b.app.exit_code == 0

    play(scene)


def test_a_mouse_button_pressed_on_what_has_just_gone_is_pressed_on_nothing() -> None:
    async def scene() -> None:
        async with bench() as b:
            gone = b.view.query_one("#message")
            parent, at = gone._parent, gone.region.offset
            # Off the tree, and still in the last picture.
            gone._parent = None
            b.tell(events.MouseDown(None, *at, 0, 0, 1, False, False, False, *at))
            await asyncio.sleep(0.1)
            gone._parent = parent
            assert b.app.is_running
            assert b.app._exception is None

    play(scene)


def test_there_is_one_palette_whatever_lies_above_it() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            b.app.push_screen(HelpPage(b.app.view.desk.keys))
            await b.wait(lambda: isinstance(b.app.screen, HelpPage))
            b.app.action_command_palette()
            await b.pilot.pause()
            assert isinstance(b.app.screen, HelpPage)

    play(scene)


def test_each_view_may_have_its_palette() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            await b.app.action_next_view(1)
            await b.press("ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))

    play(scene)
