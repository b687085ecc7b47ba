"""Small things that were once misleading."""

from pathlib import Path

import pytest

from fraese.program.program import open_program
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.help import HelpPage
from fraese.ui.views.machine import MachineView
from fraese.ui.widgets.fact import Fact
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
