"""The app goes on where it was left, and forgets with a word what it cannot read."""

import json
import os
import stat
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual.widgets import Input

from fraese.program.program import open_program
from fraese.ui.dialogs.ask import AskDialog
from fraese.ui.dialogs.form import FormDialog
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.eventlog import Kind
from fraese.ui.linehistory import LineHistory
from fraese.ui.session import Session, SessionFile, keepable, shortened
from fraese.ui.themes import CONTRAST, DARK, LIGHT
from tests.ui.helpers import Bench, bench, play


def events(b: Bench) -> str:
    return "\n".join(event.title for event in b.app._events.of(tuple(Kind)))


def test_view_look_file_and_inputs_are_as_they_were(tmp_path: Path) -> None:
    path, part = tmp_path / "state" / "session.json", tmp_path / "part.ngc"
    part.write_text("G21 G90\nG1 X5 F300\nM2\n")

    async def before() -> None:
        async with bench(session=path, program=part, open_program=open_program) as b:
            await b.wait(lambda: b.app.view.desk.programs.program is not None)
            await b.settled()
            await b.press("t", "t", "g")
            await b.wait(lambda: isinstance(b.app.screen, GoToDialog))
            await b.type("X3")
            await b.press("down", "enter")
            await b.wait(lambda: b.app.screen is b.app.view)
            await b.settled()
            await b.press("f4", "p")
            await b.wait(lambda: isinstance(b.app.screen, FormDialog) and b.app.focused is not None)
            b.app.screen.query_one("#field-way", Input).value = "12"
            await b.press("enter")
            inputs = b.app.view.desk.inputs
            await b.wait(lambda: inputs.get("calibrate steps x way") == "12")
            await b.wait(lambda: isinstance(b.app.screen, AskDialog))
            await b.press("escape")
            await b.settled()
            await b.press("f6")
            await b.wait(lambda: b.app.current_mode == "log")

    async def after() -> None:
        async with bench(session=path, open_program=open_program) as b:
            await b.wait(lambda: b.app.current_mode == "log")
            assert b.app.theme == CONTRAST.name
            await b.wait(lambda: b.app.view.desk.programs.program is not None)
            await b.settled()
            assert b.moved_steps == (0, 0, 0), "opened, and not started"
            assert b.app.view.desk.programs.path == part
            assert b.app.view.desk.inputs["calibrate steps x way"] == "12"
            await b.press("f2", "g")
            await b.wait(lambda: isinstance(b.app.screen, GoToDialog))
            dialog = b.app.screen
            assert isinstance(dialog, GoToDialog)
            assert dialog.line == "X3"
            assert dialog._counted_from.value == "machine zero"

    play(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    play(after)


def test_a_file_that_is_gone_is_a_word_in_the_log_and_its_folder_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "session.json"
    (tmp_path / "parts").mkdir()
    session = Session(file=str(tmp_path / "gone.ngc"), folder=str(tmp_path / "parts"))
    SessionFile(path).keep(session)

    async def scene() -> None:
        async with bench(session=path) as b:
            await b.settled()
            assert "gone.ngc was open the last time, and is not there any more." in events(b)
            assert b.app.view.desk.programs.program is None
            assert b.app.view.desk.programs.folder == tmp_path / "parts"

    play(scene)


def test_what_was_named_at_the_start_comes_before_what_was_open(tmp_path: Path) -> None:
    for name in ("old.ngc", "new.ngc"):
        (tmp_path / name).write_text("M2\n")
    path = tmp_path / "session.json"
    SessionFile(path).keep(Session(file=str(tmp_path / "old.ngc")))

    async def scene() -> None:
        async with bench(
            session=path, program=tmp_path / "new.ngc", open_program=open_program
        ) as b:
            await b.wait(lambda: b.app.view.desk.programs.program is not None)
            assert b.app.view.desk.programs.path == tmp_path / "new.ngc"

    play(scene)


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"", "is damaged"),
        (b"{", "is damaged"),
        (b"\x00\xff" * 500, "is damaged"),
        (b'{"version": 1, "view": 7}', "is damaged"),
        (b'{"version": 1, "colour": "red"}', "is damaged"),
        (b'{"version": 2, "view": "log", "more": []}', "another version"),
    ],
)
def test_what_cannot_be_understood_is_forgotten_with_a_word(
    tmp_path: Path, content: bytes, word: str
) -> None:
    path = tmp_path / "session.json"
    path.write_bytes(content)

    async def scene() -> None:
        async with bench(session=path) as b:
            await b.settled()
            assert word in events(b)
            assert b.app.current_mode == "move"
            assert b.app.theme == DARK.name

    play(scene)
    assert json.loads(path.read_text())["version"] == 1, "the next time it is known again"


def test_a_look_or_view_that_there_is_no_more_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "session.json"
    SessionFile(path).keep(Session(view="kitchen", theme="plaid"))

    async def scene() -> None:
        async with bench(session=path) as b:
            await b.settled()
            assert (b.app.current_mode, b.app.theme) == ("move", DARK.name)

    play(scene)


def test_what_is_no_file_is_never_opened_and_no_failure(tmp_path: Path) -> None:
    pipe = tmp_path / "session.json"
    os.mkfifo(pipe)
    assert "cannot be read" in SessionFile(pipe).word
    folder = SessionFile(tmp_path)
    assert "cannot be read" in folder.word
    folder.keep(Session(view="log"))
    nowhere = SessionFile(Path("/proc/nowhere/session.json"))
    nowhere.keep(Session(view="log"))
    assert nowhere.found == Session()


def test_it_is_kept_while_the_app_runs(tmp_path: Path) -> None:
    path = tmp_path / "session.json"

    async def scene() -> None:
        async with bench(session=path) as b:
            await b.press("t")
            b.app._session.keep_beside(b.app.session())
            await b.wait(path.exists)
            await b.wait(lambda: SessionFile(path).found.theme == LIGHT.name)

    play(scene)


@given(st.dictionaries(st.text(), st.text()))
def test_whatever_was_typed_can_be_kept(inputs: dict[str, str]) -> None:
    kept = Session(inputs=shortened(inputs)).model_dump_json()
    assert Session.model_validate_json(kept).inputs == shortened(inputs)


def test_a_path_that_no_text_holds_is_not_kept() -> None:
    assert keepable(Path(os.fsdecode(b"/tmp/\xff.ngc"))) == ""
    assert keepable(Path("/" + "a" * 5000)) == ""
    assert keepable(Path("/tmp/ä.ngc")) == "/tmp/ä.ngc"
    assert keepable(None) == ""


# --- the lines that were typed -------------------------------------------------------------------


def test_of_a_damaged_history_what_was_typed_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "typed-lines"
    file.write_bytes(b"G1 X5\n\x00\x1b[2J\n\xff\xfe\n" + b"X" * 10_000 + b"\n  X2 Y3 \n")
    assert LineHistory(file).lines == ["G1 X5", "X2 Y3"]


def test_a_history_that_is_a_pipe_or_a_link_is_not_opened(tmp_path: Path) -> None:
    pipe, link, other = tmp_path / "pipe", tmp_path / "link", tmp_path / "other"
    os.mkfifo(pipe)
    assert LineHistory(pipe).lines == []
    other.write_text("secret\n")
    link.symlink_to(other)
    history = LineHistory(link)
    assert history.lines == []
    history.add("X1")
    assert other.read_text() == "secret\n"
    assert LineHistory(link).lines == ["X1"]
    assert stat.S_IMODE(link.stat().st_mode) == 0o600
