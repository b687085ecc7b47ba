"""Programs, pages, pictures, sizes and themes."""

from pathlib import Path

import pytest
from textual.widgets import Button, DirectoryTree

from fraese.config import Config
from fraese.control.jobs import Ask, Job
from fraese.control.state import Status
from fraese.ui.dialogs.ask import AskDialog
from fraese.ui.dialogs.open import OpenDialog
from fraese.ui.dialogs.switches import SwitchPage
from fraese.ui.views.machine import PICTURES, MachineView
from fraese.ui.widgets.links import Link
from fraese.ui.widgets.path import PathView
from fraese.ui.widgets.programpane import ProgramPane
from fraese.ui.widgets.toolpath import Toolpath
from tests.ui.helpers import Bench, FakeFacts, FakeProgram, bench, play


def test_a_program_is_opened_shown_and_run() -> None:
    async def scene() -> None:
        program = FakeProgram(
            [f"G1 X{n % 2}" for n in range(1, 61)],
            distance_mm=0.25,
            facts=FakeFacts(warnings=("The machine is not referenced: half feed.",)),
        )
        asked: list[Path] = []

        def open_program(path: Path) -> FakeProgram:
            asked.append(path)
            return program

        async with bench(clock="paced", open_program=open_program) as b:
            await b.press("s")
            assert "No program is loaded" in b.text("#message")
            await b.press("o")
            assert isinstance(b.app.screen, OpenDialog)
            await b.type("parts/fake.nc")
            await b.press("enter")
            await b.wait(lambda: "Start it with s" in b.text("#message"))
            assert asked == [Path("parts/fake.nc")]
            assert "4 blocks, 4.0 mm, 0:02 min" in b.text("#message")
            assert b.app.screen.has_class("path")
            await b.start()
            path = b.app.screen.query_one(PathView)
            await b.wait(lambda: path.current > 20)
            assert path.scroll_offset.y > 0
            assert "line" in b.text("#job")
            assert "%" in b.text("#job")
            assert b.text("#word") == "MOVING"
            await b.settled()
            assert b.text("#word") == "NOT REFERENCED"
            assert program.started == 1
            assert b.moved_steps == (0, 0, 0)
            assert b.text("#job") == ""

    play(scene)


def test_a_file_that_cannot_be_read_is_said() -> None:
    async def scene() -> None:
        async with bench(program=Path("nothing.nc")) as b:
            await b.wait(lambda: "nothing.nc: cannot be read" in b.text("#message"))
            assert b.text("#program") == "no program"

    play(scene)


def test_a_reader_that_fails_does_not_end_the_app() -> None:
    def fails(path: Path) -> FakeProgram:
        raise ZeroDivisionError("oops")

    async def scene() -> None:
        async with bench(program=Path("odd.nc"), open_program=fails) as b:
            await b.wait(lambda: "odd.nc: the reader failed" in b.text("#message"))
            await b.jog("right")
            assert b.moved_steps == (200, 0, 0)

    play(scene)


def test_a_file_is_chosen_from_the_tree(tmp_path: Path) -> None:
    async def scene() -> None:
        (tmp_path / "a.nc").write_text("G0 X1\n")
        (tmp_path / ".hidden").write_text("")
        chosen: list[Path] = []

        def open_program(path: Path) -> FakeProgram:
            chosen.append(path)
            return FakeProgram(["G0 X1"])

        async with bench(program=tmp_path / "none.nc", open_program=open_program) as b:
            await b.wait(lambda: len(chosen) == 1)
            await b.settled()
            await b.press("o", "tab")
            tree = b.app.screen.query_one(DirectoryTree)
            await b.wait(lambda: len(tree.root.children) == 1)
            await b.press("down", "enter")
            await b.wait(lambda: len(chosen) == 2)
            assert chosen[1] == tmp_path / "a.nc"
            await b.settled()

    play(scene)


