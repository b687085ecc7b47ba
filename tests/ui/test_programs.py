"""Program files in the app: what hangs, lies, never ends; and what is checked when it starts."""

import os
import time
from functools import partial
from pathlib import Path

import pytest
from textual.widgets import Button, Input, OptionList

from fraese.config import Config
from fraese.program.program import Program, open_program
from fraese.ui.dialogs.start import StartDialog
from fraese.ui.widgets.path import PathView
from tests.ui.helpers import Bench, bench, play

ENDLESS = "G21 G91 F600\no1 while [1]\nG1 X1\nG1 X-1\no1 endwhile\nM2\n"
APART = partial(open_program, apart=True)
#: References are made by name: no axis has switches.
BARE = Config.model_validate({"axes": {name: {"end_switches": False} for name in "xyz"}})


def opened(b: Bench) -> Program:
    program = b.view.desk.programs.program
    assert isinstance(program, Program)
    return program


async def ready(b: Bench) -> None:
    await b.wait(lambda: "Start it" in b.text("#message"))
    await b.settled()


@pytest.mark.alone
@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
def test_a_look_through_without_end_is_ended_and_the_machine_works_meanwhile(
    tmp_path: Path, key: str
) -> None:
    path = tmp_path / "endless.nc"
    path.write_text(ENDLESS)

    async def scene() -> None:
        async with bench(program=path, open_program=APART) as b:
            await b.wait(lambda: "is being looked through" in b.text("#message"))
            await b.jog("right")
            assert b.moved_steps == (200, 0, 0)
            assert b.view.desk.programs.look is not None
            looker = opened(b)._looker
            assert looker is not None
            await b.wait(lambda: looker._process is not None)
            process = looker._process
            assert process is not None
            before = time.monotonic()
            await b.press(key)
            assert "Given up" in b.text("#message")
            process.wait(1)
            assert time.monotonic() - before < 0.2
            # Nor does it start unseen.
            await b.press("s")
            await b.wait(lambda: "is being looked through" in b.text("#message"))
            await b.press(key)
            await b.settled()
            assert b.moved_steps == (200, 0, 0)
            assert b.view.desk.programs.look is None

    play(scene)


def test_leaving_ends_a_look_through(tmp_path: Path) -> None:
    path = tmp_path / "endless.nc"
    path.write_text(ENDLESS)

    async def scene() -> None:
        async with bench(program=path, open_program=APART) as b:
            await b.wait(lambda: "is being looked through" in b.text("#message"))
            looker = opened(b)._looker
            assert looker is not None
            await b.wait(lambda: looker._process is not None)
            process = looker._process
            assert process is not None
        assert process.returncode is not None

    play(scene)


