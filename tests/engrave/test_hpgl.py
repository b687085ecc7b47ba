"""Plotter files: what draws is drawn where it says, what does not is told."""

import math

import numpy as np
import pytest

from fraese.engrave.hpgl import read
from fraese.engrave.hpgl.commands import PASSED, ROWS
from fraese.engrave.hpgl.plotter import UNIT_MM
from fraese.engrave.shapes import Path, bounds


def drawn(text: str) -> list[Path]:
    return read(text.encode("latin-1"), "a.plt").paths(0.01)


def notes(text: str) -> list[str]:
    return [note.removeprefix("a.plt: ") for note in read(text.encode("latin-1"), "a.plt").notes]


def corners(path: Path) -> list[tuple[float, float]]:
    """In plotter units."""
    return [(round(x, 3), round(y, 3)) for x, y in (path.points / UNIT_MM).tolist()]


def test_moves_absolute_and_relative_with_and_without_separators() -> None:
    for text in (
        "IN;PU10,20;PD30,20;PR0,40;PU;",
        "IN PU10 20PD30 20PR0 40PU",
        "inpu10,20pd30,20pr+0+40",
    ):
        (path,) = drawn(text)
        assert corners(path) == [(10, 20), (30, 20), (30, 60)]


@pytest.mark.parametrize("text", ["PU0,0;CI400;", "PU0,0;PD;CI400;PU;", "PU0,0;CI-400,5;"])
def test_a_circle_is_a_full_turn_round_the_pen(text: str) -> None:
    (path,) = [p for p in drawn("IN;" + text) if len(p.turns)]
    assert path.is_closed
    assert len(path.turns) == 1
    assert path.length_mm == pytest.approx(20 * math.pi)
    low, high = bounds([path])
    assert low.tolist() == pytest.approx([-10, -10])
    assert high.tolist() == pytest.approx([10, 10])


@pytest.mark.parametrize(
    ("text", "end", "turn"),
    [
        ("PU1000,0;PD;AA0,0,90;", (0, 1000), 1),
        ("PU1000,0;PD;AA0,0,-90;", (0, -1000), -1),
        ("PU1000,0;PD;AR-1000,0,180,5;", (-1000, 0), 1),
        ("PU1000,0;PD;AT0,1000,-1000,0;", (-1000, 0), 1),
        ("PU1000,0;PD;RT-1000,1000,-2000,0;", (-1000, 0), 1),
        ("PU1000,0;PD;AT0,-1000,-1000,0;", (-1000, 0), -1),
    ],
)
def test_arcs(text: str, end: tuple[float, float], turn: int) -> None:
    (path,) = drawn("IN;" + text)
    assert path.turns.tolist() == [turn]
    assert path.points[-1] / UNIT_MM == pytest.approx(end, abs=1e-6)
    assert path.centres[0] == pytest.approx([0, 0], abs=1e-9)


def test_three_points_in_a_line_are_a_line() -> None:
    (path,) = drawn("IN;PU0,0;PD;AT10,10,20,20;")
    assert not path.turns.any()


def test_shapes_are_closed_and_drawn_once() -> None:
    (square,) = drawn("IN;PU10,10;RA50,40;EA50,40;")
    assert square.is_closed
    assert corners(square) == [(10, 10), (50, 10), (50, 40), (10, 40), (10, 10)]
    (cake,) = drawn("IN;PU0,0;EW1000,0,90;")
    assert cake.is_closed
    assert cake.length_mm == pytest.approx(25 * (2 + math.pi / 2))
    (whole,) = drawn("IN;PU0,0;WG1000,0,360;")
    assert whole.length_mm == pytest.approx(50 * math.pi)


def test_polygons_have_edges_whether_the_pen_is_down_or_not() -> None:
    rings = drawn("IN;PU0,0;PM0;PA100,0,100,100,0,100;PM1;PU20,20;PD40,20,40,40;PM2;FP;EP;")
    assert [ring.is_closed for ring in rings] == [True, True]
    assert corners(rings[0]) == [(0, 0), (100, 0), (100, 100), (0, 100), (0, 0)]


