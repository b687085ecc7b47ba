"""Height maps in the app: probed, chosen for the program that is open, told before it starts."""

import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from textual.widgets import Input

from fraese.config import Config
from fraese.heightmap.mapfile import PartMap, encoded
from fraese.program.mapped import take_map
from fraese.program.program import open_program
from fraese.ui.dialogs.byhand import ProbeDialog
from fraese.ui.dialogs.open import MapDialog
from fraese.ui.dialogs.start import StartDialog
from fraese.ui.eventlog import Kind
from fraese.ui.newmap import new_map
from fraese.ui.widgets.modal import in_force
from tests.ui.helpers import Bench, bench, play

MAP = PartMap((0.0, 20.0, 40.0), (0.0, 30.0), ((0.0, 0.25, 0.1), (0.5, 0.2, 0.3)))
PART = "G21 G90 F900\nG0 Z2\nG1 X20 Y5\nG1 X30\nM2\n"
#: A board below the tool as the app finds it, in the middle of the travel.
BOARD: dict[str, Any] = {
    "probe": {"pin": 12},
    "simulation": {
        "solids": {
            "board": {
                "x_mm": [0, 290], "y_mm": [0, 190], "top_mm": -30, "corners_mm": [0, 1, 0, 1],
            }
        }
    },
}  # fmt: skip


def _files(folder: Path) -> Path:
    (folder / "board.map").write_text(encoded(MAP), "utf-8")
    path = folder / "part.ngc"
    path.write_text(PART, "utf-8")
    return path


async def _ready(b: Bench) -> None:
    await b.wait(lambda: "Start it" in b.text("#message"))
    await b.settled()


async def _choose(b: Bench, text: str) -> None:
    await b.press("H")
    assert isinstance(b.app.screen, MapDialog)
    b.app.screen.query_one("#file", Input).value = ""
    await b.type(text)
    await b.press("enter")
    await b.settled()


def test_it_is_chosen_told_before_the_start_and_counts(tmp_path: Path) -> None:
    path = _files(tmp_path)

    async def scene() -> None:
        async with bench(program=path, open_program=open_program) as b:
            await _ready(b)
            await _choose(b, str(tmp_path / "board.map"))
            await _ready(b)
            await b.press("s")
            await b.wait(lambda: isinstance(b.app.screen, StartDialog))
            screen = b.app.screen
            assert isinstance(screen, StartDialog)
            assert any(line.text == "board.map, Z0 at X0 Y0" for line in screen._lines)
            await b.press("enter")
            await b.settled()
            assert b.drawn.work_mm == pytest.approx((30, 5, 2 + MAP.whole().at(30, 5)), abs=0.006)
            await _choose(b, "")
            await _ready(b)
            await b.press("s", "enter")
            await b.wait(lambda: b.drawn.work_mm[2] == 2)

    play(scene)


def test_while_it_counts_it_stands_in_the_line_of_what_is_in_force(tmp_path: Path) -> None:
    path = _files(tmp_path)
    path.write_text(PART.replace("M2", "M0\nM2"), "utf-8")

    async def scene() -> None:
        async with bench(program=path, open_program=open_program) as b:
            await _ready(b)
            await _choose(b, str(tmp_path / "board.map"))
            await _ready(b)
            assert "MAP" not in in_force(b.drawn)
            await b.press("s")
            await b.wait(lambda: isinstance(b.app.screen, StartDialog))
            await b.press("enter")
            await b.wait(lambda: bool(b.drawn.question))
            assert b.drawn.job is not None
            assert b.drawn.job.height_map == "board.map"
            assert "MAP" in in_force(b.drawn)

    play(scene)


def _words(b: Bench) -> str:
    program = b.view.desk.programs.program
    return "" if program is None else program.map_words


def test_a_file_keeps_its_map_when_it_is_read_again_and_from_one_day_to_the_next(
    tmp_path: Path,
) -> None:
    path, session = _files(tmp_path), tmp_path / "session.json"

    async def before() -> None:
        async with bench(session=session, program=path, open_program=open_program) as b:
            await _ready(b)
            await _choose(b, str(tmp_path / "board.map"))
            await _ready(b)
            path.write_text(PART.replace("X30", "X31"), "utf-8")
            first = b.view.desk.programs.program
            await b.press("o", "enter")
            await b.wait(lambda: b.view.desk.programs.program is not first)
            await b.settled()
            assert _words(b) == "board.map, Z0 at X0 Y0"

    async def after() -> None:
        async with bench(session=session, open_program=open_program) as b:
            await _ready(b)
            assert _words(b) == "board.map, Z0 at X0 Y0"

    async def gone() -> None:
        async with bench(session=session, open_program=open_program) as b:
            await _ready(b)
            assert _words(b) == ""
            titles = [event.title for event in b.app._events.of(tuple(Kind))]
            assert any("part.ngc is not bent to its height map any more" in t for t in titles)

    play(before)
    play(after)
    (tmp_path / "board.map").unlink()
    play(gone)


@pytest.mark.parametrize(
    ("text", "said"),
    [("nowhere.map", "there is no such file"), ("part.ngc", "is no height map")],
)
def test_what_is_no_map_is_refused_and_the_program_stays_as_it_was(
    tmp_path: Path, text: str, said: str
) -> None:
    path = _files(tmp_path)

    async def scene() -> None:
        async with bench(program=path, open_program=open_program) as b:
            await _ready(b)
            await _choose(b, str(tmp_path / text))
            await b.wait(lambda: said in b.text("#message"))
            program = b.view.desk.programs.program
            assert program is not None
            assert program.map_words == ""

    play(scene)


def test_without_a_program_it_is_refused() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("H")
            assert "No program is loaded" in b.text("#message")

    play(scene)


def test_one_is_probed_and_offered_for_the_program(tmp_path: Path) -> None:
    path = _files(tmp_path)

    async def scene() -> None:
        config = Config.model_validate(BOARD)
        async with bench(program=path, open_program=open_program, config=config) as b:
            await _ready(b)
            await b.press("p")
            assert isinstance(b.app.screen, ProbeDialog)
            await b.press("up")
            assert "height map from the work zero, into part.map" in b.app.screen._cycle.text
            line = b.app.screen.query_one("#line", Input)
            line.value = "x 20 y 10 weight 3"
            await b.press("enter")
            await b.settled()
            assert isinstance(b.app.screen, ProbeDialog)
            assert not (tmp_path / "part.map").exists()
            line.value = "x 20 y 10 every 10"
            await b.press("enter")
            await b.settled()
            await b.wait(lambda: "part.map: X 0 to 20" in b.text("#message"))
            until = time.monotonic() + 10
            while time.monotonic() < until and _missing(tmp_path / "part.map"):
                await b.settled()
            assert take_map(tmp_path / "part.map").heights.x_mm == (0, 10, 20)
            await b.press("H")
            assert isinstance(b.app.screen, MapDialog)
            assert b.app.screen.query_one("#file", Input).value == str(tmp_path / "part.map")

    play(scene)


def _missing(path: Path) -> bool:
    return "null" in path.read_text("utf-8")


def test_a_new_map_takes_no_name_that_is_there(tmp_path: Path) -> None:
    named = partial(new_map, tmp_path / "part.ngc", tmp_path)
    assert named().name == "part.map"
    named().write_text("")
    assert named().name == "part-2.map"
    assert new_map(None, tmp_path) == tmp_path / "board.map"
