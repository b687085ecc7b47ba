"""What Move does besides jogs: typed lines, positions, the way to zero, offsets, probing."""

from pathlib import Path

import pytest
from textual.widgets import Input

from fraese.ui.dialogs.byhand import ProbeDialog, SetDialog, TypedDialog
from fraese.ui.dialogs.tables import OffsetsDialog
from fraese.ui.linehistory import MOST_LINES, LineHistory
from fraese.ui.widgets.fact import Fact
from tests.helpers import touching_at
from tests.ui.helpers import Bench, bench, play


async def enter(b: Bench, text: str) -> None:
    """Into the line of the dialog that is open; what it had is gone."""
    b.app.screen.query_one("#line", Input).value = ""
    await b.type(text)
    await b.press("enter")
    await b.settled()


def shows_view(b: Bench) -> bool:
    return b.app.screen is b.view


def complaint(b: Bench) -> str:
    return b.app.screen.query_one("#complaint", Fact).text


def test_lines_are_typed_one_after_the_other_and_come_back(tmp_path: Path) -> None:
    async def scene() -> None:
        file = tmp_path / "deep" / "lines"
        async with bench(history=file) as b:
            await b.press("m")
            assert isinstance(b.app.screen, TypedDialog)
            await enter(b, "X3 Y1")
            assert b.moved_steps == (600, 200, 0)
            await enter(b, "g91 g1 x-1 f600")
            assert b.moved_steps == (400, 200, 0)
            await enter(b, "G123")
            assert "G123" in complaint(b)
            line = b.app.screen.query_one("#line", Input)
            assert line.value == "G123", "what was refused can be mended"
            await enter(b, "g55")
            assert b.drawn.work.system == "G55"
            assert complaint(b) == ""
            await b.press("up", "up")
            assert line.value == "g91 g1 x-1 f600"
            await b.press("down", "down")
            assert line.value == ""
            await b.press("escape")
            assert shows_view(b)
        assert LineHistory(file).lines == ["X3 Y1", "g91 g1 x-1 f600", "g55"]

    play(scene)


def test_a_history_is_bounded_and_never_a_fault(tmp_path: Path) -> None:
    history = LineHistory(tmp_path)  # a folder: neither read nor written
    for n in range(MOST_LINES + 50):
        history.add(f"X{n}")
    history.add(f"X{MOST_LINES}")
    assert len(history.lines) == MOST_LINES
    assert history.lines[-1] == f"X{MOST_LINES}"
    assert history.lines.count(f"X{MOST_LINES}") == 1


def test_a_place_out_of_range_leaves_the_dialog_open_and_the_position_to_be_seen() -> None:
    async def scene() -> None:
        async with bench() as b:
            number = b.view.query_one("#axis-z AxisNumber").region
            await b.press("g")
            await enter(b, "X1000")
            assert "further than its whole travel" in complaint(b)
            assert b.app.screen.query_one(".dialog").region.y >= number.bottom
            await enter(b, "X2")
            assert shows_view(b)
            assert b.moved_steps == (400, 0, 0)

    play(scene)


def test_escape_in_a_line_stops_first_and_closes_at_standstill() -> None:
    async def scene() -> None:
        async with bench(clock="paced") as b:
            await b.press("m")
            await b.type("X300")
            await b.press("enter")
            await b.wait(lambda: b.plant.controller.state().speed_mm_min > 0)
            await b.press("escape")
            await b.settled()
            assert isinstance(b.app.screen, TypedDialog)
            assert 0 < b.moved_steps[0] < 60_000
            await b.press("escape")
            assert shows_view(b)

    play(scene)


def test_the_present_position_is_set_halved_and_touched_off() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.jog("right", "right", "up", "up", "pageup")
            await b.press("n")
            assert isinstance(b.app.screen, SetDialog)
            await enter(b, "X/2 Z12,5")
            assert b.drawn.work_mm == (1, 2, 12.5)
            await b.press("b")
            await b.settled()
            assert b.drawn.work_mm == (0, 0, 12.5)
            await b.press("n")
            await enter(b, "Q/2")
            assert "no axis Q" in complaint(b)
            assert b.drawn.position_mm == (2, 2, 1), "nothing has moved for it"

    play(scene)


def test_the_work_zero_is_gone_to_by_a_safe_way() -> None:
    async def scene() -> None:
        async with bench() as b:
            b.app.link.zero("xyz", "u")
            await b.settled()
            await b.jog("right", "up")
            await b.press("G")
            await b.settled()
            assert b.drawn.work_mm == (0, 0, 0)
            assert b.plant.controller.travelled_steps()[2] == 2 * 5 * 200

    play(scene)


def test_work_offsets_are_shown_chosen_changed_and_cleared() -> None:
    async def scene() -> None:
        async with bench() as b:
            await b.press("f")
            assert isinstance(b.app.screen, OffsetsDialog)
            shown = b.app.screen.query_one("#systems", Fact)
            await b.wait(lambda: shown.text.startswith("▶G54"))
            assert shown.text.count("G5") == 9
            await enter(b, "G59.3 X10 Z-2")
            await b.wait(lambda: "X  10.000" in shown.text)
            await enter(b, "g59.3")
            await b.wait(lambda: "▶G59.3" in shown.text)
            assert b.drawn.work_mm == (-10, 0, 2)
            await enter(b, "G59.3 clear")
            assert b.drawn.work_mm == (0, 0, 0)
            await enter(b, "G60")
            assert "no work offset G60" in complaint(b)

    play(scene)


def test_a_plate_is_probed() -> None:
    async def scene() -> None:
        async with bench() as b:
            touching_at(b.plant, b.mill.look().carriages_steps[2] - 1000)
            await b.press("p")
            assert isinstance(b.app.screen, ProbeDialog)
            await b.press("down", "up")
            await enter(b, "weight 3")
            assert "knows no" in complaint(b)
            await enter(b, "thickness 2 reach 8")
            assert shows_view(b)
            assert b.drawn.offset_mm[2] == pytest.approx(-7, abs=0.02)
            assert b.drawn.work_mm[2] == pytest.approx(4, abs=0.02)

    play(scene)