def test_curves() -> None:
    (path,) = drawn("IN;PU0,0;PD;BZ0,1000,1000,1000,1000,0;PU;")
    assert path.points[-1] == pytest.approx([25, 0])
    assert path.points[:, 1].max() == pytest.approx(18.75, abs=0.01)
    (other,) = drawn("IN;PU50,50;PD;BR0,1000,1000,1000,1000,0;PU;")
    assert len(other.points) == len(path.points)


def encoded(flags: str, *values: int, first: int = 191) -> str:
    """Values of one digit behind flags: twice the number, and 1 more if it is negative."""
    return flags + "".join(chr(first + 2 * abs(value) + (value < 0)) for value in values)


def test_encoded_lines() -> None:
    text = encoded("PE:", 1) + encoded("<=", 10, 20) + encoded("", 3, -4)
    (path,) = drawn(f"IN;{text};PU;")
    assert corners(path) == [(10, 20), (13, 16)]
    # 7 bits: digits of five, the lowest first: 8 + 1 * 32 is 20 to the right.
    (seven,) = drawn(
        "IN;PE7<=" + chr(63 + 8) + encoded("", 0, first=96) + encoded("", 1, 3, -4, first=95) + ";"
    )
    assert corners(seven) == [(20, 1), (23, -3)]
    # Two bits behind the point.
    (fine,) = drawn("IN;" + encoded("PE>", 2) + encoded("<=", 6, 2) + encoded("", 4, 0) + ";")
    assert corners(fine) == [(1.5, 0.5), (2.5, 0.5)]


def test_user_units_are_scaled_turned_and_mirrored() -> None:
    (path,) = drawn("IN;IP0,0,1000,1000;SC0,10,0,10;PU1,1;PD2,1;SC;PD500,500;")
    assert corners(path) == [(100, 100), (200, 100), (500, 500)]
    (turned,) = drawn("IN;RO90;PU100,0;PD200,0;")
    assert corners(turned) == [(0, 100), (0, 200)]
    (arc,) = drawn("IN;IP0,0,1000,1000;SC10,0,0,10;PU0,0;PD;AA5,0,90;")
    assert arc.turns.tolist() == [-1]
    (oval,) = drawn("IN;IP0,0,2000,1000;SC0,10,0,10;PU5,5;CI2;")
    low, high = bounds([oval])
    assert high - low == pytest.approx([20, 10], abs=0.02)
    same = drawn("IN;IP0,0,2000,1000;SC0,10,0,10,1;PU5,5;CI2;")[0]
    assert same.turns.tolist() == [1]
    assert same.radii[0] == pytest.approx(5)


def test_what_draws_nothing_is_told_once() -> None:
    assert notes("IN;VS5;VS6;SP1;PU0,0;PD9,9;") == [
        "VS is passed over: the feed is what --feed says."
    ]
    said = notes("IN;LBone two\x03PU0,0;LBmore\x03PD5,5;XQ5;XQ5;SP1;SP2;LT2;")
    assert [text[:2] for text in said] == ["LB", "XQ", "SP", "LT"]
    assert '"one two"' in said[0]
    assert notes("IN;DT@;LBPD5,5@PU;PD1,1,2;AA5;") == [
        'LB: labels are not drawn, as in "PD5,5"; make lines of them in the program that they'
        " come from.",
        "PD in line 1 has 1 numbers too many; they are left out.",
        "AA in line 1 has 1 numbers and needs 3; it is passed over.",
    ]


def test_commands_of_the_device_are_no_commands() -> None:
    (path,) = drawn("\x1b.(\x1b.I81;;17:\x1b.N;19:\x1b%0BIN;PU0,0;PD10,0;\x1b.)")
    assert corners(path) == [(0, 0), (10, 0)]


def test_a_pen_that_only_comes_down_leaves_a_dot() -> None:
    paths = drawn("IN;PU10,10;PD;PU20,20;PD;PU;")
    assert [corners(path) for path in paths] == [[(10, 10)], [(20, 20)]]


def test_no_command_is_both_carried_out_and_passed_over() -> None:
    assert not set(ROWS) & set(PASSED)


def test_a_path_goes_on_over_pens_and_ends_that_meet() -> None:
    (path,) = drawn("IN;PU0,0;PD10,0;PU0,10;PD0,0;PU10,10;PD10,0;PU10,10;PD0,10;")
    assert path.is_closed
    assert path.length_mm == pytest.approx(40 * UNIT_MM)
    assert np.isfinite(path.points).all()
