"""The view Calibrate: asks, moves, shows, and writes only what somebody has agreed to."""

from collections.abc import Mapping
from typing import Any

import pytest
from textual.widgets import Input

from fraese.control.calibration.figures import Figures
from fraese.control.calibration.repeat import Repeatability
from fraese.control.calibration.sweep import Outcome, Rates, Stage, Sweep, Tried
from fraese.errors import ConfigError
from fraese.ui.views.calibrate import CalibrateView
from fraese.ui.widgets.fact import Fact, Paragraph
from fraese.ui.widgets.findings import bar, histogram, sweep_line
from tests.helpers import configured
from tests.ui.helpers import Bench, bench, play

MILL = configured(
    axes={"x": {"travel_mm": 40}, "z": {"end_switches": False}},
    simulation={"axes": {"x": {"travel_mm": 41.5, "pitch_mm": 2.5}}},
)


class Notebook:
    """Takes down what would be written."""

    path = "/etc/mill.toml"

    def __init__(self) -> None:
        self.written: list[Mapping[str, Any]] = []
        self.full = False

    def write(self, values: Mapping[str, Any]) -> None:
        if self.full:
            raise ConfigError("The disk is full.")
        self.written.append(values)


def words(b: Bench, name: str) -> str:
    view = b.app.view
    assert isinstance(view, CalibrateView)
    return view.query_one(f"#calibrate-{name}", Paragraph).text


async def opens(b: Bench, key: str) -> None:
    """A dialog; what is typed before it is there would be for the view."""
    await b.press(key)
    await b.wait(lambda: b.app.screen is not b.app.view and len(b.app.screen.query("#yes")) > 0)


async def settled(b: Bench, *keys: str) -> None:
    await b.press(*keys)
    await b.settled()


def test_from_a_measured_way_to_the_file() -> None:
    notebook = Notebook()

    async def scene() -> None:
        async with bench(config=MILL, writer=notebook) as b:
            await b.press("f4")
            await b.press("w")
            assert "nothing to write" in b.app.view.said[0]
            await opens(b, "p")
            await b.press("backspace", "backspace", "x", "enter")
            complaint = b.app.screen.query_one("#complaint", Fact).text
            assert complaint == '"x" is no number: give a way, as in 50 or -50.'
            await b.press("backspace", "1", "0", "enter")
            await b.wait(lambda: b.app._state.question != "")
            await b.press("enter")
            await b.wait(lambda: len(b.app.screen.query("#field-read")) > 0)
            await settled(b, *"12.49", "enter")
            assert "160.128 are right" in words(b, "finding")
            assert "axes.x.pitch_mm: 2 becomes 2.5" in words(b, "proposal")
            await b.press("v")
            assert "2 becomes 2.498" in words(b, "proposal")
            await b.press("v")
            await opens(b, "w")
            assert notebook.written == []
            await b.press("escape")
            assert notebook.written == [], "Back writes nothing"
            await opens(b, "w")
            await b.press("enter")
            assert [dict(each) for each in notebook.written] == [{"axes.x.pitch_mm": 2.5}]
            assert "Written to /etc/mill.toml" in b.app.view.said[0]
            notebook.full = True
            await opens(b, "w")
            await b.press("enter")
            assert b.app.view.said[0] == "The disk is full."

    play(scene)


def test_travel_repeatability_and_what_is_refused() -> None:
    async def scene() -> None:
        async with bench(size=(120, 40), config=MILL) as b:
            await b.press("f4")
            await opens(b, "m")
            assert "X is referenced at its end switch" in b.app.screen.query(Fact)[1].text
            await settled(b, "enter")
            assert "33.200" in words(b, "finding")
            assert "axes.x.travel_mm: 40 becomes 33.2" in words(b, "proposal")
            await b.press("w")
            assert "no configuration file" in b.app.view.said[0]
            await opens(b, "n")
            await b.press("tab", "backspace", "backspace", "3")
            await settled(b, "enter")
            assert "xmin, 3 of 3 approaches" in words(b, "finding")
            assert "+0.0000 mm   3" in words(b, "finding")
            await b.press("right", "right", "m")
            assert "Z has no end switches (axes.z.end_switches)" in b.app.view.said[0]
            await b.press("right")
            await opens(b, "d")
            await b.press("enter")
            await b.wait(lambda: b.app._state.question != "")
            await settled(b, "escape")
            assert b.app.screen is b.app.view, "what was given up is not asked for"
            await opens(b, "n")
            await settled(b, "q", "enter")
            assert "is no end" in b.app.screen.query_one("#complaint", Fact).text

    play(scene)