def test_a_question_of_the_job_is_asked() -> None:
    async def scene() -> None:
        async with bench() as b:
            done: list[int] = []

            def job() -> Job:
                yield Ask("Change the tool, then go on.")
                done.append(1)

            b.app.link.order(lambda: b.plant.controller.start("tool change", job()))
            await b.wait(lambda: isinstance(b.app.screen, AskDialog))
            assert b.text("#word") == "WAIT"
            await b.press("enter")
            await b.settled()
            assert done == [1]
            assert not isinstance(b.app.screen, AskDialog)
            b.app.link.order(lambda: b.plant.controller.start("tool change", job()))
            await b.wait(lambda: isinstance(b.app.screen, AskDialog))
            await b.press("escape")
            await b.settled()
            assert done == [1]
            assert not isinstance(b.app.screen, AskDialog)
            assert b.plant.controller.status is Status.OK

    play(scene)


def test_switch_page_ticks_off_what_is_pressed_by_hand() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("e")
            page = b.app.screen
            assert isinstance(page, SwitchPage)
            for name in page.test.names:
                assert page.test.asked == name
                b.hand(name, True)
                await b.wait(lambda name=name: page.test.presses[name] == 1)  # type: ignore[misc]
                b.hand(name, False)
                await b.wait(lambda: not b.drawn.switch_closed)
            assert page.test.done
            assert b.moved_steps == (0, 0, 0)
            await b.press("escape")
            assert not isinstance(b.app.screen, SwitchPage)

    play(scene)


def test_switch_page_can_press_on_a_simulated_mill() -> None:
    async def scene() -> None:
        hands: list[tuple[str, bool]] = []
        async with bench(hand=lambda name, pressed: hands.append((name, pressed))) as b:
            await b.press("e", "down", "p", "p", "p", "escape")
            assert hands == [("xmax", True), ("xmax", False), ("xmax", True), ("xmax", False)]

    play(scene)


def test_log_is_switched_on_and_off(tmp_path: Path) -> None:
    async def scene() -> None:
        file = tmp_path / "fraese.log"
        config = Config.model_validate({"log": {"file": str(file)}})
        async with bench(config=config) as b:
            await b.press("l")
            await b.settled()
            assert b.text("#log") == "log on"
            await b.jog("right")
            await b.press("l")
            await b.settled()
            assert b.text("#log") == "log off"
            assert "jog" in file.read_text()

    play(scene)


def test_a_log_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    async def scene() -> None:
        config = Config.model_validate({"log": {"file": str(tmp_path)}})
        async with bench(config=config) as b:
            await b.press("l")
            assert "cannot be written" in b.text("#message")
            assert b.text("#log") == "log off"

    play(scene)


def clipped(b: Bench) -> list[str]:
    """What stands out of the screen, or is narrower than its words."""
    screen = b.app.screen
    width, height = screen.size
    bad = []
    for widget in screen.query("*"):
        if not widget.display or any(not parent.display for parent in widget.ancestors):
            continue
        region = widget.region
        if region.right > width or region.bottom > height:
            bad.append(f"{widget!r} {region}")
        if isinstance(widget, Link):
            needed = widget.get_content_width(screen.size, screen.size)
            if widget.size.width < needed:
                bad.append(f"{widget!r} is {widget.size.width} wide, not {needed}")
    return bad


@pytest.mark.parametrize(
    ("size", "light"), [((80, 24), False), ((80, 24), True), ((100, 30), False), ((160, 50), True)]
)
def test_pictures_fit(size: tuple[int, int], light: bool) -> None:
    async def scene() -> None:
        async with bench(size=size) as b:
            if light:
                await b.press("t")
                assert b.app.theme == "fraese-light"
            for axis, steps in (("x", 40_001), ("y", 20_000), ("z", -6_667)):
                b.plant.controller.position.set_reference(axis, steps)
            await b.jog("right")
            seen = []
            for _ in PICTURES:
                screen = b.app.screen
                assert isinstance(screen, MachineView)
                seen.append(screen.picture)
                assert clipped(b) == []
                await b.press("v")
                await b.pilot.pause(0.05)
            assert tuple(seen) == PICTURES

    play(scene)


