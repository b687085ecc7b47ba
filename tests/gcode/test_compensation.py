"""Cutter compensation where the judge has no say; the paths themselves are in tests/judge."""

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import Arc, Dwell, End, Facts, Feed, Message, Move, Pause, Rapid, Spindle
from fraese.tooldata import ToolData
from tests.gcode.run import answered, moves

TOOLS = {2: ToolData(0.0, 4.0)}
#: A pocket, cut from inside: G41, all corners are inside ones.
POCKET = "f100 g41 d2 g1 x20|y10|x0|y0|x20|y5|g40 g0 x10 y5"


def ways(text: str) -> list[Move]:
    return [move for move in moves(text, tools=TOOLS) if not isinstance(move, End)]


def test_a_pocket_is_cut_inside_its_outline() -> None:
    assert [getattr(move, "to", None) for move in ways(POCKET)] == [
        pytest.approx(place)
        for place in [(18, 2, 0), (18, 8, 0), (2, 8, 0), (2, 2, 0), (18, 2, 0), (18, 5, 0)]
    ] + [(10, 5, 0)]


def test_an_island_is_cut_round_its_corners() -> None:
    result = ways("f100 g42 d2 g1 x20|y10")
    assert result == [
        Feed(1, (20, -2, 0), 100),
        Arc(2, (22, 0, 0), (20, 0), 17, 1, 100),
        Feed(2, (22, 10, 0), 100),
    ]


def test_what_happens_meanwhile_stays_behind_the_shortened_move() -> None:
    text = "f100 g41 d2 g1 x20|m3 s9|g4 p1|(msg,here)|m0|z-1|y10|m2"
    result, _ = answered(text, None, tools=TOOLS)
    kinds = [type(move) for move in result]
    assert kinds == [Feed, Spindle, Dwell, Message, Pause, Feed, Feed, Spindle, End]
    assert [move.to for move in result if isinstance(move, Feed)] == [
        pytest.approx(place) for place in [(18, 2, 0), (18, 2, -1), (18, 10, -1)]
    ]


def test_where_the_machine_stands_at_a_stop_does_not_change_the_path() -> None:
    text = "f100 g41 d2 g1 x20|m0|g91 y10|g40"
    with_answer, _ = answered(text, Facts((1, 2, 3)), tools=TOOLS)
    without, _ = answered(text, None, tools=TOOLS)
    assert with_answer == without


def test_inches_and_a_rotated_system() -> None:
    (inch,) = ways("g20 f10 g41.1 d.2 g1 x1")
    assert isinstance(inch, Feed)
    assert inch.to == pytest.approx((25.4, 2.54, 0))
    assert inch.feed_mm_min == 10
    (turned,) = ways("g10 l2 p1 r90|f10 g41 d2 g1 x10")
    assert isinstance(turned, Feed)
    assert turned.to == pytest.approx((-2, 10, 0))


def test_a_radius_of_nothing_changes_no_path() -> None:
    assert ways("f9 g41.1 d0 g1 x1|g2 x3 i1|g40|g2 x4 i.5")[0] == Feed(1, (1, 0, 0), 9)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("g41 d2|g1 x1", "line 2: the way to the path has to be longer .* 2 mm"),
        ("g41 d2|g1 x20|y1|x0", "line 4: the cutter cannot go through this inside corner"),
        ("g41 d2|g1 x20|g3 x21 y1 j1", "line 3: the arc of radius 1 mm is too narrow .* 2 mm"),
        ("g41 d2|g1 x20|y1|y2|y30", "line 4: the cutter cannot go through this inside corner"),
        ("g41 d2|g3 x-5 i-2.5 j9", "line 2: no such arc leads from here"),
        ("g41 d2|g1 x20|g40|g2 x30 i5", "line 4: behind G40 the first move has to be straight"),
        ("g41 d2|g1 x20|g43 h2", "G43 changes the tool's length, .* while cutter compensation"),
        ("g41 d2|g1 x20|m6 t2", "M6 changes the tool"),
        ("g41 d2|g1 x20|g18", "the plane cannot be changed"),
        ("g41 d2|g1 x20|g28", "G28 is not possible while"),
        ("g41 d2|g1 x20|g81 x1 z-1 r1", "G81 is not possible while"),
        ("g41 d2|g1 x20|#1=#5421", "the position cannot be read"),
        ("g41 d2|g42 d2", "on already"),
        ("g19 g41 d2", "planes G17 and G18"),
        ("g41.1", "G41.1 needs a D word"),
        ("g41 d7", "tool 7 is not in the tool table"),
        ("g10 l2 p1 r9|g18 g41 d2", "a rotated coordinate system"),
    ],
)
def test_refused(text: str, said: str) -> None:
    with pytest.raises(ProgramError, match=said):
        moves("f100 " + text, tools=TOOLS, file="p.ngc")


def test_without_a_tool_table_no_diameter_is_made_up() -> None:
    with pytest.raises(ProgramError, match=r"no tool table; give the diameter itself by G41\.1 D"):
        moves("f100 g41 d2")
    assert moves("f100 g41.1 d4 g1 x9")[0] == Feed(1, (9, 2, 0), 100)


def test_a_rapid_goes_round_no_corner() -> None:
    assert ways("f100 g41 d2 g0 x20|y-9") == [
        Rapid(1, (20, 2, 0)),
        Rapid(2, (22, 0, 0)),
        Rapid(2, (22, -9, 0)),
    ]
