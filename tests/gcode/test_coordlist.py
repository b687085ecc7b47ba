from pathlib import Path

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import End, Feed, Move, Rapid
from fraese.gcode.coordlist import read_points
from fraese.gcode.reader import kind_of
from fraese.gcode.setup import Setup
from tests.gcode.run import read_moves


def points(text: str, feed_mm_min: float = 60, **setup: object) -> list[Move]:
    return list(read_points(text.splitlines(), Setup(**setup), feed_mm_min=feed_mm_min))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "text",
    [
        "1;2.5;3",
        "1,2.5,3",
        "1, 2.5, 3",
        "1 2.5 3",
        "1\t2.5\t3",
        "1;2,5;3",
        "1 2,5 3",
        "+1;25e-1;3.;",
    ],
)
def test_separators_and_decimal_commas(text: str) -> None:
    assert points(text) == [Feed(1, (1, 2.5, 3), 60), End(1)]


def test_feed_column_and_empty_cells() -> None:
    text = "# drilled\n0;0;5;600\n10,5;;;\n;1;;300 # slower\n\n2;2"
    assert points(text, feed_mm_min=0) == [
        Feed(2, (0, 0, 5), 600),
        Feed(3, (10.5, 0, 5), 600),
        Feed(4, (10.5, 1, 5), 300),
        Feed(6, (2, 2, 5), 300),
        End(6),
    ]


def test_units_and_columns_by_header() -> None:
    assert points("# unit: inch\nFeed;Y;X\n10;1;2", feed_mm_min=0)[0] == Feed(
        3, (50.8, 25.4, 0), 254
    )


def test_points_count_in_the_active_work_offset() -> None:
    assert points("1;2;3", parameters={5220: 2, 5241: 100})[0] == Feed(1, (101, 2, 3), 60)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("1;2;3", "line 1: there is no feed"),
        ("0;0;0;9\n1;b;3", "line 2: 'b' is not a number"),
        ("0;0;0;9\n1;nan;3", "'nan' is not a number"),
        ("0;0;0;9\n1;1e999;3", "is not a number"),
        ("0;0;0;9;5", "5 values stand where"),
        ("# unit: parsec\n1;2", "the unit 'parsec' is unknown"),
        ("x;x\n1;2", "each once"),
        ("0;0;0;9\n" + "1" * 5000, "longer than"),
    ],
)
def test_refusals(text: str, said: str) -> None:
    with pytest.raises(ProgramError, match=said):
        points(text, feed_mm_min=0)


@pytest.mark.parametrize(
    ("name", "text", "kind"),
    [
        ("a.ngc", "1;2;3", "gcode"),
        ("a.csv", "g0 x1", "points"),
        ("a.txt", "# unit: inch\n1;2;3", "points"),
        ("a.txt", "\n# a list\nx;y\n1;2", "points"),
        ("a.txt", ";1\nG21 G90\nG0 X1 Y2\nM2", "gcode"),
        ("a.txt", ";1;2\n3;4", "points"),
        ("a.txt", "(part)\ng0 x1", "gcode"),
        ("a", "#1=5\ng0 x#1", "gcode"),
        ("a", "n10 g0 x1", "gcode"),
        ("a", "", "gcode"),
    ],
)
def test_kind_of_file(tmp_path: Path, name: str, text: str, kind: str) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    assert kind_of(path) == kind


def test_both_kinds_give_moves(tmp_path: Path) -> None:
    path = tmp_path / "list.csv"
    path.write_text("1;2;3;4", encoding="utf-8")
    assert list(read_moves(path, Setup())) == [Feed(1, (1, 2, 3), 4), End(1)]
    path = tmp_path / "part.nc"
    path.write_text("g0x1", encoding="utf-8")
    assert list(read_moves(path, Setup())) == [Rapid(1, (1, 0, 0)), End(1)]