def test_a_program_is_looked_through_as_the_machine_stands_when_it_starts(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G21 G90 G1 X250 F3000\nM2\n")

    async def scene() -> None:
        async with bench(config=BARE, program=path, open_program=APART) as b:
            await ready(b)
            b.mill.mill.place(0, 2000)
            b.app.link.order_of(lambda controller: controller.home(["x", "y", "z"]))
            await b.settled()
            await b.jog("right", "right")
            await b.press("X")
            await b.settled()
            assert b.drawn.offset_mm[0] == 2
            b.app.link.order_of(lambda controller: controller.move_to({"x": 100}))
            await b.settled()
            await b.press("X")
            await b.settled()
            at = b.moved_steps
            # 102 mm and 250 mm: beyond the end of X.
            for _ in range(2):
                await b.start()
                assert "line 1" in b.text("#message")
                assert "outside" in b.text("#message") or "travel" in b.text("#message")
                assert isinstance(b.app.screen, StartDialog) or b.view.is_active
                await b.press("escape")
                await b.settled()
                assert b.moved_steps == at
            b.app.link.order_of(lambda controller: controller.move_to({"x": -100}))
            await b.settled()
            await b.press("X")
            await b.settled()
            at = b.moved_steps
            await b.start()
            await b.wait(lambda: b.moved_steps[0] == at[0] + 250 * 200)
            await b.settled()

    play(scene)


def test_one_that_was_refused_does_not_start(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G21 G90 G1 X5 F3000\nG1 X[1/0]\nM2\n")

    async def scene() -> None:
        async with bench(program=path, open_program=APART) as b:
            await b.wait(lambda: "line 2" in b.text("#message"))
            await b.jog("up")
            at = b.moved_steps
            await b.ask_to_start()
            assert "line 2" in b.text("#message")
            assert b.app.screen.query_one("#yes", Button).disabled
            # Enter leads to the line, and starts nothing.
            await b.press("enter")
            assert b.view.query_one(PathView).pointed_at == 2
            await b.settled()
            assert b.moved_steps == at

    play(scene)


def test_what_moved_while_it_was_looked_through_is_no_start(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G21 G90 G1 Y5 F3000\nM2\n" + "G4 P0\n" * 10)

    async def scene() -> None:
        async with bench(program=path, open_program=APART) as b:
            await ready(b)
            await b.jog("right")
            program = opened(b)
            look = program.look

            def slow(question: object) -> object:
                facts = look(question)  # type: ignore[arg-type]
                until = time.monotonic() + 60
                while not b.app.link.order_of(lambda controller: controller.jog("x", 1.0)):
                    time.sleep(0.01)
                while b.moved_steps[0] != 400 or b.app.link.busy:
                    assert time.monotonic() < until
                    time.sleep(0.01)
                return facts

            program.look = slow  # type: ignore[method-assign, assignment]
            await b.ask_to_start()
            await b.press("enter")
            await b.wait(lambda: "has changed while" in b.text("#message"))
            await b.settled()
            assert b.moved_steps == (400, 0, 0)
            del program.look
            await b.start()
            await b.wait(lambda: b.moved_steps[1] == 1000)
            await b.settled()

    play(scene)


def test_a_file_that_has_changed_is_told_and_runs_as_it_was_opened(tmp_path: Path) -> None:
    path = tmp_path / "part.nc"
    path.write_text("G21 G90 G1 X5 F3000\nM2\n")

    async def scene() -> None:
        async with bench(program=path, open_program=APART) as b:
            await ready(b)
            path.write_text("G21 G90 G1 X100 F3000\nM2\n")
            await b.ask_to_start()
            said = b.app.screen.query_one("#problems", OptionList).get_option_at_index(1).prompt
            assert "has changed on disk" in str(said)
            assert b.moved_steps == (0, 0, 0)
            await b.press("enter")
            await b.wait(lambda: b.moved_steps == (1000, 0, 0))
            await b.settled()

    play(scene)


def _pipe(path: Path) -> None:
    os.mkfifo(path)


def _folder(path: Path) -> None:
    path.mkdir()


def _binary(path: Path) -> None:
    path.write_bytes(b"G0 X1\n\x7fELF\0\0")


def _endless_line(path: Path) -> None:
    path.write_bytes(b"G0 X1 (" + b"x" * 3_000_000)


def _device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _nothing(path: Path) -> None:
    pass


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (_pipe, "is a pipe or a device"),
        (_device, "is a pipe or a device"),
        (_folder, "is a folder"),
        (_binary, "binary file"),
        (_endless_line, "longer than 4096 characters"),
        (_nothing, "there is no such file"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_what_is_no_program_is_refused_and_the_app_lives(
    tmp_path: Path, make: object, said: str
) -> None:
    make(tmp_path / "part")  # type: ignore[operator]

    async def scene() -> None:
        async with bench(program=tmp_path / "part", open_program=APART) as b:
            await b.wait(lambda: said in b.text("#message"))
            assert b.text("#program") == "no program"
            await b.jog("right")
            assert b.moved_steps == (200, 0, 0)

    play(scene)


@pytest.mark.parametrize(
    "name", ["~nobody-of-this-name/part.nc", "a" * 5000, "nul\0in.it", "\ud800"]
)
def test_any_name_may_be_typed(name: str) -> None:
    async def scene() -> None:
        async with bench(open_program=APART) as b:
            await b.press("o")
            b.app.screen.query_one("#file", Input).value = name
            await b.press("enter")
            await b.wait(lambda: "there is no such file" in b.text("#message"))
            await b.jog("right")
            # Where it was is no place to look for another.
            await b.press("o", "escape")
            assert b.moved_steps == (200, 0, 0)

    play(scene)


def test_a_name_of_any_length_may_be_given_at_the_start() -> None:
    async def scene() -> None:
        async with bench(open_program=APART, program=Path("a" * 5000) / "part.nc") as b:
            await b.wait(lambda: "there is no such file" in b.text("#message"))
            await b.press("o", "escape")
            await b.jog("right")
            assert b.moved_steps == (200, 0, 0)

    play(scene)
