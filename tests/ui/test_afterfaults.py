"""What a fault has left, in the app: a program that was cut short, a position in doubt."""

import asyncio
import signal
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from textual.app import ComposeResult
from textual.containers import VerticalScroll

from fraese.assembly import Plant, assemble
from fraese.config import Config
from fraese.control.controller import Controller
from fraese.control.position import Doubt
from fraese.errors import Cancelled
from fraese.program.kept import KeptPrograms
from fraese.program.program import open_program
from fraese.program.resumption import Resumption
from fraese.ui import FraeseApp
from fraese.ui.dialogs.crash import CrashDialog
from fraese.ui.dialogs.reference import ReferenceDialog
from fraese.ui.dialogs.resume import ResumeDialog
from fraese.ui.views.machine import MachineView
from fraese.ui.widgets.fact import Fact
from tests.helpers import after_slices, carriages, configured
from tests.ui.helpers import Bench, bench, open_nothing, play

PART = (
    "G21 G90 F900\nM3 S500\nG0 Z-1\nG1 X12\nO1 REPEAT [4]\nG1 X2 (to)\nG1 X12 (fro)\nO1 ENDREPEAT\n"
    "G1 X5 Y4\nM2\n"
)
SPINDLE = configured(outputs={"spindle": {"pin": 14}}, run={"spin_up_s": 2})


def keeping(folder: Path) -> dict[str, Any]:
    """Options of an app that keeps what it runs."""
    kept = KeptPrograms(folder / "state")
    return {
        "open_program": partial(open_program, kept=kept),
        "resume": partial(Resumption.of, kept=kept),
        "config": SPINDLE,
    }


def reference(plant: Plant) -> None:
    """Let the axes be referenced where they stand."""
    for name in "xyz":
        plant.controller.position.set_reference(name, 0)


async def cut_short(b: Bench, path: Path, slices: int = 80) -> None:
    """A program runs, and is stopped in the middle."""
    path.write_text(PART)
    b.view.load(path)
    await b.wait(lambda: "Start it" in b.text("#message"))
    after_slices(b.plant.controller, slices, b.plant.controller.cancel)
    await b.start()
    await b.wait(lambda: b.drawn.cut_short is not None)
    await b.settled()
    b.plant.controller.set_break_key(lambda: None)


async def asked(b: Bench) -> ResumeDialog:
    await b.press("u")
    await b.wait(lambda: isinstance(b.app.screen, ResumeDialog))
    dialog = b.app.screen
    assert isinstance(dialog, ResumeDialog)
    await b.wait(lambda: dialog._way is not None)
    await b.pilot.pause()
    return dialog


def shown(dialog: ResumeDialog) -> list[str]:
    return [fact.text for fact in dialog.query(Fact)]


def test_what_was_stopped_is_shown_and_gone_on_with(tmp_path: Path) -> None:
    whole = assemble(SPINDLE)
    reference(whole)
    (tmp_path / "part.ngc").write_text(PART)
    open_program(tmp_path / "part.ngc").start(whole.controller)
    whole.controller.run()

    async def scene() -> None:
        async with bench(**keeping(tmp_path)) as b:
            reference(b.plant)
            await cut_short(b, tmp_path / "part.ngc")
            cut = b.drawn.cut_short
            assert cut is not None
            notices = [notice.message for notice in b.app._notifications]
            offer = "u goes on with it, L lifts the tool."
            assert f"part.ngc was cut short in line {cut.line}: {offer}" in notices
            dialog = await asked(b)
            said = shown(dialog)
            assert f"part.ngc was cut short in line {cut.line}:" in said
            assert PART.splitlines()[cut.line - 1] in said
            text = "\n".join(said)
            assert "feed 900 mm/min" in text
            assert "Safe height: Z 0.000 mm (machine)." in text
            assert "spindle on, 500 rev/min; wait 2 s for it" in text
            assert "-1.000 mm (machine)" in said[-3]
            await b.press("enter")
            await b.wait(lambda: b.drawn.cut_short is None)
            await b.settled()
            assert carriages(b.plant) == carriages(whole)
            assert b.text("#program") == "part.ngc"
            assert b.view.picture == "path"
            # It is over, and there is nothing to go on with.
            await b.press("u")
            await b.wait(lambda: "nothing to go on with" in b.text("#message"))

    play(scene)


def test_some_moves_back_and_what_has_changed_since(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench(**keeping(tmp_path)) as b:
            path = tmp_path / "part.ngc"
            await cut_short(b, path)
            path.write_text(PART.replace("Y4", "Y9"))
            b.app.link.zero(("x",), "u")
            await b.settled()
            dialog = await asked(b)
            moves = dialog._resumption.moves
            assert any("has changed on disk" in text for text in shown(dialog))
            assert any("Work offsets were changed since: they count." in t for t in shown(dialog))
            assert any(text.endswith("(work)") for text in shown(dialog))
            for key, back in (("up", 1), ("up", 2), ("down", 1), ("left", moves), ("right", 0)):
                await b.press(key)
                await b.wait(lambda: dialog._way is not None)
                assert dialog._moves_back == back
            await b.press("up")
            await b.wait(lambda: "1 move before it was cut short" in dialog._cut_short.text)
            await b.press("escape")
            assert not isinstance(b.app.screen, ResumeDialog)
            assert b.drawn.cut_short is not None

    play(scene)


def empty(folder: Path, _b: Bench) -> None:
    for path in (folder / "state" / "jobs").iterdir():
        path.unlink()


def in_doubt(_folder: Path, b: Bench) -> None:
    b.plant.controller.position.doubt = Doubt("the program ended while the machine moved")


def referenced(_folder: Path, b: Bench) -> None:
    b.plant.controller.position.set_reference("x", 0)


def on_a_switch(_folder: Path, b: Bench) -> None:
    b.hand("ymax", True)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (empty, "the kept copy of this program is gone or damaged"),
        (in_doubt, "The position is not trusted: the program ended while the machine moved"),
        (referenced, "was run with axis X not referenced, and the reference since"),
        (on_a_switch, "witch"),
    ],
)
def test_it_is_refused_with_the_same_sentence_as_the_command(
    tmp_path: Path, change: Callable[[Path, Bench], None], sentence: str
) -> None:
    async def scene() -> None:
        async with bench(**keeping(tmp_path)) as b:
            await cut_short(b, tmp_path / "part.ngc")
            at = b.moved_steps
            change(tmp_path, b)
            await b.wait(lambda: b.drawn == b.plant.controller.state())
            await b.press("u")
            await b.wait(lambda: sentence in b.text("#message"))
            assert b.app.screen is b.view
            assert b.moved_steps == at

    play(scene)


