"""Keys move the carriages of the simulated mill."""

from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path

import pytest
from textual.widgets import Input

from fraese.config import Config
from fraese.control.bounds import Span
from fraese.control.recorder import Recorder
from fraese.control.state import Status
from fraese.errors import ConfigError
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.help import HelpPage
from fraese.ui.dialogs.reference import ReferenceDialog
from tests.ui.helpers import LONG_MOVE_MM, Bench, FakeProgram, bench, play


@pytest.mark.parametrize(
    ("key", "moved"),
    [
        ("right", (200, 0, 0)),
        ("left", (-200, 0, 0)),
        ("up", (0, 200, 0)),
        ("down", (0, -200, 0)),
        ("pageup", (0, 0, 200)),
        ("pagedown", (0, 0, -200)),
    ],
)
def test_jog_keys_move_the_right_way(key: str, moved: tuple[int, ...]) -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.jog(key)
            assert b.moved_steps == moved

    play(scene)


def test_widths() -> None:
    async def scene() -> None:
        async with bench() as b:
            for key, steps in (("1", 1), ("2", 2), ("3", 20), ("4", 200), ("5", 2000)):
                before = b.moved_steps[0]
                await b.press(key)
                await b.jog("right")
                assert b.moved_steps[0] - before == steps
            await b.press("plus")
            await b.jog("left")
            assert b.moved_steps[0] == 2223 - 1
            await b.press("minus")
            await b.jog("left")
            assert b.moved_steps[0] == 2222 - 2000

    play(scene)


def test_repeat_rule_at_half_step_width() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("1")
            await b.press(*["right"] * 22)
            await b.settled()
            assert b.moved_steps[0] == 20 + 2 * 10
            assert "× 10" in b.text("#width-note")
            await b.press("up", "right")
            await b.settled()
            assert b.moved_steps[:2] == (41, 1)

    play(scene)


def test_repeat_rule_leaves_other_widths_alone() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("2")
            await b.press(*["right"] * 20)
            await b.settled()
            before = b.moved_steps[0]
            await b.jog("right", "right")
            assert b.moved_steps[0] == before + 4

    play(scene)


def test_go_to_absolute_relative_and_zero() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("g")
            await b.type("X2 Y-1 F600")
            await b.press("enter")
            await b.settled()
            assert b.moved_steps == (400, -200, 0)
            await b.press("X")
            await b.settled()
            assert b.drawn.work_mm == (0.0, -1.0, 0.0)
            assert "was X 2.000 mm" in b.text("#message")
            await b.press("g")
            dialog = b.app.screen
            assert isinstance(dialog, GoToDialog)
            assert dialog.query_one(Input).value == "X2 Y-1 F600"
            await b.press("ctrl+u", "ctrl+k")
            await b.type("X1")
            await b.press("enter")
            await b.settled()
            assert b.moved_steps == (600, -200, 0)
            await b.press("g", "up", "ctrl+u", "ctrl+k")  # counted from here
            await b.type("X1 Z1")
            await b.press("enter")
            await b.settled()
            assert b.moved_steps == (800, -200, 200)
            await b.press("A")
            await b.settled()
            assert b.drawn.work_mm == (0.0, 0.0, 0.0)

    play(scene)


def test_bad_target_is_said_and_nothing_moves() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("g")
            await b.type("X1 5")
            await b.press("enter")
            assert isinstance(b.app.screen, GoToDialog)
            assert '"5" is not a letter with a number' in b.app.screen.query_one("#complaint").text  # type: ignore[attr-defined]
            await b.press("ctrl+u", "ctrl+k")
            await b.type("X1000")
            await b.press("enter")
            await b.settled()
            assert isinstance(b.app.screen, GoToDialog)
            assert "further than its whole travel" in b.app.screen.query_one("#complaint").text  # type: ignore[attr-defined]
            assert b.moved_steps == (0, 0, 0)
            assert b.text("#word") == "NOT REFERENCED"

    play(scene)


def test_reference_chosen_and_all_axes() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("r", "x", "y")
            assert isinstance(b.app.screen, ReferenceDialog)
            await b.press("enter")
            await b.settled()
            assert b.drawn.referenced == (False, False, True)
            await b.press("r", "enter")
            await b.settled()
            assert b.drawn.referenced == (True, True, True)
            assert b.mill.look().carriages_steps == (400, 400, 60 * 200 - 400)
            assert "Referenced" in b.text("#message")
            await b.press("r", "x", "y", "z", "enter")
            assert isinstance(b.app.screen, ReferenceDialog)
            await b.press("escape")
            assert not isinstance(b.app.screen, ReferenceDialog)

    play(scene)


