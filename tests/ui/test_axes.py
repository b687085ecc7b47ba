"""One to four axes, linear and rotary, in the app."""

from typing import Any

import pytest
from textual.widgets import Checkbox, Input

from fraese.config import Config
from fraese.config.file import from_table
from fraese.ui.dialogs.goto import GoToDialog
from fraese.ui.dialogs.reference import ReferenceDialog
from fraese.ui.views.machine import PICTURES
from fraese.ui.widgets.big import AxisNumber, font_for
from tests.ui.helpers import Bench, bench, play
from tests.ui.test_pages import clipped

SIZES = [(80, 24), (100, 30), (120, 40), (160, 50)]


def machine(axes: str, **tables: Any) -> Config:
    """A, B and C turn, once round behind a worm gear unless a table says otherwise."""
    turning = {name: {"travel_deg": 360, "gear": "90"} for name in axes if name in "abc"}
    table = {"names": list(axes), **turning, **tables}
    built = {"axes": {name: {"gear": "90"} for name in turning}}
    return from_table({"card": {"kind": "stepdir"}, "axes": table, "simulation": built}, "test")


FOUR = machine("xyza")


def test_the_speed_of_a_turn_is_in_degrees() -> None:
    async def scene() -> None:
        async with bench(config=FOUR, clock="paced") as b:
            controller = b.plant.controller
            b.app.link.order(lambda: controller.move_to({"a": 300}, feed_mm_min=30))
            await b.wait(lambda: "°/min" in b.text("#feed"))
            assert "mm" not in b.text("#feed")
            b.app.link.brake()
            await b.settled()

    play(scene)


def test_a_fourth_axis_is_jogged_and_zeroed_by_keys() -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            await b.jog("home", "home", "end", "home", "pageup")
            a = b.plant.controller.machine.axes[3]
            per_mm = float(b.plant.controller.machine.axes[2].steps_per_mm)
            assert b.moved_steps == (0, 0, per_mm, 2 * float(a.steps_per_mm))
            assert b.drawn.work_mm[3] == pytest.approx(2.0, abs=a.step_mm)
            await b.press("0")
            await b.settled()
            assert b.drawn.work_mm[3] == 0
            assert b.drawn.work_mm[2] == pytest.approx(1.0)
            assert "was A 2.000° before" in b.text("#message")
            await b.press("A")
            await b.settled()
            assert b.drawn.work_mm == (0, 0, 0, 0)
            assert "was X 0.000 mm Y 0.000 mm Z 1.000 mm A 0.000° before" in b.text("#message")

    play(scene)


def test_a_fourth_axis_goes_where_it_is_told() -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            await b.press("g")
            dialog = b.app.screen
            assert isinstance(dialog, GoToDialog)
            placeholder = dialog.query_one(Input).placeholder
            assert placeholder == "X10 Y5 Z-1 A90 F300   (mm, °, mm/min)"
            await b.type("X1 A90")
            await b.press("enter")
            await b.settled()
            axes = b.plant.controller.machine.axes
            assert b.moved_steps == (axes[0].to_steps(1), 0, 0, axes[3].to_steps(90))
            await b.press("g", "ctrl+u", "ctrl+k")
            await b.type("B1")
            await b.press("enter")
            assert "no axis B" in b.app.screen.query_one("#complaint").text  # type: ignore[attr-defined]

    play(scene)


def test_the_placeholder_of_three_axes_is_what_it_was() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("g")
            placeholder = b.app.screen.query_one(Input).placeholder
            assert placeholder == "X10 Y5 Z-1 F300   (mm, mm/min)"

    play(scene)


def test_axes_without_switches_are_offered_but_not_ticked() -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            await b.press("r")
            dialog = b.app.screen
            assert isinstance(dialog, ReferenceDialog)
            ticked = {str(box.id): box.value for box in dialog.query(Checkbox)}
            assert ticked == {
                "axis-x": True, "axis-y": True, "axis-z": True, "axis-a": False, "measure": False,
            }  # fmt: skip
            await b.press("x", "y", "a")
            ticked = {str(box.id): box.value for box in dialog.query(Checkbox)}
            assert [ticked[f"axis-{name}"] for name in "xyza"] == [False, False, True, True]
            hint = dialog.query(".hint").first().text  # type: ignore[attr-defined]
            assert hint == "Enter: go   x y z a m: choose   Esc: back"

    play(scene)


