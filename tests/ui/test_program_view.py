"""The view Program: what is drawn, what runs, and the one dialog before the start."""

from functools import partial
from pathlib import Path

import pytest
from textual.widgets import Button, Input, OptionList

from fraese.program.program import open_program
from fraese.program.recent import RecentPrograms
from fraese.ui.dialogs.start import StartDialog, WayDialog
from fraese.ui.views.program import ProgramView
from fraese.ui.widgets.pathpane import PathPane
from fraese.ui.widgets.programpane import ProgramPane
from tests.ui.helpers import Bench, bench, play

APART = partial(open_program, apart=True)
PART = "G21 G90 F1200\nG0 X10\nG1 Y20\nG1 X20\n(turn)\nG1 Y0\nG0 X0\nM2\n"


def pane(b: Bench) -> ProgramPane:
    assert isinstance(b.app.view, ProgramView)
    return b.app.view.query_one(ProgramPane)


def picture(shown: PathPane) -> list[str]:
    return [shown.render_line(y).text for y in range(shown.size.height)]


def colours(shown: PathPane, class_name: str) -> int:
    """So many characters have the style of this class."""
    style = shown.get_component_rich_style(f"toolpath--{class_name}")
    return sum(
        len(segment.text)
        for y in range(shown.size.height)
        for segment in shown.render_line(y)
        if segment.style == style
    )


async def opened(b: Bench) -> None:
    await b.app.action_show_view("program")
    programs = b.app._programs
    await b.wait(lambda: programs.program is not None and programs.program.facts is not None)
    await b.wait(lambda: programs.look is None)
    await b.wait(lambda: not b.app.busy)
    await b.wait(lambda: pane(b).toolpath.scene.way is not None)
    await b.wait(lambda: not pane(b).toolpath.is_drawing)


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (200, 60)])
def test_a_program_is_drawn_and_run(tmp_path: Path, size: tuple[int, int]) -> None:
    path = tmp_path / "part.nc"
    path.write_text(PART)

    async def scene() -> None:
        async with bench(size=size, program=path, open_program=APART) as b:
            await opened(b)
            main, below = pane(b).toolpath.panes
            await b.wait(lambda: "◆" in "".join(picture(main)))
            shown = picture(main)
            assert shown[0].startswith("XY")
            assert any("\u2801" <= char <= "\u28ff" for row in shown for char in row)
            assert colours(main, "todo") > 10
            assert colours(main, "rapid") > 3
            assert colours(main, "done") == 0
            assert below.display
            assert "part.nc" in pane(b).progress.texts[0]
            assert "feed 100%" in pane(b).progress.texts[1]

            await b.ask_to_start()
            await b.press("enter")
            await b.wait(lambda: not b.app.busy and b.drawn.job is not None)
            await b.settled()
            assert b.moved_steps == (0, 0, 0)
            assert b.drawn.job is not None
            assert b.drawn.job.share == pytest.approx(1, abs=0.01)

    play(scene)