def test_measuring_says_the_travel() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("r", "x", "y", "m", "enter")
            await b.settled()
            assert "travel 60.000 mm" in b.text("#message")

    play(scene)


def test_stop_works_while_an_input_has_the_focus() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            await b.press("g")
            await b.type("X1")
            assert isinstance(b.app.focused, Input)
            await b.press("escape")
            await b.wait(lambda: not b.app.busy)
            await b.pilot.pause(0.1)
            assert isinstance(b.app.screen, GoToDialog), "the first press stops, no more"
            assert 0 < b.moved_steps[0] < LONG_MOVE_MM * 200
            assert b.mill.look().lost_steps == (0, 0, 0)
            assert "Cancelled" in b.text("#message")
            await b.press("escape")
            assert not isinstance(b.app.screen, GoToDialog)

    play(scene)


@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
def test_stop_brakes_and_drops_what_waits(key: str) -> None:
    async def scene() -> None:
        config = Config.model_validate({"jog": {"feed_mm_min": 60}})
        async with bench(clock="paced", config=config) as b:
            await b.press("5", "right", "right")
            await b.wait(lambda: b.plant.controller.state().running)
            await b.press(key)
            await b.settled()
            assert b.moved_steps[0] < 1900
            assert b.plant.controller.status is Status.OK
            assert b.moved_steps[0] == b.plant.controller.position.position_steps[0]

    play(scene)


def test_second_stop_is_without_ramp() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            b.plant.controller.position.set_reference("x", 0)
            await b.long_move()
            b.app.action_stop_machine()
            b.app.action_stop_machine()
            await b.settled()
            assert "without ramp" in b.text("#message")
            assert not b.drawn.referenced[0]

    play(scene)


def test_hold_and_go_on() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            await b.press("space")
            await b.wait(lambda: b.text("#word") == "HOLD")
            stood = b.moved_steps
            await b.pilot.pause(0.1)
            assert b.moved_steps == stood
            await b.press("space")
            await b.wait(lambda: b.moved_steps > stood)
            b.app.action_stop_machine()
            await b.settled()
            # Nothing was lost or counted twice on the way: there is where X 5 is.
            b.app.link.order(lambda: b.plant.controller.move_to({"x": 5}))
            await b.settled()
            assert b.moved_steps == (1000, 0, 0)
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)


def test_hold_and_stop_count_for_one_job_only() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            controller = b.plant.controller
            await b.long_move()
            b.view.action_hold()
            b.app.action_stop_machine()
            await b.wait(lambda: not b.app.busy)
            await b.long_move()
            assert not controller.holding
            assert not controller.cancelling
            b.view.action_hold()
            assert controller.holding
            await b.wait(lambda: controller.state().held)
            b.app.action_stop_machine()
            await b.settled()
            assert not controller.holding
            assert b.mill.look().lost_steps == (0, 0, 0)
            assert "Cancelled" in b.text("#message")
            assert "without ramp" not in b.text("#message")

    play(scene)


def test_stop_ends_a_hold() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.long_move()
            await b.press("space")
            await b.wait(lambda: b.text("#word") == "HOLD")
            await b.press("escape")
            await b.settled()
            assert b.text("#word") == "NOT REFERENCED"
            await b.press("4")
            before = b.moved_steps[0]
            await b.jog("right")
            assert b.moved_steps[0] == before + 200

    play(scene)


def test_contact_is_an_error_until_acknowledged() -> None:
    async def scene() -> None:
        async with bench() as b:
            b.mill.mill.place(0, 300 * 200 - 100)
            await b.jog("right")
            assert b.text("#word") == "ALARM xmax"
            assert b.text("#switch") == "switch xmax"
            assert "Press Enter" in b.text("#job")
            assert "End switch xmax closed" in b.text("#message")
            (told,) = b.app._notifications
            assert told.title == "Alarm 10"
            assert "End switch xmax closed" in told.message
            assert "reference the machine" in told.message
            stood = b.mill.look().carriages_steps
            await b.jog("left")
            assert "Acknowledge" in b.text("#message")
            assert b.mill.look().carriages_steps == stood
            await b.press("enter")
            await b.settled()
            assert b.text("#word") == "SWITCH CLOSED"
            await b.jog("right")
            assert "is closed" in b.text("#message")
            assert b.mill.look().carriages_steps == stood
            await b.jog("left")
            assert b.mill.look().carriages_steps[0] == stood[0] - 200
            assert b.text("#switch") == "switch open"

    play(scene)