@pytest.mark.parametrize("key", ["g", "r", "o", "e", "question_mark", "ctrl+p"])
def test_dialogs_fit_and_escape_closes_them(key: str) -> None:
    async def scene() -> None:
        async with bench() as b:
            below = b.app.screen
            await b.press(key)
            await b.wait(lambda: b.app.screen is not below)
            await b.pilot.pause(0.05)
            for button in b.app.screen.query(Button):
                assert button.region.bottom <= 23
            await b.press("escape")
            await b.wait(lambda: b.app.screen is below)

    play(scene)


def test_pictures_show_what_they_are_for() -> None:
    async def scene() -> None:
        async with bench() as b:
            screen = b.app.screen
            assert screen.query_one("#hand").display
            assert not screen.query_one(ProgramPane).display
            await b.jog("right")
            assert "machine     1.000" in b.text("#axis-x .beside")
            await b.press("v")
            assert not screen.query_one("#hand").display
            assert screen.query_one(ProgramPane).display
            assert not screen.query_one(Toolpath).display
            await b.jog("right")
            assert "machine     2.000" in b.text("#axis-x .under")
            await b.press("v")
            assert screen.query_one("#hand").display
            for width, height in ((120, 40), (200, 60), (20, 5), (300, 100), (80, 24)):
                await b.pilot.resize_terminal(width, height)
                await b.pilot.pause(0.1)
                pane = screen.query_one(ProgramPane)
                both = screen.query_one("#hand").display and pane.display
                assert both == (width >= 120)
                assert not both or pane.toolpath.region.bottom <= pane.listing.region.y
                assert width < 80 or clipped(b) == []
                assert screen.query_one("#keys").region.bottom <= height
                assert screen.query_one("#axis-x AxisNumber").size.width <= width
            assert b.text("#axis-x .beside").count("\n") == 2

    play(scene)


def test_everything_works_by_mouse() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.pilot.click("#commands .link")  # Stop, with nothing to stop
            await b.pilot.click("#jog-x-more")
            await b.settled()
            assert b.moved_steps == (200, 0, 0)
            await b.pilot.click("#widths .link")
            await b.jog("left")
            assert b.moved_steps == (199, 0, 0)

    play(scene)


def test_commands_are_in_the_palette() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("ctrl+p")
            await b.type("zero all")
            await b.pilot.pause(0.3)
            await b.press("right")
            await b.press("enter")
            await b.settled()
            assert "Work zero set here" in b.text("#message")

    play(scene)


def test_quit_waits_for_the_machine_and_switches_off() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            await b.press("q")
            assert "stop it first" in b.text("#message")
            await b.press("ctrl+q")
            mill = b.mill
        assert mill.look().currents[0] == (0, 0)

    play(scene)


@pytest.mark.parametrize("presses", [0, 1, 2])
def test_a_long_message_is_seen_in_full(presses: int) -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press(*["v"] * presses)
            sentence = " ".join(["twenty-two characters."] * 8) + " The last word."
            screen = b.app.screen
            assert isinstance(screen, MachineView)
            screen.say(sentence)
            await b.wait(lambda: screen.query_one("#message").size.height == 3)
            assert clipped(b) == []

    play(scene)


def test_lost_steps_are_said_loudly_with_motor_and_reason() -> None:
    async def scene() -> None:
        # The motors of the mill cannot follow full steps at the rates meant for half-steps.
        config = Config.model_validate({"card": {"table": "full-step"}})
        async with bench(config=config) as b:
            assert not b.view.query_one("#lost").display
            await b.press("g")
            await b.type("X10")
            await b.press("enter")
            await b.settled()
            lost = b.drawn.lost_steps[0]
            assert abs(lost) > 100
            assert b.text("#lost").startswith(f"LOST STEPS  X {abs(lost):g} ")
            assert b.drawn.lost_why[0] in b.text("#lost")
            assert b.view.query_one("#lost").display
            for _ in PICTURES:
                await b.pilot.pause(0.1)
                assert clipped(b) == []
                await b.press("v")

    play(scene)
