"""The dialog of the tool table."""

from pathlib import Path

from fraese.config import Config
from fraese.config.edit import FileWriter
from fraese.config.file import load
from fraese.ui.dialogs.tables import ToolsDialog
from fraese.ui.widgets.fact import Fact
from tests.ui.helpers import Bench, bench, play
from tests.ui.test_byhand import complaint, enter

TABLE = "# my tools\n[tools.1] # the short one\nlength_mm = 3\ndiameter_mm = 6\n"


def shown(b: Bench) -> str:
    assert isinstance(b.app.screen, ToolsDialog)
    return b.app.screen.query_one("#tools", Fact).text


def test_tools_are_shown_changed_cleared_and_kept(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    path.write_text(TABLE)

    async def scene() -> None:
        async with bench(config=load(path), writer=FileWriter(path)) as b:
            await b.press("T")
            await b.wait(lambda: "T1     3.000     6.000" in shown(b))
            assert str(path)[:10] in shown(b)
            await enter(b, "T2 L12,5 D3 end mill")
            await b.wait(lambda: "T2    12.500     3.000  end mill" in shown(b))
            await enter(b, "1 d8")
            await b.wait(lambda: "T1     3.000     8.000" in shown(b))
            await enter(b, "t2 -")
            await b.wait(lambda: "end mill" not in shown(b))
            await enter(b, "T1")
            dialog = b.app.screen
            assert isinstance(dialog, ToolsDialog)
            await b.wait(lambda: dialog.line == "T1 L3 D8")
            dialog.put("")
            await enter(b, "t1 clear")
            await b.wait(lambda: "T1" not in shown(b))
            for wrong, sentence in (
                ("three", "as in T3 L12.5"),
                ("T3 D-1", "not negative"),
                ("T9 clear", "no tool 9"),
                ("T0 L1", "numbered from 1"),
            ):
                await enter(b, wrong)
                await b.wait(lambda sentence=sentence: sentence in complaint(b))  # type: ignore[misc]
                dialog.put("")
            assert load(path).tools["2"].length_mm == 12.5
            assert "# my tools" in path.read_text()
            assert "1" not in load(path).tools

    play(scene)


def test_a_file_that_cannot_be_written_changes_nothing(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    path.write_text(TABLE)

    async def scene() -> None:
        async with bench(config=load(path), writer=FileWriter(path)) as b:
            await b.press("T")
            await b.wait(lambda: "T1" in shown(b))
            path.write_text("[[[")
            await enter(b, "T1 L9")
            await b.wait(lambda: "cannot be changed" in complaint(b))
            assert "T1     3.000" in shown(b)
            assert b.plant.controller.config.tools["1"].length_mm == 3

    play(scene)


def test_without_a_file_the_table_lasts_until_the_end() -> None:
    async def scene() -> None:
        async with bench(config=Config()) as b:
            await b.press("T")
            await b.wait(lambda: "table is empty" in shown(b))
            assert "until fraese ends" in shown(b)
            await enter(b, "T4 L1")
            await b.wait(lambda: "T4     1.000     0.000" in shown(b))

    play(scene)
