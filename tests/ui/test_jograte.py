"""The jog rate in the app: asked, shown, obeyed, remembered."""

import json
from pathlib import Path

from textual.widgets import Input

from fraese.ui.dialogs.jograte import JogRateDialog
from fraese.ui.eventlog import Kind
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.links import Link
from fraese.ui.widths import rate_words
from tests.ui.helpers import Bench, bench, play
from tests.ui.test_axes import FOUR


async def asked(b: Bench) -> JogRateDialog:
    await b.press("j")
    await b.wait(lambda: isinstance(b.app.screen, JogRateDialog) and b.app.focused is not None)
    dialog = b.app.screen
    assert isinstance(dialog, JogRateDialog)
    return dialog


async def choose(b: Bench, text: str) -> JogRateDialog:
    dialog = await asked(b)
    dialog.query_one(Input).value = text
    await b.press("enter")
    return dialog


def shown(b: Bench) -> str:
    """The rate in the line of widths, as it is drawn."""
    link = b.view.query("#widths Link").last(Link)
    assert link.region.right <= b.app.size.width
    return link.render().plain


def test_it_is_asked_shown_and_obeyed() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            assert shown(b) == "j 600 mm/min"
            await choose(b, "F 60")
            await b.wait(lambda: b.app.screen is b.view)
            await b.wait(lambda: shown(b) == "j 60 mm/min")
            assert "jogs go with 60 mm/min" in b.view.said[0]
            await b.press("5", "right")
            await b.wait(lambda: b.drawn.speed_mm_min > 55)
            assert b.drawn.speed_mm_min < 65
            # Also while something moves: what is being made keeps its rate.
            await choose(b, "1200")
            await b.wait(lambda: shown(b) == "j 1200 mm/min")
            await b.press("escape")
            await b.settled()
            await choose(b, "")
            await b.wait(lambda: shown(b) == "j 600 mm/min")

    play(scene)


def test_what_is_wrong_is_said_in_the_dialog_and_it_stays() -> None:
    async def scene() -> None:
        async with bench() as b:
            for text, said in (
                ("fast", '"fast" is no rate: type a number such as 600.'),
                ("0", "A feed is above 0 mm/min, not 0."),
                ("99999", "No axis goes with 99999 mm/min: the fastest one can"),
            ):
                dialog = await choose(b, text)
                await b.wait(lambda: said in dialog.query_one("#complaint").text)  # type: ignore[attr-defined]  # noqa: B023
                assert b.app.screen is dialog
                await b.press("escape")
                await b.wait(lambda: b.app.screen is b.view)
            assert shown(b) == "j 600 mm/min"

    play(scene)


def test_it_is_remembered_and_forgotten_where_no_axis_can_do_it(tmp_path: Path) -> None:
    path = tmp_path / "session.json"

    async def before() -> None:
        async with bench(session=path) as b:
            await choose(b, "250,5")
            await b.wait(lambda: shown(b) == "j 250.5 mm/min")

    async def after() -> None:
        async with bench(session=path) as b:
            await b.wait(lambda: shown(b) == "j 250.5 mm/min")

    async def elsewhere() -> None:
        async with bench(session=path) as b:
            await b.wait(lambda: shown(b) == "j 600 mm/min")
            events = b.app._events.of(tuple(Kind))
            assert any("No axis goes with" in event.title for event in events)

    play(before)
    play(after)
    kept = json.loads(path.read_text())
    path.write_text(json.dumps(kept | {"jog_feed_mm_min": 1e6}))
    play(elsewhere)


def test_with_axes_of_both_kinds_the_line_has_room_for_it() -> None:
    async def scene() -> None:
        async with bench(config=FOUR) as b:
            assert shown(b) == "j 600/min"

    play(scene)


def test_its_unit_is_that_of_the_axes() -> None:
    def shape(*units: str) -> Shape:
        return Shape(tuple(AxisShape("x", unit, 0.01) for unit in units), "step")

    assert rate_words(600, shape("mm", "mm")) == "600 mm/min"
    assert rate_words(90, shape("°")) == "90°/min"
    assert rate_words(0.5, shape("mm", "°")) == "0.5/min"
