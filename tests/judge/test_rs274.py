"""What the judge says is understood: shapes of lines that were once passed over or misread."""

from pathlib import Path

import pytest

from tests.judge.compare import disagreement
from tests.judge.rs274 import REASON, RS274, judge

pytestmark = pytest.mark.skipif(RS274 is None, reason=REASON)


@pytest.mark.parametrize("number", ["5", "99999", "100000", "123456", "1234567"])
def test_a_line_number_of_any_length_hides_no_call(tmp_path: Path, number: str) -> None:
    verdict = judge(f"g21\nn{number} g0 x1 y2 z3\nm2\n", tmp_path)
    assert verdict.events[0] == ("rapid", (1.0, 2.0, 3.0))


def test_centres_in_every_plane_are_in_the_order_of_its_axes(tmp_path: Path) -> None:
    text = "g21 f100 g0 x1 y2 z3\ng17 g2 i4 j5\ng18 g2 i4 k5\ng19 g2 j4 k5\nm2\n"
    arcs = [event for event in judge(text, tmp_path).events if event[0] == "arc"]
    assert [(plane, centre) for _, _, centre, plane, *_ in arcs] == [
        (17, (5.0, 7.0)),
        (18, (8.0, 5.0)),
        (19, (6.0, 8.0)),
    ]


def test_no_tool_table_is_every_tool_at_length_nothing(tmp_path: Path) -> None:
    assert not disagreement("g21 t1 m6\ng43 h1\ng0 z0\ng43 h77\ng0 z1\nm2\n", tmp_path)
    assert judge("t1 m6\nm2\n", tmp_path, {}).refused
