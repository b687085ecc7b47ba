"""The box round what is cut holds every move, and nothing else."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.program.box import Box

POINT = st.tuples(*[st.floats(-100, 100)] * 3)


@given(st.lists(st.tuples(POINT, POINT, st.booleans()), min_size=1, max_size=12))
def test_it_is_the_smallest_that_holds_all(moves: list[tuple[tuple[float, ...], ...]]) -> None:
    box, points = Box(3), []
    end: tuple[float, ...] = ()
    for start, to, goes_on in moves:
        begin = end if goes_on and end else start
        box.take(begin, to, to, to)
        points += [begin, to]
        end = to
    assert box.low_mm == tuple(min(point[n] for point in points) for n in range(3))
    assert box.high_mm == tuple(max(point[n] for point in points) for n in range(3))


@pytest.mark.parametrize("axes", [1, 3, 4])
def test_without_a_move_there_is_none(axes: int) -> None:
    assert Box(axes).low_mm is None
    assert Box(axes).high_mm is None