def test_the_switch_page_asks_for_the_switches_that_there_are() -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            await b.press("e")
            rows = [str(row.id) for row in b.app.screen.query(".switch-row")]
            assert rows == [f"switch-{axis}{end}" for axis in "xyz" for end in ("min", "max")]
        async with bench(config=machine("a")) as b:
            await b.press("e")
            assert b.app.screen is b.view
            assert "No axis of this machine has end switches" in b.text("#message")

    play(scene)


def test_what_turns_is_shown_in_degrees() -> None:
    async def scene() -> None:
        async with bench(config=FOUR, size=(120, 40)) as b:
            letters = [number.letter for number in b.view.query(AxisNumber)]
            assert letters == ["X", "Y", "Z", "A"]
            await b.jog("home")
            assert b.text("#axis-a .under").startswith("machine     1.000°  offset      0.000°  ○")
            assert b.text("#axis-x .under").startswith("machine     0.000  offset      0.000  ○")
            assert b.text("#axis-x .under").endswith("NOT REFERENCED")

    play(scene)


def test_an_endless_axis_has_no_limits_to_show() -> None:
    async def scene() -> None:
        async with bench(config=machine("xya", a={"gear": "90"}), size=(120, 40)) as b:
            assert b.text("#axis-a .gauge") == "turns without end: no limits"
            assert b.text("#axis-x .gauge") == "travel 296 mm, not referenced: no limits"
            await b.press("g")
            await b.type("A720")
            await b.press("enter")
            await b.settled()
            assert b.moved_steps == (0, 0, 720 * 100)
            await b.wait(lambda: b.text("#axis-a .gauge") == "turns without end: no limits")
            await b.press("r", "x", "y", "a", "enter")
            await b.settled()
            assert b.drawn.referenced == (False, False, True)
            assert b.text("#axis-a .gauge") == "turns without end: no limits"

    play(scene)


def test_an_axis_without_switches_is_referenced_where_it_stands() -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            await b.jog("home")
            await b.press("r", "x", "y", "z", "a", "enter")
            await b.settled()
            assert b.drawn.referenced == (False, False, False, True)
            assert b.drawn.position_mm[3] == 0
            assert b.moved_steps[:3] == (0, 0, 0)

    play(scene)


@pytest.mark.parametrize("axes", ["x", "xy", "xyza", "abcw"])
@pytest.mark.parametrize("size", SIZES)
def test_every_picture_fits(axes: str, size: tuple[int, int]) -> None:
    async def scene() -> None:
        async with bench(size=size, config=machine(axes)) as b:
            for long_message in (False, True):
                for _ in PICTURES:
                    if long_message:
                        b.view.say(" ".join(["twenty-two characters."] * 7) + " The last word.")
                    await b.pilot.pause(0.1)
                    assert clipped(b) == []
                    assert _numbers_seen(b) == len(axes)
                    await b.press("v")

    play(scene)


def _numbers_seen(b: Bench) -> int:
    """How many axes show a work position, in full height and with their name, inside the body."""
    body = b.view.query_one("#body").region
    seen = 0
    for row in b.view.query(".axis"):
        numbers = [number for number in row.query(AxisNumber) if font_for(number.size) is not None]
        seen += len(numbers) == 1 and body.contains_region(numbers[0].region)
    return seen


@pytest.mark.parametrize("key", ["g", "r", "o"])
def test_dialogs_fit_with_four_axes(key: str) -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            await b.press(key)
            await b.wait(lambda: b.app.screen is not b.view)
            await b.pilot.pause(0.1)
            assert clipped(b) == []
            for box in b.app.screen.query(Checkbox):
                size = b.app.screen.size
                assert box.content_size.width >= box.get_content_width(size, size)

    play(scene)


def test_steps_are_called_what_they_are() -> None:
    async def scene() -> None:
        async with bench(config=FOUR, size=(120, 40)) as b:
            assert "1 pulse" in str(b.view.query("#widths .link").first().render())

    play(scene)
