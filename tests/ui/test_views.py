"""A view is one class and one row: it has its own keys, actions and widgets."""

import pytest
from textual.app import ComposeResult

from fraese.control.state import MachineState
from fraese.ui.keyrows import Area, KeyTable
from fraese.ui.views import VIEWS
from fraese.ui.views.view import View
from fraese.ui.widgets.fact import Fact
from fraese.ui.widgets.keybar import KeyBar
from tests.ui.helpers import bench, play
from tests.ui.test_pure import MILL


class Second(View):
    """Shows where X is; borrows an area of the table whose keys mean something else elsewhere."""

    AREA = Area.SWITCHES
    NAME = "second"

    def __init__(self, *given: object) -> None:
        super().__init__(*given)  # type: ignore[arg-type]
        self.presses = 0

    def inner(self) -> ComposeResult:
        yield Fact("", id="x")

    def show_inner(self, state: MachineState) -> None:
        self.query_one("#x", Fact).show(f"{state.position_mm[0]:.3f}")

    def action_press(self) -> None:
        self.presses += 1


BOTH = {**VIEWS, "second": Second}


def test_a_second_view_is_one_row_with_its_own_keys() -> None:
    async def scene() -> None:
        async with bench(views=BOTH) as b:
            first = b.view
            await b.jog("right")
            await b.show_view("second")
            second = b.app.view
            assert isinstance(second, Second)
            await b.pilot.pause()
            assert second.query_one("#x", Fact).text == "1.000"
            await b.press("p", "right", "X", "p")
            await b.settled()
            assert second.presses == 2
            assert b.moved_steps == (200, 0, 0), "the other view's keys do nothing here"
            await b.press("question_mark")
            assert b.app.screen is not second, "what every view has, it has"
            await b.press("escape")
            await b.show_view("move")
            assert b.app.view is first
            await b.press("p")
            assert b.app.screen is not first, "there it is another command"
            await b.press("escape")
            await b.jog("right")
            assert (second.presses, b.moved_steps) == (2, (400, 0, 0))

    play(scene)


def test_what_comes_before_a_view_is_there_is_shown_when_it_is() -> None:
    async def scene() -> None:
        async with bench(views=BOTH) as b:
            # Nothing of it is there before the next turn of the loop.
            b.app.switch_mode("second")
            b.app.view.draw(b.drawn, False)
            b.app.view.refuse("Too early.")
            second = b.app.view
            await b.wait(lambda: second.is_mounted)
            assert second.query_one("#message", Fact).text == "Too early."
            assert second.query_one("#x", Fact).text == "0.000"

    play(scene)


def test_a_second_view_shows_and_stops_the_machine() -> None:
    async def scene() -> None:
        async with bench(clock="paced", views=BOTH) as b:
            await b.long_move()
            await b.show_view("second")
            second = b.app.view
            await b.press("space")
            await b.wait(lambda: b.plant.controller.state().held)
            await b.press("escape")
            await b.settled()
            assert "Cancelled" in second.query_one("#message", Fact).text
            assert second.query_one("#x", Fact).text == f"{b.moved_steps[0] / 200:.3f}"
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)


def test_every_view_has_a_key_and_shows_state_position_switch_and_stop() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.jog("right")
            b.app.view.refuse("No.")
            for name, view in list(VIEWS.items())[1:] + list(VIEWS.items())[:1]:
                await b.press(b.app.view.desk.keys.views[name].keys)
                seen = b.app.view
                assert type(seen) is view
                await b.wait(lambda seen=seen: seen.is_mounted and seen.size.width > 0)  # type: ignore[misc]
                await b.pilot.pause()
                assert seen.query_one("#word", Fact).text == "NOT REFERENCED"
                assert seen.query_one("#switch", Fact).text == "switch open"
                assert seen.query_one("#message", Fact).text == "No."
                shown = seen.query_one("#axis-x AxisNumber" if name == "move" else "#at")
                assert "1.000" in str(getattr(shown, "value", "") or getattr(shown, "text", ""))
                assert str(seen.query_one(KeyBar).render()).startswith("Esc Stop")
            await b.press("tab")
            assert b.app.current_mode == list(VIEWS)[1]
            await b.press("shift+tab", "shift+tab")
            assert b.app.current_mode == list(VIEWS)[-1]

    play(scene)


def test_a_command_of_another_view_leads_there_from_the_palette() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.jog("right")
            await b.press("f6", "ctrl+p")
            await b.type("zero all")
            await b.pilot.pause(0.3)
            await b.press("right", "enter")
            await b.settled()
            assert b.app.current_mode == "move"
            assert b.drawn.work_mm == (0, 0, 0)

    play(scene)


@pytest.mark.parametrize("width", [20, 40, 60, 80, 120, 200])
def test_the_keys_fit_and_never_run_into_their_words(width: int) -> None:
    keys = KeyTable(MILL)
    rows = [row for row in keys.of(Area.VIEWS, Area.MACHINE) if row.footer]
    first = [*keys.of(Area.EVERYWHERE)][:1]
    more = [row for row in rows if row not in keys.views.values()]
    bar = KeyBar(first, keys.views, more, "move")
    entries, gap = bar.fitting(width)
    words = [f"{entry.row.shown} {entry.word}" for entry in entries]
    assert words[0] == "Esc Stop"
    assert len((" " * gap).join(words)) <= width
    if width >= 80:
        assert {entry.row for entry in entries} >= set(keys.views.values())


def test_a_click_on_a_key_does_what_the_key_does() -> None:
    async def scene() -> None:
        async with bench() as b:
            at = str(b.app.view.query_one(KeyBar).render()).index("F6")
            await b.pilot.click(KeyBar, offset=(at + 2, 0))
            await b.wait(lambda: b.app.current_mode == "log")

    play(scene)
