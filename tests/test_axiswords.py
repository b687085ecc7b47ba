"""Axis words: one reader for the command line and the app."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.axiswords import axes_named, axis_words, listed, target, with_points
from fraese.errors import UsageError

AXES = ("x", "y", "z")


@pytest.mark.parametrize(
    ("text", "targets", "feed"),
    [
        ("X10 Y5 Z-1 F300", {"x": 10.0, "y": 5.0, "z": -1.0}, 300.0),
        ("x.5y-2", {"x": 0.5, "y": -2.0}, None),
        ("  Z +3. ", {"z": 3.0}, None),
        ("X1,5 Y,5", {"x": 1.5, "y": 0.5}, None),
        ("X10, Y5", {"x": 10.0, "y": 5.0}, None),
        ("X = 3 f0,5", {"x": 3.0}, 0.5),
    ],
)
def test_targets(text: str, targets: dict[str, float], feed: float | None) -> None:
    read = target(text, AXES)
    assert (read.targets_mm, read.feed_mm_min) == (targets, feed)
    if feed is None:
        assert axis_words(text, AXES) == targets


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "at least one axis"),
        ("F300", "at least one axis"),
        ("X1.2.3", '"X1.2.3" is not'),
        ("X", '"X" is not a letter with a number, such as X10 Y-2.5'),
        ("10", '"10" is not'),
        ("X1 Y1e3", "no axis E"),
        ("Xnan", '"Xnan" is not'),
        ("A5", "There is no axis A; this machine has X, Y and Z."),
        ("X1 X2", "X is given twice"),
        ("X1 F0", "above 0"),
        ("X1 F-5", "above 0"),
        ("X" + "9" * 400, "too large"),
    ],
)
def test_bad_targets_are_refused_in_one_sentence(text: str, said: str) -> None:
    with pytest.raises(UsageError, match=r"\.$") as caught:
        target(text, AXES)
    sentence = str(caught.value)
    assert said in sentence
    assert "\n" not in sentence


def test_a_feed_is_an_axis_like_any_other_where_none_is_wanted() -> None:
    with pytest.raises(UsageError, match="no axis F"):
        axis_words("X1 F300", AXES)


def test_which_letters_there_are_is_the_machines_affair() -> None:
    assert axis_words("a90 x1", ("x", "a")) == {"a": 90.0, "x": 1.0}
    with pytest.raises(UsageError, match="There is no axis Y; this machine has X and A"):
        axis_words("Y1", ("x", "a"))
    assert axes_named(["A", "xa"], ("x", "a")) == ["a", "x"]
    with pytest.raises(UsageError, match="There is no axis Q; this machine has X"):
        axes_named(["xq"], ("x",))
    assert listed(["x"]) == "X"


@given(st.integers(-999, 999), st.integers(0, 999), st.text("abc (),;1"))
def test_only_commas_of_numbers_become_points(whole: int, rest: int, remark: str) -> None:
    line = f"G1 X{whole},{rest} Y5 (about 1,5) ;{remark} 1,5"
    assert with_points(line) == f"G1 X{whole}.{rest} Y5 (about 1,5) ;{remark} 1,5"


def test_what_is_no_number_keeps_its_comma() -> None:
    assert with_points("X1, Y2 ,5 a,b") == "X1, Y2 ,5 a,b"
