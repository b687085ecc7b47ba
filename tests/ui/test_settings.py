"""The view Settings: every key, typed and checked; what counts at once does."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from textual.widgets import Input

from fraese.assembly import assemble
from fraese.cli.appsettings import AppSettings
from fraese.config import Config
from fraese.config.file import load
from fraese.ui.dialogs.confirm import ConfirmDialog
from fraese.ui.dialogs.form import FormDialog
from fraese.ui.dialogs.setting import SettingDialog
from fraese.ui.views.settings import SettingsView
from fraese.ui.widgets.fact import Fact
from tests.ui.helpers import Bench, bench, play

TEXT = "# mine\n[jog]\nfeed_mm_min = 500  # calm\n"


@asynccontextmanager
async def opened(
    path: Path, text: str | None = TEXT, **options: Any
) -> AsyncIterator[tuple[Bench, SettingsView]]:
    """The view, of a machine that was made of this file."""
    if text is not None:
        path.write_text(text)
    controller = assemble(Config()).controller
    async with bench(settings=AppSettings(path, controller), **options) as b:
        await b.settled()
        await b.press("f7")
        await b.wait(lambda: isinstance(b.app.view, SettingsView) and b.app.view.is_mounted)
        view = b.app.view
        assert isinstance(view, SettingsView)
        await b.pilot.pause()
        yield b, view
    controller.close()


async def find(b: Bench, word: str) -> None:
    """See only keys with this word."""
    await b.press("f")
    await b.wait(lambda: isinstance(b.app.screen, FormDialog) and b.app.focused is not None)
    await b.type(word)
    await b.press("enter")
    await b.wait(lambda: b.app.screen is b.app.view)


async def edit(b: Bench, text: str, *keys: str) -> SettingDialog:
    """Type this instead of what is there."""
    await b.press("e")
    await b.wait(lambda: isinstance(b.app.screen, SettingDialog) and b.app.focused is not None)
    dialog = b.app.screen
    assert isinstance(dialog, SettingDialog)
    dialog.query_one("#value", Input).value = ""
    await b.type(text)
    await b.press(*keys)
    return dialog


def heading(view: SettingsView) -> str:
    return view.query_one("#settings-heading", Fact).text


def detail(view: SettingsView) -> str:
    return view.query_one("#settings-detail", Fact).text


def test_a_key_that_counts_at_once_does(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            assert heading(view).startswith(f"{path} · ")
            assert heading(view).endswith("keys, 1 not as by default")
            await find(b, "jog.max_mm")
            assert "Longest single jog, mm." in detail(view)
            assert "Above 0; by default 50; counts at once." in detail(view)
            await edit(b, "70", "enter")
            await b.wait(lambda: b.app.screen is view)
            await b.wait(lambda: "jog.max_mm is 70 now" in view.said[0])
            assert b.plant.controller.config.jog.max_mm == 70
            assert path.read_text().startswith(TEXT.rstrip())

    play(scene)


def test_a_key_of_the_machine_waits_for_the_next_start(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            await find(b, "axes.x.pitch_mm")
            assert "counts from the next start" in detail(view)
            await edit(b, "2,5", "enter")
            await b.wait(lambda: "axes.x.pitch_mm is 2.5, from the next start on" in view.said[0])
            assert b.plant.controller.machine.axes[0].steps_per_mm == 200
            assert float(load(path).axes.table["x"].pitch) == 2.5

    play(scene)


def test_what_is_typed_is_checked_while_it_is_typed(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            await find(b, "jog.feed_mm_min")
            dialog = await edit(b, "-3")

            def complaint() -> str:
                return dialog.query_one("#complaint", Fact).text

            await b.wait(lambda: "must be greater than 0, not -3" in complaint())
            await b.press("enter")
            assert b.app.screen is dialog
            assert path.read_text() == TEXT
            dialog.query_one("#value", Input).value = "450"
            await b.wait(lambda: not complaint())
            await b.press("escape")
            await b.wait(lambda: b.app.screen is view)
            assert path.read_text() == TEXT

    play(scene)


def test_choices_are_offered(tmp_path: Path) -> None:
    async def scene() -> None:
        async with opened(tmp_path / "fraese.toml") as (b, view):
            await find(b, "card.kind")
            assert "one of smc1500, stepdir" in detail(view).lower()
            dialog = await edit(b, "smc1500", "down")
            assert dialog.typed == "stepdir"
            await b.press("down")
            assert dialog.typed == "smc1500"
            await b.press("escape")

    play(scene)


def test_a_key_is_taken_out_after_a_question(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            await find(b, "jog.")
            await b.press("d")
            await b.wait(lambda: isinstance(b.app.screen, ConfirmDialog))
            await b.press("enter")
            await b.wait(lambda: "jog.feed_mm_min is 600 now" in view.said[0])
            assert path.read_text() == "# mine\n[jog]\n"
            await b.press("down", "d")
            await b.wait(lambda: "is by default already" in view.said[0])

    play(scene)


def test_the_file_that_somebody_else_has_changed_is_looked_at_again(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            await find(b, "jog.max_mm")
            dialog = await edit(b, "70")
            path.write_text(TEXT + "[log]\nenabled = true\n")
            await b.press("enter")
            complaint = dialog.query_one("#complaint", Fact)
            await b.wait(lambda: "changed by somebody else meanwhile" in complaint.text)
            assert dialog.typed == "70", "nothing that was typed is lost"
            await b.press("enter")
            await b.wait(lambda: "jog.max_mm is 70 now" in view.said[0])
            assert "enabled = true" in path.read_text()

    play(scene)


def test_a_file_that_cannot_be_read_or_written_is_a_sentence(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            path.chmod(0o444)
            await find(b, "jog.max_mm")
            dialog = await edit(b, "70", "enter")
            complaint = dialog.query_one("#complaint", Fact)
            await b.wait(lambda: "is write-protected" in complaint.text)
            await b.press("escape")
            path.chmod(0o644)
            path.write_text("[jog\n")
            await b.press("f2", "f7")
            await b.wait(lambda: "is not valid TOML" in view.said[0])
            await b.press("e", "d", "down", "right")
            assert b.app.screen is view
            path.write_text(TEXT)
            await b.press("f2", "f7")
            await b.wait(lambda: "1 not as by default" in heading(view))

    play(scene)


def test_without_a_file_it_is_said_where_it_will_be_made(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        path.write_text("")
        async with opened(path, None) as (b, view):
            path.unlink()
            await b.press("f2", "f7")
            await b.wait(lambda: "fraese.toml (made when needed)" in heading(view))
            await find(b, "jog.max_mm")
            await edit(b, "70", "enter")
            await b.wait(path.exists)

    play(scene)


def test_what_counts_at_once_is_not_changed_under_a_job(tmp_path: Path) -> None:
    async def scene() -> None:
        async with opened(tmp_path / "fraese.toml", clock="paced") as (b, view):
            await b.long_move()
            await find(b, "jog.max_mm")
            await b.press("e")
            await b.wait(lambda: "The machine runs" in view.said[0])
            assert b.app.screen is view
            await find(b, "axes.x.pitch")
            await edit(b, "3", "enter")
            await b.wait(lambda: "from the next start on" in view.said[0])
            assert b.app.link.moving
            await b.press("escape")
            await b.wait(lambda: not b.app.link.moving)

    play(scene)


def test_keys_of_the_app_are_settings_and_are_checked(tmp_path: Path) -> None:
    async def scene() -> None:
        path = tmp_path / "fraese.toml"
        async with opened(path) as (b, view):
            await find(b, "keys.go_to ")
            dialog = await edit(b, "escape", "enter")
            complaint = dialog.query_one("#complaint", Fact)
            await b.wait(lambda: "escape always stops" in complaint.text)
            dialog.query_one("#value", Input).value = "f8"
            await b.press("enter")
            await b.wait(lambda: "keys.go_to is" in view.said[0])
            assert load(path).keys == {"go_to": ("f8",)}

    play(scene)


def test_a_new_tool_is_added_by_its_name(tmp_path: Path) -> None:
    async def scene() -> None:
        async with opened(tmp_path / "fraese.toml") as (b, view):
            await b.press("a")
            await b.wait(lambda: isinstance(b.app.screen, FormDialog) and b.app.focused is not None)
            await b.type("tools.3.length_mm")
            await b.press("enter")
            await b.wait(
                lambda: isinstance(b.app.screen, SettingDialog) and b.app.focused is not None
            )
            await b.type("12.5")
            await b.press("enter")
            await b.wait(lambda: "tools.3.length_mm is 12.5 now" in view.said[0])
            assert b.plant.controller.config.tools["3"].length_mm == 12.5

    play(scene)


def test_tables_and_keys_are_walked_through_and_clicked(tmp_path: Path) -> None:
    async def scene() -> None:
        async with opened(tmp_path / "fraese.toml", size=(200, 60)) as (b, view):
            await b.press("right", "right")
            assert detail(view).startswith("axes.x.")
            await b.press("left", "up", "up", "pageup")
            assert detail(view).startswith("language = ")
            for _ in range(60):
                await b.press("pagedown")
            last = detail(view)
            await b.press("down")
            assert detail(view) == last
            await b.pilot.click("#settings-list", offset=(10, 3))
            assert detail(view) != last

    play(scene)