@pytest.mark.alone
def test_what_is_done_is_bright_and_the_line_in_hand_is_lit_in_both(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G21 G90 F1200\nG1 X10\nG1 Y10\nG1 X200\nM2\n")

    async def scene() -> None:
        async with bench(size=(120, 40), clock="paced", program=path, open_program=APART) as b:
            await opened(b)
            await b.ask_to_start()
            await b.press("enter")
            await b.wait(lambda: pane(b).listing.current == 4)
            main = pane(b).toolpath.panes[0]
            await b.wait(lambda: colours(main, "now") > 10)
            assert colours(main, "done") > 3
            assert "line 4/5" in pane(b).progress.texts[0]
            assert "left" in pane(b).progress.texts[1]
            # Overrides and switches act, and are seen.
            await b.press("comma", "less_than_sign", "less_than_sign", "b")
            await b.wait(lambda: "feed 90%   rapids 80%" in pane(b).progress.texts[1])
            assert "single block" in pane(b).progress.texts[1]
            await b.press("equals_sign")
            await b.wait(lambda: "feed 100%   rapids 100%" in pane(b).progress.texts[1])
            await b.press("escape")
            await b.settled()
            # It is drawn in pieces.
            await b.wait(lambda: colours(main, "now") == 0)
            assert colours(main, "done") > 3

    play(scene)


def test_it_is_looked_at_from_every_side_from_near_and_elsewhere(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text(PART)

    async def scene() -> None:
        async with bench(size=(100, 30), program=path, open_program=APART) as b:
            await opened(b)
            toolpath = pane(b).toolpath
            main, below = toolpath.panes

            async def after(key: str) -> list[str]:
                await b.press(key)
                await b.wait(lambda: not toolpath.is_drawing)
                return picture(main)

            whole = picture(main)
            nearer = await after("plus")
            assert nearer != whole
            assert await after("left") != nearer
            await after("minus")
            assert await after("f") == whole
            sides = [(await after("v"))[0][:3].strip() for _ in range(4)]
            assert sides == ["XYZ", "XZ", "YZ", "XY"]
            assert below.side.name == "XZ"
            await b.pilot.resize_terminal(40, 12)
            await b.wait(lambda: not toolpath.is_drawing)
            assert not below.display
            await b.pilot.resize_terminal(20, 5)
            await b.pilot.resize_terminal(200, 60)
            await b.wait(lambda: not toolpath.is_drawing and below.display)
            assert len(picture(main)[0]) == main.size.width
            before = picture(main)
            await b.pilot.mouse_down(main, offset=(20, 10))
            await b.pilot.hover(main, offset=(30, 12))
            await b.pilot.mouse_up(main, offset=(30, 12))
            await b.wait(lambda: not toolpath.is_drawing)
            assert picture(main) != before

    play(scene)


def test_the_dialog_tells_all_and_starts_from_a_line(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text(PART)

    async def scene() -> None:
        async with bench(program=path, open_program=APART) as b:
            await opened(b)
            await b.ask_to_start()
            dialog = b.app.screen
            # Not referenced: it is said, and does not keep it from starting.
            assert dialog.query_one("#problems", OptionList).option_count == 1
            assert not dialog.query_one("#yes", Button).disabled
            dialog.query_one("#from-line", Input).focus()
            await b.type("99")
            await b.press("enter")
            assert isinstance(b.app.screen, StartDialog)
            dialog.query_one("#from-line", Input).value = "6"
            await b.press("enter")
            await b.wait(lambda: isinstance(b.app.screen, WayDialog))
            assert b.moved_steps == (0, 0, 0)
            await b.press("enter")
            await b.wait(lambda: not b.app.busy and b.drawn.job is not None)
            await b.settled()
            assert b.drawn.job is not None
            assert b.drawn.message == ""
            # The frame is driven at the height where it stands, round X and Y.
            await b.ask_to_start()
            await b.pilot.click("#frame")
            await b.wait(lambda: b.drawn.job is not None and b.drawn.job.name == "frame part.nc")
            await b.settled()

    play(scene)


def test_a_file_of_a_million_lines_opens_and_the_app_hears_meanwhile(tmp_path: Path) -> None:
    path = tmp_path / "long.nc"
    path.write_text("G21 G90 F1200\n" + "G1 X1\nG1 X0\n" * 500_000 + "M2\n")

    async def scene() -> None:
        recent = RecentPrograms(tmp_path / "state")
        async with bench(program=path, open_program=APART, recent=recent) as b:
            await b.app.action_show_view("program")
            await b.wait(lambda: pane(b).listing.virtual_size.height == 1_000_002)
            await b.wait(lambda: "checking" in pane(b).progress.texts[0])
            assert "of 1,000,002" in pane(b).progress.texts[1]
            await b.wait(lambda: pane(b).toolpath.scene.way is not None)
            await b.press("escape")
            await b.wait(lambda: "Given up" in b.app.view.said[0])
            assert b.app._programs.look is None
            assert recent.paths() == [path]

    play(scene)


def test_a_file_that_is_opened_again_is_not_read_again(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text(PART)
    read: list[Path] = []

    def reader(path: Path) -> object:
        read.append(path)
        return open_program(path, apart=True)

    async def scene() -> None:
        async with bench(program=path, open_program=reader) as b:
            await opened(b)
            program = b.app._programs.program
            assert isinstance(b.app.view, ProgramView)
            b.app.view.load(path)
            await b.wait(lambda: b.app._programs.look is None)
            await b.settled()
            assert (read, b.app._programs.program) == ([path], program)
            path.write_text(PART + "(more)\n")
            b.app.view.load(path)
            await b.wait(lambda: len(read) == 2)
            await b.settled()

    play(scene)
