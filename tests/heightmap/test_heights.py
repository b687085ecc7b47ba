"""A surface between points, and the pieces of a way over it."""

import math
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.heightmap.bend import TOLERANCE_MM
from fraese.heightmap.heights import HeightMap
from fraese.heightmap.pieces import knots
from fraese.workframe import FIRST_SYSTEM

_LINES = st.lists(st.integers(-20, 20), min_size=2, max_size=6, unique=True).map(
    lambda places: tuple(float(5 * place) for place in sorted(places))
)
_PLACE = st.tuples(st.floats(-130, 130), st.floats(-130, 130))


@st.composite
def maps(draw: Any) -> HeightMap:
    x_mm, y_mm = draw(_LINES), draw(_LINES)
    row = st.tuples(*[st.floats(-1, 1)] * len(x_mm))
    return HeightMap(x_mm, y_mm, tuple(draw(row) for _ in y_mm))


def plane(a: float, b: float, c: float) -> HeightMap:
    x_mm, y_mm = (0.0, 7.0, 30.0, 100.0), (-10.0, 0.0, 25.0, 60.0)
    rows = tuple(tuple(a + b * x + c * y for x in x_mm) for y in y_mm)
    return HeightMap(x_mm, y_mm, rows)


@given(maps())
def test_every_point_has_its_height(heights: HeightMap) -> None:
    for row, y in zip(heights.heights_mm, heights.y_mm, strict=True):
        for height, x in zip(row, heights.x_mm, strict=True):
            assert heights.at(x, y) == pytest.approx(height, abs=1e-12)


@given(maps(), _PLACE)
def test_no_height_is_beyond_those_of_the_map(heights: HeightMap, at: tuple[float, float]) -> None:
    assert heights.lowest_mm - 1e-9 <= heights.at(*at) <= heights.highest_mm + 1e-9


@given(maps(), _PLACE)
def test_outside_the_height_of_the_edge_holds(heights: HeightMap, at: tuple[float, float]) -> None:
    x = min(max(at[0], heights.x_mm[0]), heights.x_mm[-1])
    y = min(max(at[1], heights.y_mm[0]), heights.y_mm[-1])
    assert heights.at(*at) == heights.at(x, y)
    assert (heights.beyond_mm(*at) == 0) == ((x, y) == at)


@given(st.floats(-1, 1), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), _PLACE)
def test_a_plane_is_exact(a: float, b: float, c: float, at: tuple[float, float]) -> None:
    heights = plane(a, b, c)
    if heights.beyond_mm(*at) == 0:
        assert heights.at(*at) == pytest.approx(a + b * at[0] + c * at[1], abs=1e-12)


@given(maps(), _PLACE, _PLACE)
def test_the_pieces_of_a_way_keep_to_the_surface(
    heights: HeightMap, start: tuple[float, float], end: tuple[float, float]
) -> None:
    found = knots(heights, start, end, TOLERANCE_MM)
    assert found[-1][0] == 1.0
    ends = [(0.0, heights.at(*start)), *found]
    assert all(a < b for (a, _), (b, _) in pairwise(ends))
    for (begin, low), (until, high) in pairwise(ends):
        for n in range(41):
            share = n / 40
            part = begin + (until - begin) * share
            at = [a + (b - a) * part for a, b in zip(start, end, strict=True)]
            straight = low + (high - low) * share
            assert abs(straight - heights.at(*at)) <= TOLERANCE_MM + 1e-9


@given(st.floats(-1, 1), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_over_a_plane_a_way_is_one_piece(a: float, b: float, c: float) -> None:
    assert len(knots(plane(a, b, c), (0, -10), (100, 60), TOLERANCE_MM)) == 1


def test_a_way_is_cut_where_the_surface_has_an_edge() -> None:
    roof = HeightMap((0, 10, 20), (0, 10), ((0, 1, 0), (0, 1, 0)))
    assert knots(roof, (0, 5), (20, 5), TOLERANCE_MM) == [(0.5, 1.0), (1.0, 0.0)]


def test_across_a_twisted_cell_the_pieces_are_few() -> None:
    twisted = HeightMap((0, 10), (0, 10), ((0, 0), (0, 0.4)))
    # Off by 0.4 / 4 in one piece; n pieces are off by the n² part of it.
    count = len(knots(twisted, (0, 0), (10, 10), TOLERANCE_MM))
    assert math.sqrt(0.1 / TOLERANCE_MM) <= count <= math.ceil(math.sqrt(0.1 / (TOLERANCE_MM / 2)))


def test_a_point_is_no_way() -> None:
    assert knots(plane(1, 0, 0), (3, 3), (3, 3), TOLERANCE_MM) == [(1.0, 1.0)]


def test_a_moved_zero_is_told() -> None:
    heights = HeightMap((0, 10), (0, 10), ((0, 0), (0, 0)), origin_mm=(50.0, 40.0))
    there = {FIRST_SYSTEM: 50.0, FIRST_SYSTEM + 1: 40.05}
    assert heights.moved(there, "xyz") == ""
    assert heights.moved({**there, FIRST_SYSTEM: 52.0}, "xyz").startswith(
        "The height map was probed with the zero of G54 at machine X 50.000 Y 40.000, which is now"
        " at X 52.000 Y 40.050"
    )


def test_nobody_knows_where_the_zero_was() -> None:
    heights = HeightMap((0, 10), (0, 10), ((0, 0), (0, 0)))
    assert heights.moved({FIRST_SYSTEM: 50.0}, "xyz") == ""
