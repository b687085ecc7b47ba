"""What is passed over with a word: axes that the machine has not, and codes of the user's own."""

import pytest

from fraese.errors import ProgramError
from fraese.gcode.canon import End, Feed, Message, Rapid
from tests.gcode.run import moves


def test_a_rotary_axis_that_stands_at_zero() -> None:
    text = "g0 x1 a0.|y2 a0 b-0|a0|g1 f9 x3 a[1-1]|g91 x1 a0"
    assert moves(text) == [
        Message(1, "A0 is passed over: this machine has no axis A", "note"),
        Rapid(1, (1, 0, 0)),
        Message(2, "B0 is passed over: this machine has no axis B", "note"),
        Rapid(2, (1, 2, 0)),
        Feed(4, (3, 2, 0), 9),
        Feed(5, (4, 2, 0), 9),
        End(5),
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("g0 a5", "there is no axis A"),
        ("g0 u0", "there is no axis U"),
        ("g28 a0", "G28 with A alone has nothing to do"),
        ("g92 a0", "G92 with A alone has nothing to do"),
        ("g38.2 a0 f9", "needs an axis word"),
    ],
)
def test_what_would_mean_something_is_refused(text: str, said: str) -> None:
    with pytest.raises(ProgramError, match=said):
        moves(text)


def test_where_there_is_such_an_axis_it_moves() -> None:
    assert moves("g0 a0", axes="xyza")[0] == Rapid(1, (0, 0, 0, 0))


def test_a_users_own_code() -> None:
    with pytest.raises(ProgramError, match=r"M101 is a user's own code.* run\.ignored_m_codes"):
        moves("m101")
    with pytest.raises(ProgramError, match="M200 is not a known code"):
        moves("m200")
    ignored = frozenset({101, 199})
    assert moves("m101 p1 q2|g0 x1 m199|m101", ignored_m_codes=ignored) == [
        Message(1, "M101 is passed over", "note"),
        Message(2, "M199 is passed over", "note"),
        Rapid(2, (1, 0, 0)),
        End(3),
    ]
    with pytest.raises(ProgramError, match="M100 is a user's own"):
        moves("m100", ignored_m_codes=ignored)


@pytest.mark.parametrize("text", ["g18|g0 @5", "g19|g0 ^5", "g18 g0 @5"])
def test_polar_words_are_of_one_plane(text: str) -> None:
    with pytest.raises(ProgramError, match="of the plane G17"):
        moves(text)
