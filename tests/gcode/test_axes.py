"""The language on machines of one to four axes, in any order; U, V and W, which rs274 has not."""

import pytest

from fraese.errors import ProgramError
from fraese.gcode.axes import Axes
from fraese.gcode.canon import Arc, Facts, Feed, Probe, Rapid
from fraese.gcode.coordlist import read_points
from fraese.gcode.extents import arc_extent
from fraese.gcode.setup import Setup
from fraese.tooldata import ToolData
from tests.gcode.run import answered, moves


@pytest.mark.parametrize(
    ("axes", "text", "said"),
    [
        ("xyz", "g0 a5", "there is no axis A on this machine; it has X, Y and Z"),
        ("xyza", "g0 u5", "there is no axis U on this machine; it has X, Y, Z and A"),
        ("xz", "g0 y5", "there is no axis Y on this machine; it has X and Z"),
        ("x", "g92 z1", "there is no axis Z on this machine; it has X"),
        ("xz", "g2 x10 i5 f100", "G2 in plane G17 needs axis Y, and this machine has only X and Z"),
        ("xy", "g18 g3 x10 i5 f100", "G3 in plane G18 needs axis Z"),
        ("xy", "f100 g81 x1 r1", "G81 in plane G17 works along axis Z"),
        ("xz", "g0 @5", "@ or ^ in plane G17 needs axis Y"),
        ("xz", "g10 l2 p1 r30", "G10 L2 R in plane G17 needs axis Y"),
        ("xyzu", "f100 g81 x1 z-1 r1 u2", "G81 is of X, Y and Z; move U before"),
        ("xyza", "g38.2 f10", "G38.2 needs an axis word"),
    ],
)
def test_what_a_machine_has_not_is_refused_by_name(axes: str, text: str, said: str) -> None:
    with pytest.raises(ProgramError) as refused:
        moves(text, axes=axes)
    assert said in str(refused.value)


def test_points_are_in_machine_order() -> None:
    assert moves("g0 x1 y2 z3 a4", axes="azyx")[0] == Rapid(1, (4, 3, 2, 1))
    assert moves("g0 x5", axes="x", position_mm=(1,))[0] == Rapid(1, (5,))
    arc = moves("g2 x10 i5 f1", axes="ayx")[0]
    assert arc == Arc(1, (0, 0, 10), (5, 0), 17, -1, 1)


def test_an_arc_without_its_third_axis_is_flat() -> None:
    arc = moves("g3 i5 f1", axes="yx")[0]
    assert isinstance(arc, Arc)
    low, high, length_mm = arc_extent((0, 0), arc, Axes("yx", ""))
    assert low == pytest.approx((-5, 0))
    assert high == pytest.approx((5, 10))
    assert length_mm == pytest.approx(31.41593)


def test_inches_are_for_lengths_and_degrees_stay_degrees() -> None:
    made = moves("g20 g0 x1 u1 a1 | g91 g1 f1 a1 u1 | g28.1 | a1", axes="xua")
    assert made[0] == Rapid(1, (25.4, 25.4, 1))
    assert made[1] == Feed(2, (25.4, 50.8, 2), 25.4)
    assert made[2] == Feed(4, (25.4, 50.8, 3), 1)
    # What is rotary is the machine's affair, not the letter's.
    assert moves("g20 g0 a1 | g1 f1 a2", axes="xa", rotary="")[:2] == [
        Rapid(1, (0, 25.4)),
        Feed(2, (0, 50.8), 25.4),
    ]


@pytest.mark.parametrize(
    ("text", "feed"),
    [
        ("x3 y4 u9 a90", 10),
        ("u3 v4 a90", 10),
        ("a3 b4", 10),
        ("u3", 6),
    ],
)
def test_inverse_time_counts_along_the_first_group_that_moves(text: str, feed: float) -> None:
    first = moves(f"g93 g1 f2 {text}", axes="xyuvab")[0]
    assert isinstance(first, Feed)
    assert first.feed_mm_min == pytest.approx(feed)


@pytest.mark.parametrize(
    ("text", "feed"),
    [
        ("g93 g90 g1 x0.3 a90 f2", 180),
        ("g20 f300 | g21 g90 g1 x0.3 a90", 300),
    ],
)
def test_a_remain_of_a_sum_is_no_way_that_a_feed_counts_along(text: str, feed: float) -> None:
    before = "g91 f600 | g1 x0.1 | x0.1 | x0.1 |"
    last = moves(f"{before} {text}", axes="xyza")[-2]
    assert isinstance(last, Feed)
    assert last.feed_mm_min == pytest.approx(feed)


def test_a_feed_of_angles_is_the_word_itself() -> None:
    feeds = [
        move.feed_mm_min
        for move in moves("g20 | f10 g1 a5 | x1 a6 | g21 a7 | x0 | f20 a8 | g93 a9 f1", axes="xa")
        if isinstance(move, Feed)
    ]
    assert feeds == [10, 254, 10, 254, 20, 1]


def test_tables_of_parameters_have_a_place_for_each_axis() -> None:
    text = "g20 g0 u1 | g28.1 | g92 u3 | g10 l2 p2 u4 w5"
    _, interpreter = answered(text, axes="xuw")
    kept = interpreter.parameters
    assert [kept.get(n) for n in (5167, 5169, 5217, 5247, 5249)] == pytest.approx(
        [25.4, 0, -50.8, 101.6, 127]
    )
    assert [kept.get(n) for n in (5420, 5423, 5426)] == pytest.approx([0, 0, 3])


def test_a_probe_answers_for_every_axis() -> None:
    facts = Facts((1, 2, 3, 4), touched=True, contact_mm=(1, 2, 3, 5))
    made, interpreter = answered("g20 | g38.2 u1 a9 f5", facts, axes="xyua")
    assert made[0] == Probe(2, (0, 0, 25.4, 9), 127, True, True)
    got = [interpreter.parameters.get(n) for n in (5061, 5062, 5064, 5067, 5070)]
    assert got == pytest.approx([1 / 25.4, 2 / 25.4, 5, 3 / 25.4, 1])


def test_a_tool_has_an_offset_for_each_axis() -> None:
    tools = {1: ToolData(3.0, others={"u": 0.5})}
    text = "g43 h1 | g0 x0 z0 u0 | g10 l1 p1 a7 | g43 h1 | g0 a0"
    made = moves(text, axes="xzua", tools=tools)
    assert [move.to for move in made if isinstance(move, Rapid)] == [
        (0, 3, 0.5, 0),
        (0, 3, 0.5, 7),
    ]


def test_a_list_has_as_many_columns_as_the_machine_has_axes() -> None:
    setup = Setup(axes="xyza")
    assert list(read_points(["1;2;3;90;60", ";;;180;"], setup))[:2] == [
        Feed(1, (1, 2, 3, 90), 60),
        Feed(2, (1, 2, 3, 180), 60),
    ]
    lines = ["# unit: inch", "a;x;feed", "90;1;2", "180;;"]
    assert list(read_points(lines, setup))[:2] == [
        Feed(3, (25.4, 0, 0, 90), 50.8),
        Feed(4, (25.4, 0, 0, 180), 2),
    ]
    with pytest.raises(ProgramError, match="there is no axis U on this machine"):
        list(read_points(["x;u"], setup))
    with pytest.raises(ProgramError, match="3 values stand where x, feed are expected"):
        list(read_points(["1;2;3"], Setup(axes="x")))
