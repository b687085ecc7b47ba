"""While a job asks: move by hand, touch off, and go on by a way that is shown first."""

from pathlib import Path

from fraese.program.program import open_program
from fraese.ui.dialogs.ask import AskDialog
from fraese.ui.widgets.fact import Fact
from tests.helpers import configured
from tests.ui.helpers import Bench, bench, play

PART = "G0 Z2\nG0 X3\nT2 M6\nG1 Z1 F600\nX4\nM2\n"


async def at_the_question(b: Bench, folder: Path) -> None:
    path = folder / "part.ngc"
    path.write_text(PART)
    part = open_program(path)

    def start(controller: object) -> None:
        part.check(b.plant.controller)
        part.start(b.plant.controller)

    b.app.link.order_of(start)
    await asked(b)


async def asked(b: Bench, words: str = "") -> AskDialog:
    await b.wait(
        lambda: (
            isinstance(b.app.screen, AskDialog)
            and b.app.screen.is_mounted
            and words in b.app.screen.query_one(".question", Fact).text
        )
    )
    dialog = b.app.screen
    assert isinstance(dialog, AskDialog)
    return dialog


def test_a_tool_is_touched_off_while_the_program_waits(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench(config=configured()) as b:
            controller = b.plant.controller
            await at_the_question(b, tmp_path)
            await b.press("m")
            assert b.app.screen is b.view
            assert "put in tool 2" in b.text("#message")
            await b.press("4", "pageup", "pageup", "right")
            await b.wait(lambda: b.moved_steps == (800, 0, 800))
            await b.press("X")
            await b.wait(lambda: "only the zero of Z" in b.text("#message"))
            await b.press("Z")
            await b.wait(lambda: controller.state().offset_mm[2] == 4)
            assert b.app.screen is b.view, "nobody is asked again before he is ready"
            await b.press("enter")
            await asked(b, "put in tool 2")
            await b.press("enter")
            way = await asked(b, "Back to the work")
            assert "X 3.000 Y 0.000 Z 6.000" in way.query_one(".question", Fact).text
            await b.press("enter")
            await b.settled()
            # 1 mm above what was touched.
            assert b.moved_steps == (800, 0, 1000)

    play(scene)


def test_the_stop_key_ends_the_jog_first(tmp_path: Path) -> None:
    async def scene() -> None:
        config = configured(jog={"feed_mm_min": 60})
        async with bench(clock="paced", config=config) as b:
            controller = b.plant.controller
            await at_the_question(b, tmp_path)
            await b.press("l")
            await b.wait(lambda: controller.state().speed_mm_min > 0)
            await b.press("escape")
            await b.wait(lambda: "tool 2" in controller.question)
            assert controller.status.value == "RUN"
            assert 400 <= b.moved_steps[2] < 2400
            assert b.app.screen is b.view
            await b.press("escape")
            await b.settled()
            assert controller.status.value == "OK"
            assert controller.state().cut_short is not None

    play(scene)


def test_no_button_that_says_back_stops_a_job(tmp_path: Path) -> None:
    async def scene() -> None:
        async with bench(config=configured()) as b:
            await at_the_question(b, tmp_path)
            labels = [str(button.label) for button in b.app.screen.query("Button")]  # type: ignore[attr-defined]
            assert labels == ["Go on", "Move by hand", "Lift the tool", "Stop the job"]
            await b.press("tab", "tab", "tab", "enter")
            await b.settled()
            assert b.plant.controller.state().cut_short is not None

    play(scene)


def test_what_is_in_force_where_the_motors_are_is_shown_and_named(tmp_path: Path) -> None:
    """The program sets G55, G92 and a tool; the interpreter may be as far ahead as it likes."""
    text = "G0 X1\nG10 L2 P2 X-10 Y0 Z0\nG55\nG0 X12\nM0\nG92 X5\nT2 M6\nM0\nG54\nG92.1\nM0\nM2\n"

    async def scene() -> None:
        async with bench(config=configured()) as b:
            path = tmp_path / "part.ngc"
            path.write_text(text)
            part = open_program(path)
            b.app.link.order_of(part.start)
            for question, said, x_mm in (
                ("line 5", "G55", 12.0),
                ("put in tool 2", "G55  G92", 5.0),
                ("line 8", "G55  G92  T2", 5.0),
                ("line 11", "G54  T2", 2.0),
            ):
                await asked(b, question)
                await b.wait(lambda said=said: b.text("#work") == said)  # type: ignore[misc]
                assert b.drawn.work_mm[0] == x_mm
                assert b.drawn.position_mm[0] == 2
                await b.press("enter")
            await b.settled()

    play(scene)
