"""What programs have that LinuxCNC refuses, and that says one thing only."""

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import End, Feed, Rapid, Spindle
from tests.gcode.run import moves

HERE = (0.0, 0.0, 0.0)
ONE = (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("g21|g0 x1|%", 2),
        ("g21|g0 x1|%|(end)||", 2),
        ("(head)|%|g0 x1|%|g0 x2", 3),
        ("m98 p1|m30|%|o1|g0 x1|m99", 5),
        ("m98 p1|m30|%|o1|g0 x1|m99|%", 5),
        ("m98 p1|%|o1|g0 x1|m99", 4),
        ("m98 p1|m30|:1|g0 x1|m99", 4),
        (":1000|g0 x1", 2),
        ("n20 :1000 (name)|g0 x1", 2),
        ("n123456 g0 x1", 1),
        ("n12345678 g0 x1", 1),
        ("g80 g80|g0 x1", 2),
        ("g17 g17 m5 m5 g0 g0 x1", 1),
        ("g20 g70|g21 g71|g0 x1", 3),
        ("g15 g40.1 g50 g50.1 g69 g80 g49 g23 g67 g13.1|g0 x1", 2),
    ],
)
def test_understood(text: str, line: int) -> None:
    result = [move for move in moves(text) if not isinstance(move, End | Spindle)]
    assert result == [Rapid(line, ONE)]


def test_the_way_home_with_a_motion_on_its_line() -> None:
    text = "g0 x5 z3|g10 l2 p1 z1|g0 g91 g28 z0|x1|f9 g1 g28 z2|x1"
    assert [move for move in moves(text) if not isinstance(move, End)] == [
        Rapid(1, (5, 0, 3)),
        Rapid(3, (5, 0, 3)),
        Rapid(3, (5, 0, 0)),
        Rapid(4, (6, 0, 0)),
        Rapid(5, (6, 0, 2)),
        Rapid(5, (6, 0, 0)),
        Feed(6, (7, 0, 0), 9),
    ]


def test_g70_and_g71_are_inch_and_mm() -> None:
    assert moves("g70 g0 x1|g71 x1")[:2] == [Rapid(1, (25.4, 0, 0)), Rapid(2, ONE)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("g0 x1|%|g0 x2", r"line 3: this stands behind the '%' in line 2, which ends the program"),
        ("%|m98 p1|m30|%|o1|g0 x1|m99", "no O1 follows"),
        ("g71 p10 q20", "with P or Q it is a lathe's cycle"),
        ("g20 g71", "contradict each other"),
        ("g0 x1 g0 y2", "given twice"),
        ("g53 g53 g0 x1", "given twice"),
        ("m6 m6", "given twice"),
        ("g50 s2000", "G50 ends scaling"),
        ("g50 x1", "G50 ends scaling"),
        ("g51 x2", "scaling is not supported"),
        ("g68 r30", "G10 L2 R"),
        ("g16", "@ and"),
        ("g54.1 p1", "nine work coordinate systems"),
        ("g92 x1 g0", "both use axis words"),
    ],
)
def test_refused_where_it_would_mean_something_else(text: str, said: str) -> None:
    with pytest.raises(ProgramError, match=said):
        moves(text, file="p.ngc")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("g1 x1e-05 y2", "'1e-05' is a number with an exponent.* write it out: 0.00001"),
        ("g1 x10 f1E3", "'1E3' is a number with an exponent.* write it out: 1000"),
        ("g1 x1e400", "'1e400' is a number with an exponent.* larger than any place"),
        ("g1 x1 e2", "extruder"),
        ("g76 p.05 z-1 i-.1 j.02 k.04 e2 l3", "G76 is refused"),
        ("hello world", "'hello world' is no G-code"),
        ("<html>", "'<html>' is no G-code"),
        ('{"a": 1}', "is no G-code"),
        ("BEGIN PGM X MM", "'BEGIN PGM X MM' is no G-code"),
        ("IN;PU;SP1;", "'IN' is no G-code"),
        ("g0 x1 fast", "'fast' is no word of G-code"),
        ("#<a b>=3 rest", "'rest' is no word of G-code"),
        ("g0 x1,5", "write a point"),
        ("g0 x1 // here", "a remark stands in brackets"),
        ("g0 x1 # here", "a remark stands in brackets"),
        ("0 0 5", "numbers without letters"),
        ("%1234", "'%' stands alone"),
        ("g0 x1 y", "between 'Y' and the end of the line"),
        ("g0 xfoo[1]", "no word"),
    ],
)
def test_text_that_is_no_g_code_is_named(line: str, said: str) -> None:
    with pytest.raises(ProgramError, match=said):
        moves("g21 f100|" + line, file="p.ngc")


@pytest.mark.parametrize("line", ["g0 xsin[30]", "g0 x[7 mod 3]", "#<a b>=1 (fast)", "g0 x1 ;1e5"])
def test_what_is_g_code_is_not(line: str) -> None:
    moves(line)
