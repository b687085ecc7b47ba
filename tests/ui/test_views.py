"""A view is one class and one row: it has its own keys, actions and widgets."""

from textual.app import ComposeResult

from fraese.control.state import MachineState
from fraese.ui.keys import Area
from fraese.ui.views import VIEWS
from fraese.ui.views.view import View
from fraese.ui.widgets.fact import Fact
from tests.ui.helpers import bench, play


class Second(View):
    """Shows where X is; borrows an area of the table whose keys mean something else elsewhere."""

    AREA = Area.SWITCHES

    def __init__(self, *given: object) -> None:
        super().__init__(*given)  # type: ignore[arg-type]
        self.presses = 0

    def compose(self) -> ComposeResult:
        yield Fact("", id="x")
        yield Fact("", id="said")

    def show(self, state: MachineState, stopping: bool) -> None:
        self.query_one("#x", Fact).show(f"{state.position_mm[0]:.3f}")

    def show_said(self, text: str, tone: str) -> None:
        self.query_one("#said", Fact).show(text, tone)

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
            await b.show_view("machine")
            assert b.app.view is first
            await b.press("p")
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
            assert second.query_one("#said", Fact).text == "Too early."
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
            assert "Cancelled" in second.query_one("#said", Fact).text
            assert second.query_one("#x", Fact).text == f"{b.moved_steps[0] / 200:.3f}"
            assert b.mill.look().lost_steps == (0, 0, 0)

    play(scene)
