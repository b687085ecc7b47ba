"""Buttons of one's own: shown first, run like a typed line, refused with file and line."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from textual.containers import VerticalScroll
from textual.widgets import Input

from fraese.config.file import load
from fraese.errors import ConfigError
from fraese.ui.dialogs.help import HelpPage
from fraese.ui.dialogs.macro import MacroDialog
from fraese.ui.keyrows import KeyTable
from fraese.ui.keyrows.macros import macro_rows
from fraese.ui.macros import Macro
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.macrowords import few_words
from fraese.ui.widgets.options import Palette
from tests.ui.helpers import Bench, bench, play

MILL = Shape(tuple(AxisShape(name, "mm", 0.005) for name in "xyz"), "half-step")
OUT = Macro("Out", ("G91", "G0 X2"))
HOME = Macro("Quick", ("G91 G0 Y1",), confirm=False)


def table(macros: Sequence[Macro], **keys: str) -> KeyTable:
    given = {name.replace("_", "."): [key] for name, key in keys.items()}
    return KeyTable(MILL, ("move", "program", "log"), given, macros)


async def asked(b: Bench) -> MacroDialog:
    await b.wait(lambda: isinstance(b.app.screen, MacroDialog) and b.app.focused is not None)
    dialog = b.app.screen
    assert isinstance(dialog, MacroDialog)
    return dialog


def test_a_macro_is_shown_first_and_runs_with_a_second_key() -> None:
    async def scene() -> None:
        macros = (OUT, HOME)
        async with bench(macros=macros, keys=table(macros, macros_0_key="f9")) as b:
            await b.settled()
            await b.press("f9")
            dialog = await asked(b)
            assert dialog.query_one("#macro-lines").text == "G91\nG0 X2"  # type: ignore[attr-defined]
            assert b.moved_steps == (0, 0, 0)
            await b.press("escape")
            await b.settled()
            assert b.moved_steps == (0, 0, 0)
            await b.press("f9")
            await asked(b)
            await b.press("enter")
            await b.wait(lambda: b.moved_steps == (400, 0, 0))

    play(scene)


def test_one_that_needs_no_second_key_is_clicked() -> None:
    async def scene() -> None:
        macros = (OUT, HOME)
        async with bench(macros=macros, keys=table(macros), size=(120, 40)) as b:
            await b.settled()
            links = list(b.view.query("#macros .link"))
            assert len(links) == 2
            await b.pilot.click(links[1])
            await b.wait(lambda: b.moved_steps == (0, 200, 0))

    play(scene)


def test_where_there_is_no_room_for_them_the_position_stays_whole() -> None:
    async def scene() -> None:
        macros = (OUT, HOME)
        async with bench(macros=macros, keys=table(macros, macros_0_key="f9")) as b:
            await b.settled()
            assert not b.view.query_one("#macros").display
            # But it is seen that there are some, and what runs them.
            assert "macros F9 Out  Quick  … Ctrl+P" in drawn(b)
            position = b.view.query_one("#body").region
            assert position.height >= 9, "three axes of three rows"
            await b.press("f9")
            await asked(b)

    play(scene)


def test_what_cannot_run_is_refused_with_its_line_and_nothing_moves() -> None:
    async def scene() -> None:
        macros = (Macro("Bad", ("G0 X1", "G123"), confirm=False),)
        async with bench(macros=macros, keys=table(macros, macros_0_key="f9")) as b:
            await b.settled()
            await b.press("f9")
            await b.wait(lambda: "macro Bad.ngc, line 2" in b.view.said[0])
            assert b.moved_steps == (0, 0, 0)

    play(scene)


def test_a_file_is_read_when_it_is_run_and_refused_with_its_name(tmp_path: Path) -> None:
    async def scene() -> None:
        file = tmp_path / "probe.ngc"
        macros = (Macro("File", file=str(file), confirm=False),)
        async with bench(macros=macros, keys=table(macros, macros_0_key="f9")) as b:
            await b.settled()
            await b.press("f9")
            await b.wait(lambda: f"{file}: there is no such file" in b.view.said[0])
            file.write_text("G91\nG0 X1\nG0 Y5000\n")
            await b.press("f9")
            await b.wait(lambda: "line 3" in b.view.said[0])
            assert b.moved_steps == (0, 0, 0)
            file.write_text("G91\nG0 X1\n")
            await b.press("f9")
            await b.wait(lambda: b.moved_steps == (200, 0, 0))
            file.write_text("G0 X1\n" + "(long)\n" * 20_000)
            await b.settled()
            await b.press("f9")
            await b.wait(lambda: "is too long for a macro: open it instead" in b.view.said[0])

    play(scene)


def test_not_while_the_machine_runs() -> None:
    async def scene() -> None:
        macros = (HOME,)
        async with bench(macros=macros, keys=table(macros, macros_0_key="f9"), clock="paced") as b:
            await b.long_move()
            await b.press("f9")
            await b.wait(lambda: "The machine runs" in b.view.said[0])
            await b.press("escape")
            await b.wait(lambda: not b.app.link.moving)

    play(scene)


def test_its_key_must_be_free() -> None:
    with pytest.raises(ConfigError, match=r"macros\.0\.key: o is the key of open_program already"):
        table((OUT,), macros_0_key="o")
    with pytest.raises(ConfigError, match=r"macros\.0\.key: escape always stops"):
        table((OUT,), macros_0_key="escape")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('name = "A"', "macros.0: a macro has either lines or a file"),
        ('name = "A"\nlines = "G0 X1"\nfile = "/a.ngc"', "a macro has either lines or a file"),
        ('name = "A/B"\nlines = "G0 X1"', "macros.0.name: must be 1 to 24 characters"),
        ('name = "A"\nfile = "a.ngc"', "macros.0.file: "),
        ('lines = "G0 X1"', "macros.0.name: must be given"),
        ('name = "A"\nlines = "G0 X1"\ncolour = 1', "unknown key macros.0.colour"),
    ],
)
def test_what_is_wrong_in_the_file_is_said_in_a_sentence(
    tmp_path: Path, text: str, sentence: str
) -> None:
    path = tmp_path / "fraese.toml"
    path.write_text(f"[[macros]]\n{text}\n")
    with pytest.raises(ConfigError) as refused:
        load(path)
    assert sentence in str(refused.value)


def test_lines_are_a_list_or_a_text(tmp_path: Path) -> None:
    path = tmp_path / "fraese.toml"
    path.write_text(
        '[[macros]]\nname = "A"\nlines = """\nG91\nG0 X1"""\n'
        '[[macros]]\nname = "B"\nkey = "f9"\nlines = ["G91", "G0 X1"]\n'
    )
    first, second = load(path).macros
    assert first.lines == second.lines == ("G91", "G0 X1")
    assert (first.key, second.key) == (None, ("f9",))


def drawn(b: Bench) -> str:
    lines = b.app.screen._compositor.render_strips()
    return "\n".join("".join(segment.text for segment in strip) for strip in lines)


def test_names_and_lines_with_brackets_are_shown_as_they_are() -> None:
    """On the button, in the help and in the palette."""
    names = ("[x]", "[red]Up", "a [b", "[#1")
    macros = [Macro(name, ("G91", "G0 X[1+[2]]", "(see [/b])"), confirm=False) for name in names]

    async def scene() -> None:
        async with bench(macros=macros, keys=table(macros), size=(120, 40)) as b:
            await b.settled()
            assert all(name in drawn(b) for name in names)
            await b.press("f1")
            await b.wait(lambda: isinstance(b.app.screen, HelpPage))
            await b.pilot.pause()
            shown = ""
            for _ in range(12):
                shown += drawn(b)
                b.app.screen.query_one(VerticalScroll).scroll_page_down(animate=False)
                await b.pilot.pause()
            assert all(f"{name}: Run G91 G0 X[1+[2]] (see [/b])." in shown for name in names)
            await b.press("escape", "ctrl+p")
            await b.wait(lambda: isinstance(b.app.screen, Palette))
            for name in ("[x]", "[red]Up"):
                b.app.screen.query_one(Input).value = name
                await b.wait(lambda: name in drawn(b).split("\n", 6)[-1])  # noqa: B023
                assert "Run G91 G0 X[1+[2]] (see [/b])." in drawn(b)

    play(scene)


def test_of_many_macros_as_many_as_fit_are_named() -> None:
    rows = macro_rows([Macro(f"Number {n}") for n in range(9)])
    text = few_words(rows, "Ctrl+P", room=30)
    assert text == "Number 0  Number 1  … Ctrl+P"
    assert few_words(rows, "Ctrl+P", room=8) == "… Ctrl+P"
