"""The toolpath as dots: clipped, projected, layered; and the facts of a briefing."""

from datetime import datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.control.state import JobProgress, MachineState, Status
from fraese.dots import BRAILLE, HALVES, Cell, Dots
from fraese.program.check import Complaint, Facts
from fraese.program.outline import Outline
from fraese.program.wants import Wants
from fraese.ui.briefing import lines, may_start, problems
from fraese.ui.shape import AxisShape, Shape
from fraese.ui.widgets.progress import bar, times
from fraese.ui.widgets.projection import ISO, SIDES, XY, Projection, box_edges, round_length_mm
from fraese.ui.widgets.scene import Scene, travel_box


def text(dots: Dots) -> list[str]:
    return [
        "".join(dots.cell.characters[n] for n in dots.row(y)[0].tolist())
        for y in range(dots.height)
    ]


def drawn(cell: Cell, *ends: tuple[tuple[float, float], tuple[float, float]]) -> list[str]:
    dots = Dots(4, 2, 2, cell)
    for begin, end in ends:
        dots.lines(0, np.array([begin], float), np.array([end], float))
    return text(dots)


def test_a_line_is_dots() -> None:
    assert drawn(BRAILLE, ((0, 0), (7, 0))) == ["⠉⠉⠉⠉", "    "]
    assert drawn(BRAILLE, ((0, 0), (0, 7))) == ["⡇   ", "⡇   "]
    assert drawn(BRAILLE, ((0, 0), (7, 7))) == ["⠑⢄  ", "  ⠑⢄"]
    assert drawn(HALVES, ((0, 0), (3, 3))) == ["▀▄  ", "  ▀▄"]


def test_a_line_is_clipped_and_one_outside_is_nothing() -> None:
    far = 1e9
    assert drawn(BRAILLE, ((-far, 0.5), (far, 0.5))) == ["⠉⠉⠉⠉", "    "]
    assert drawn(BRAILLE, ((-far, -far), (far, far))) == ["⠑⢄  ", "  ⠑⢄"]
    assert drawn(BRAILLE, ((-5, -5), (-5, 9)), ((9, 0), (20, 4))) == ["    ", "    "]


@given(st.lists(st.tuples(*[st.floats(-50, 50)] * 4), min_size=1, max_size=20))
def test_no_line_leaves_the_field(ends: list[tuple[float, ...]]) -> None:
    dots = Dots(4, 2, 1)
    numbers = np.array(ends, float)
    rows = dots.lines(0, numbers[:, :2], numbers[:, 2:])
    assert set(rows.tolist()) <= {0, 1}
    assert dots.dots.any() == bool(len(rows))


def test_a_cell_has_the_colour_of_its_highest_layer() -> None:
    dots = Dots(4, 1, 3)
    dots.lines(0, np.array([[0.0, 0.0]]), np.array([[7.0, 0.0]]))
    dots.lines(2, np.array([[0.0, 3.0]]), np.array([[3.0, 3.0]]))
    numbers, layers = dots.row(0)
    assert layers.tolist() == [2, 2, 0, 0]
    assert [BRAILLE.characters[n] for n in numbers.tolist()] == ["⣉", "⣉", "⠉", "⠉"]


@pytest.mark.parametrize("side", SIDES)
def test_all_is_seen_from_every_side(side: object) -> None:
    corners = box_edges((0, 0, -20), (300, 200, 0)).reshape(-1, 3)
    seen = Projection(side, 160, 80).fitted(corners)  # type: ignore[arg-type]
    dots = seen.dots(corners)
    assert dots.min() >= 1
    assert (dots.max(axis=0) <= (159, 79)).all()


def test_up_is_up() -> None:
    seen = Projection(XY, 100, 100)
    assert seen.dots((0, 10, 0))[0][1] < seen.dots((0, 0, 0))[0][1]
    seen = Projection(ISO, 100, 100)
    assert seen.dots((0, 0, 10))[0][1] < seen.dots((0, 0, 0))[0][1]


def test_what_lies_under_the_pointer_stays_there() -> None:
    seen = Projection(XY, 100, 60, (7.0, 3.0), 2.0)
    place = (12.0, 9.0, 0.0)
    column, row = seen.dots(place)[0]
    nearer = seen.zoomed(4, column, row)
    assert nearer.dots(place)[0] == pytest.approx((column, row))
    assert nearer.dots_per_mm == 8
    assert seen.zoomed(1e9).zoom == 500
    assert seen.panned(10, 0).dots(place)[0] == pytest.approx((column - 10, row))