def test_a_frequency_test_by_ear() -> None:
    async def scene() -> None:
        async with bench(config=MILL, clock="paced") as b:
            await b.press("f4", "h")
            assert "marks belong to a frequency test that runs" in b.app.view.said[0]
            await opens(b, "f")
            await b.press(*["backspace"] * 3, *"start", "tab", *"300", "tab", *"900", "tab")
            await b.press(*"200", "tab", *["backspace"] * 3, *"no", "enter")
            await b.wait(lambda: "now 300" in words(b, "finding"))
            assert "it resonates" in words(b, "proposal")
            await b.press("h")
            assert b.app.view.said[0] == "300 resonates."
            await b.wait(lambda: "now 500" in words(b, "finding"))
            await b.press("s")
            await b.settled()
            assert "bad at the lowest value already, 300" in words(b, "finding")
            assert "~" not in words(b, "finding").splitlines()[2]
            view = b.app.view
            assert isinstance(view, CalibrateView)
            test = view.calibration.frequency_test
            assert test is not None
            tried = test.facts().outcomes[Stage.START].tried
            assert [(each.value, each.marked) for each in tried] == [(300, True), (500, True)]

    play(scene)


def test_the_reference_run_in_words_and_the_switches_that_were_tried() -> None:
    async def scene() -> None:
        async with bench(config=MILL, hand=None) as b:
            said = []
            show = b.plant.controller.state

            def look() -> None:
                job = show().job
                if job is not None and job.doing not in said:
                    said.append(job.doing)
                b.app.link.offer()

            b.plant.controller.set_show_pos(look)
            await b.press("f4")
            await opens(b, "r")
            await settled(b, "y", "enter")
            assert [each for each in said if each.startswith("X")] == [
                "X: to the switch xmin", "X: off xmin, slowly, until it opens",
                "X: slowly to xmin again: this contact counts", "X: 2 mm off xmin",
            ]  # fmt: skip
            await b.press("e")
            b.hand("xmin", True)
            await b.wait(lambda: "xmin" in b.app.link.switches_tried)
            b.hand("xmin", False)
            await b.press("escape")
            await b.wait(lambda: "✓ xmin  · xmax" in words(b, "tried"))

    play(scene)


@pytest.mark.parametrize("size", [(80, 24), (200, 60), (40, 12), (20, 5)])
def test_it_fits_and_leaves_no_remains(size: tuple[int, int]) -> None:
    async def scene() -> None:
        async with bench(size=(120, 40), config=MILL) as b:
            await b.press("f4")
            await opens(b, "n")
            await settled(b, "enter")
            await b.pilot.resize_terminal(*size)
            await b.pilot.pause()
            view = b.app.view
            found = view.query_one("#found")
            assert found.region.right <= max(size[0], 30)
            if size[1] >= 24:
                assert view.query_one("#calibrate-finding").region.width >= 30
                assert "10 of 10 approaches" in words(b, "finding")
                await b.press("pagedown")
                assert found.scroll_y <= found.max_scroll_y

    play(scene)


def test_signs_do_not_depend_on_colour() -> None:
    values = tuple(float(n) for n in range(1, 11))
    tried = [Tried(v, marked=v in (3, 8, 9, 10)) for v in values]
    outcome = Outcome(Sweep(Stage.CRUISE, values, Rates(1, 1, 1)), tuple(tried))
    assert sweep_line(outcome, (*values, 11.0), 11) == "▪▪~▪▪▪▪×××·"
    assert sweep_line(outcome, values, 20) == "▪▪▪▪~~▪▪▪▪▪▪▪▪××××××"
    assert sweep_line(outcome, values, 5) == "▪~▪××", "the worst of those that share a place"
    assert (bar(0, 5, 10), bar(5, 5, 4), bar(1, 5, 10), bar(1, 1000, 4)) == ("", "████", "██", "▏")
    found = Repeatability("xmin", 4, Figures((0.0, 0.005, 0.005, 0.01)), 0.005, "mm")
    assert [line.split()[:3] for line in histogram(found, 40)] == [
        ["-0.0050", "mm", "1"], ["+0.0000", "mm", "2"], ["+0.0050", "mm", "1"]
    ]  # fmt: skip


def test_what_the_machine_refuses_is_said_in_the_dialog_and_can_be_mended() -> None:
    async def scene() -> None:
        async with bench(config=MILL) as b:
            await b.press("f4")
            await opens(b, "p")
            dialog = b.app.screen
            complaint = dialog.query_one("#complaint", Fact)
            way = dialog.query_one("#field-way", Input)
            way.value = "0.0001"
            await settled(b, "enter")
            await b.wait(lambda: "at least one step" in complaint.text)
            assert b.app.screen is dialog
            assert b.moved_steps == (0, 0, 0)
            way.value = "2"
            await b.press("enter")
            await b.wait(lambda: b.app.screen is not dialog)
            await b.wait(lambda: bool(b.drawn.question))

    play(scene)