class Endless:
    """It is read for as long as somebody wants to know."""

    name, moves, news = "endless.nc", 5, tuple

    def __init__(self, path: Path) -> None:
        path.write_text("M2\n")
        self.path, self.program = path, open_program(path)
        self.ended = threading.Event()

    def way(self, back: int, given_up: Callable[[], bool]) -> Any:
        while not given_up():
            self.ended.wait(0.01)
        self.ended.set()
        raise Cancelled("Given up; nothing has moved.")

    def start(self, controller: Controller, back: int) -> None:
        raise AssertionError


def test_a_place_that_is_far_down_is_waited_for_and_given_up(tmp_path: Path) -> None:
    endless = Endless(tmp_path / "endless.nc")

    async def scene() -> None:
        async with bench(resume=lambda controller: endless) as b:
            await b.press("u")
            await b.wait(lambda: isinstance(b.app.screen, ResumeDialog))
            said = b.app.screen.query(".one-line").first(Fact).text
            assert "is being read as far as the place" in said
            await b.press("enter")
            assert isinstance(b.app.screen, ResumeDialog)
            assert not endless.ended.is_set()
            await b.press("escape")
            await b.wait(lambda: not isinstance(b.app.screen, ResumeDialog))
            await b.wait(endless.ended.is_set)

    play(scene)


def test_at_the_smallest_size_all_of_it_can_be_read(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench(**keeping(tmp_path)) as b:
            await cut_short(b, tmp_path / "part.ngc")
            (tmp_path / "part.ngc").unlink()
            b.app.link.zero(("x", "y", "z"), "u")
            await b.settled()
            dialog = await asked(b)
            assert dialog.query_one(".hint").region.bottom <= 24
            way = dialog.query_one("#way", VerticalScroll)
            last = list(dialog.query(".leg"))[-1]
            await b.press("pagedown")
            await b.pilot.pause()
            assert last.region.bottom <= way.region.bottom

    play(scene)


# --- position ------------------------------------------------------------------------------------


def crashed(b: Bench, above: int) -> None:
    """As after a crash in motion, by so many half-steps."""
    where = b.plant.controller.position
    where.turn_steps, where.referenced = (8, 8, 8), (False,) * 3
    spans = ((0, above), (0, 0), (0, 0))
    where.doubt = Doubt("the program ended while the machine moved", spans, (True, True, False))


def test_near_its_place_the_position_is_taken_as_it_was_left() -> None:
    async def scene() -> None:
        async with bench() as b:
            crashed(b, 3)
            await b.press("k")
            await b.wait(lambda: isinstance(b.app.screen, CrashDialog))
            text = "\n".join(fact.text for fact in b.app.screen.query(Fact))
            assert "between X 0.000 and 0.015" in text
            assert "pushed by X 0.020 Y 0.020 Z 0.020 mm or more" in text
            await b.press("l")
            await b.wait(lambda: b.drawn.referenced == (True, True, False))
            assert "as it was left" in b.text("#message")
            await b.press("k")
            await b.wait(lambda: "No crash has put the position in doubt" in b.text("#message"))

    play(scene)


def test_further_away_only_a_reference_helps() -> None:
    async def scene() -> None:
        async with bench() as b:
            crashed(b, 40)
            await b.press("k")
            await b.wait(lambda: isinstance(b.app.screen, CrashDialog))
            assert "as it was left" not in b.app.screen.query_one(".hint", Fact).text
            await b.press("l")
            assert isinstance(b.app.screen, CrashDialog)
            await b.press("enter")
            await b.wait(lambda: isinstance(b.app.screen, ReferenceDialog))
            assert b.drawn.referenced == (False, False, False)

    play(scene)


def test_to_decide_later_leaves_it_as_it_is() -> None:
    async def scene() -> None:
        async with bench() as b:
            crashed(b, 0)
            await b.press("k")
            await b.wait(lambda: isinstance(b.app.screen, CrashDialog))
            await b.press("escape")
            assert b.app.screen is b.view
            assert "not trusted" in b.text("#message")
            assert b.plant.controller.position.doubt is not None

    play(scene)


# --- the way out ---------------------------------------------------------------------------------


def test_a_signal_while_the_first_screen_is_made_ends_the_app_as_any_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    compose = MachineView.compose

    def signalled(view: MachineView) -> ComposeResult:
        app = view.app
        assert isinstance(app, FraeseApp)
        app._leave_by_signal(signal.SIGTERM)
        yield from compose(view)

    monkeypatch.setattr(MachineView, "compose", signalled)
    app = FraeseApp(assemble(Config()).controller, open_program=open_nothing)
    asyncio.run(app.run_async(headless=True, size=(80, 24)))
    assert app.exit_code == 128 + signal.SIGTERM