@pytest.mark.parametrize(("per_mm", "length"), [(1, 10), (0.3, 50), (7, 2), (100, 0.1)])
def test_a_scale_is_round(per_mm: float, length: float) -> None:
    assert round_length_mm(per_mm, 19) == pytest.approx(length)


def test_the_move_in_hand_and_what_is_done_are_found() -> None:
    moves = np.array([0, 1, 2, 2, 2, 5])
    points = np.zeros((6, 3), np.float32)
    way = Outline(points, moves.astype(np.int32), moves.astype(np.int32), moves == 1)
    scene = Scene(way)
    assert scene.span(2) == (2, 5)
    assert scene.span(3) == (5, 5)
    assert scene.done() == (1, 1)
    scene.first, scene.last = 2, 5
    assert scene.done() == (2, 5)


# --- what is said before a start -----------------------------------------------------------------

SHAPE = Shape(tuple(AxisShape(name, "mm", 0.005) for name in "xyz"), "half-step")


def state(**facts: object) -> MachineState:
    known: dict[str, object] = {
        "status": Status.OK, "message": "", "axes": ("x", "y", "z"),
        "position_steps": (0, 0, 0), "position_mm": (0.0, 0.0, 0.0), "work_mm": (0.0, 0.0, 0.0),
        "offset_mm": (0.0, 0.0, 0.0), "referenced": (True, True, True),
        "low_mm": (0.0, 0.0, -50.0), "high_mm": (300.0, 200.0, 0.0),
    }  # fmt: skip
    return MachineState(**{**known, **facts})  # type: ignore[arg-type]


def found(**facts: object) -> Facts:
    known: dict[str, object] = {
        "errors": (), "outside": (), "low_mm": (1.0, 2.0, -3.0), "high_mm": (4.0, 5.0, -1.0),
        "duration_s": 75.0, "length_mm": 10.0, "lines": 9, "blocks": 3,
        "wants": Wants((1, 2), (8000.0, 12000.0), 2, 1, 0),
    }  # fmt: skip
    return Facts(**{**known, **facts})  # type: ignore[arg-type]


def test_a_briefing_names_what_counts() -> None:
    said = {line.label: (line.text, line.tone) for line in lines(found(), state(), SHAPE)}
    assert said["X"] == ("1.000 … 4.000 in 0 … 300 mm", "-good")
    assert said["time"][0] == "1:15"
    assert said["tools"][0].startswith("T1 T2")
    assert said["spindle"][0] == "8000 to 12000 rev/min"
    assert said["stops"][0] == "2 for you, 1 at M1 (passed)"
    assert said["referenced"] == ("all axes", "-good")
    assert problems(found(), state()) == []


def test_a_briefing_is_loud_about_what_is_wrong() -> None:
    facts = found(
        high_mm=(400.0, 5.0, -1.0),
        errors=(Complaint(3, "Q is no word"),),
        outside=(Complaint(9, "X 400 mm is outside"),),
    )
    stands = state(referenced=(True, False, True), switch_ignored=True)
    said = {line.label: (line.text, line.tone) for line in lines(facts, stands, SHAPE)}
    assert said["X"][1] == "-alarm"
    assert "OUTSIDE" in said["X"][0]
    assert said["Y"][1] == "-warn"
    assert "IGNORED" in said["switches"][0]
    wrong = problems(facts, stands, "part.nc has changed on disk since it was opened.")
    assert [(problem.line, problem.stops) for problem in wrong] == [
        (3, True), (9, True), (0, False), (0, False), (0, False),
    ]  # fmt: skip
    assert not may_start(wrong)
    assert may_start(wrong[2:])
    assert wrong[0].words == "✗ line 3: Q is no word"


def test_the_travel_is_drawn_where_it_is_known() -> None:
    assert travel_box(state()) == ((0, 0, -50), (300, 200, 0))
    assert travel_box(state(referenced=(True, True, False))) is None


# --- progress ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("share", "drawn"), [(0, "░░░░"), (1, "████"), (0.5, "██░░"), (0.3, "█▎░░"), (7, "████")]
)
def test_a_bar_counts_eighths(share: float, drawn: str) -> None:
    assert bar(share, 4) == drawn


def test_times_say_done_left_and_the_end_by_the_clock() -> None:
    now = datetime(2026, 1, 2, 14, 50)
    job = JobProgress("part.nc", elapsed_s=65, left_s=900)
    assert times(job, waits=False, now=now) == "1:05 done   15:00 left   ends 15:05"
    assert times(job, waits=True, now=now) == "1:05 done   15:00 left   waits"
    assert times(JobProgress("part.nc", elapsed_s=5), waits=False, now=now) == "0:05 done"
