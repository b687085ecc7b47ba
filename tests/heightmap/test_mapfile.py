"""Height maps in files: what is written is read, and what is wrong is said."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.errors import ProgramError
from fraese.heightmap.mapfile import PartMap, decoded, encoded
from tests.fuzz.lengths import fuzzed, is_a_sentence, refusal_of

_HEIGHT = st.none() | st.floats(-10, 10)
_LINES = st.lists(st.floats(-1000, 1000), min_size=2, max_size=5, unique=True).map(
    lambda places: tuple(sorted(places))
)


@st.composite
def parts(draw: Any) -> PartMap:
    x_mm, y_mm = draw(_LINES), draw(_LINES)
    place = st.tuples(st.floats(-1000, 1000), st.floats(-1000, 1000))
    rows = tuple(draw(st.tuples(*[_HEIGHT] * len(x_mm))) for _ in y_mm)
    return PartMap(x_mm, y_mm, rows, draw(place), draw(st.integers(1, 9)), draw(st.none() | place))


GOOD = PartMap((0.0, 10.0, 20.0), (0.0, 5.0), ((0.0, 0.1, 0.2), (0.3, None, 0.5)))


@given(parts())
def test_what_is_written_is_read(part: PartMap) -> None:
    assert decoded(encoded(part), "board.map") == part


def test_a_row_of_the_grid_is_a_line() -> None:
    assert "\n    [0.3, null, 0.5]\n" in encoded(GOOD)


def test_what_is_missing_is_counted() -> None:
    assert (GOOD.missing, GOOD.points) == (1, 6)
    with pytest.raises(ValueError, match="missing"):
        GOOD.whole()


def _with(**changes: Any) -> str:
    return json.dumps({**json.loads(encoded(GOOD)), **changes})


def _without(key: str) -> str:
    return json.dumps({k: v for k, v in json.loads(encoded(GOOD)).items() if k != key})


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{\n "format": \n]', "board.map, line 3: is no height map: a file of JSON has no such"),
        ("[1, 2]", 'board.map: is no height map: it would begin with "format"'),
        ('{"format": "other"}', 'board.map: is no height map: it would begin with "format"'),
        (_with(version=2), "board.map: version is 2: this program knows version 1."),
        (_without("x_mm"), "board.map: x_mm is missing."),
        (_with(z_mm=[1]), 'board.map: there is no key "z_mm"; there are format, version'),
        (_with(x_mm=[0, "a", 3]), "board.map: x_mm, number 2: a place is a number of mm."),
        (_with(x_mm=[0, "7", 30]), "board.map: x_mm, number 2: a place is a number of mm."),
        (_with(x_mm=[False, 7, 30]), "board.map: x_mm, number 1: a place is a number of mm."),
        (_with(reference_mm=[1]), "board.map: reference_mm is a point: two numbers of mm"),
        (_with(origin_mm={"x": 1}), "board.map: origin_mm is a point: two numbers of mm"),
        (_with(x_mm=[0, 20, 10]), "board.map: x_mm goes up from number to number, and not from"),
        (_with(y_mm=[0, 0]), "board.map: y_mm goes up from number to number, and not from 0 to 0."),
        (_with(y_mm=[0, 1, 2]), "board.map: heights_mm has 2 rows, and y_mm 3 numbers"),
        (
            _with(heights_mm=[[0, 1, 2], [3, 4]]),
            "board.map: heights_mm, row 2 has 2 heights, and x_mm 3 numbers",
        ),
        (
            _with(heights_mm=[[0, 1, 2], [3, "x", 4]]),
            "board.map: heights_mm, row 2, column 2: a height is a number of mm, or null.",
        ),
        (
            _with(heights_mm=[[0, 1, 2], [3, 1e9, 4]]),
            "board.map: heights_mm, row 2, column 2: a height is a number of mm, or null.",
        ),
        (encoded(GOOD).replace("null", "NaN"), "board.map: is no height map: a height is a number"),
        (_with(system="G60"), "board.map: system is not as it should be"),
        (_with(x_mm=[1]), "board.map: x_mm is not as it should be"),
        ("[" * 100_000, "board.map"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(text: str, said: str) -> None:
    with pytest.raises(ProgramError) as refused:
        decoded(text, "board.map")
    assert str(refused.value).startswith(said)
    assert "\n" not in str(refused.value)


_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner),
    max_leaves=8,
)
_KEYS = st.sampled_from(list(json.loads(encoded(GOOD))))


@fuzzed(200)
@given(st.dictionaries(_KEYS, _JSON), st.booleans())
def test_whatever_stands_there_is_a_map_or_refused(
    changes: dict[str, Any], only_these: bool
) -> None:
    text = json.dumps(changes) if only_these else _with(**changes)
    refusal = refusal_of(lambda: decoded(text, "board.map"))
    assert is_a_sentence(refusal)
    if refusal:
        assert refusal.startswith("board.map")
    else:
        read = decoded(text, "board.map")
        assert decoded(encoded(read), "board.map") == read


@fuzzed(200)
@given(st.integers(0, 400), st.text(max_size=3))
def test_a_damaged_file_is_a_map_or_refused(at: int, text: str) -> None:
    whole = encoded(GOOD)
    at %= len(whole)
    refusal = refusal_of(lambda: decoded(whole[:at] + text + whole[at + 1 :], "a"))
    assert refusal.startswith("a") or not refusal
    assert is_a_sentence(refusal)