def test_two_candidates_are_shown_as_a_question() -> None:
    async def scene() -> None:
        async with bench() as b:
            b.mill.mill.place(0, 300 * 200 - 100)
            await b.press("g")
            await b.type("X2 Y-2")
            await b.press("enter")
            await b.settled()
            assert b.text("#switch") == "switch xmax or ymin?"

    play(scene)


def test_ignored_switches_are_shown_loudly() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("i", "enter")
            await b.settled()
            assert b.text("#ignored") == "SWITCHES IGNORED"
            b.mill.mill.place(0, 300 * 200 - 100)
            await b.jog("right")
            assert b.moved_steps[0] == 300 * 100 - 100 + 200
            await b.press("i", "enter")
            await b.settled()
            assert b.text("#ignored") == ""

    play(scene)


def test_nothing_jogs_while_a_program_runs_or_a_page_is_open() -> None:
    async def scene() -> None:
        program = FakeProgram([f"G1 X{n % 2}" for n in range(400)])
        async with bench(clock="paced", open_program=lambda path: program) as b:
            await b.press("question_mark")
            assert isinstance(b.app.screen, HelpPage)
            await b.press("up", "pageup", "escape")
            await b.press("o")
            await b.type("fake.nc")
            await b.press("enter")
            await b.wait(lambda: b.text("#program") == "fake.nc")
            await b.settled()
            await b.start()
            await b.wait(lambda: b.plant.controller.state().running)
            await b.press("pageup", "X")
            await b.wait(lambda: "The machine runs" in b.text("#message"))
            await b.press("escape")
            await b.settled()
            assert b.moved_steps[1:] == (0, 0)
            assert b.drawn.offset_mm == (0.0, 0.0, 0.0)

    play(scene)


async def _go_to(b: Bench) -> None:
    await b.press("g")
    await b.type("X1")
    await b.press("enter")


async def _reference(b: Bench) -> None:
    await b.press("r", "enter")


async def _start(b: Bench) -> None:
    await b.wait(lambda: "Start it" in b.text("#message"))
    await b.settled()
    await b.start()


async def _jog(b: Bench) -> None:
    await b.press("right")


class _FullDisk(Recorder):
    """Says no before motion."""

    def __init__(self) -> None:
        self.asked = 0

    def before_motion(self, first: Sequence[Span] = ()) -> None:
        self.asked += 1
        raise ConfigError("The state cannot be written: no space left.")


@pytest.mark.parametrize("move", [_jog, _go_to, _reference, _start])
def test_motion_is_written_down_first_and_may_be_refused(
    move: Callable[[Bench], Awaitable[None]],
) -> None:
    async def scene() -> None:
        program, recorder = FakeProgram(["G1 X1"]), _FullDisk()
        async with bench(program=Path("fake.nc"), open_program=lambda path: program) as b:
            b.plant.controller._loop._recorder = recorder
            await move(b)
            await b.wait(lambda: "no space left" in b.text("#message"))
            await b.settled()
            assert recorder.asked == 1
            assert b.moved_steps == (0, 0, 0)
            assert b.drawn.status is Status.OK
            assert b.drawn.job is None

    play(scene)


def test_what_does_not_move_is_not_announced() -> None:
    async def scene() -> None:
        recorder = _FullDisk()
        async with bench() as b:
            b.plant.controller._loop._recorder = recorder
            await b.press("X", "i", "enter")
            await b.settled()
            assert recorder.asked == 0

    play(scene)


def test_the_feed_override_follows_its_keys() -> None:
    async def scene() -> None:
        async with bench(size=(80, 24)) as b:
            await b.press("comma", "comma", "comma")
            assert b.plant.controller.handling.feed == pytest.approx(0.7)
            await b.wait(lambda: "feed 70%" in b.text("#work"))
            await b.press(*["full_stop"] * 20)
            assert b.plant.controller.handling.feed == 2
            await b.press("equals_sign")
            assert b.plant.controller.handling.feed == 1
            await b.press(*["comma"] * 12)
            assert b.plant.controller.handling.feed == pytest.approx(0.1)

    play(scene)
