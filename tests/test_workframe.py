"""The work frame alone: both ways, and where it keeps what outlives a program."""

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.workframe import LETTERS, PERSISTENT, WorkFrame, numbers

MM = st.floats(-1e4, 1e4)
AXES = st.lists(st.sampled_from(LETTERS), min_size=1, max_size=6, unique=True).map("".join)


@st.composite
def frames(draw: st.DrawFn) -> WorkFrame:
    axes = draw(AXES)
    point = st.tuples(*(MM for _ in axes))
    return WorkFrame(axes, draw(point), draw(point), draw(point), draw(st.floats(-720, 720)))


@given(frames(), st.data())
def test_there_and_back_is_where_one_was(frame: WorkFrame, data: st.DataObject) -> None:
    point = data.draw(st.tuples(*(MM for _ in frame.axes)))
    assert frame.to_work(frame.to_machine(point)) == pytest.approx(point, abs=1e-8)
    assert frame.to_machine(frame.to_work(point)) == pytest.approx(point, abs=1e-8)


@given(frames(), st.data())
def test_an_offset_makes_a_place_read_as_wanted(frame: WorkFrame, data: st.DataObject) -> None:
    machine, wanted = (data.draw(st.tuples(*(MM for _ in frame.axes))) for _ in range(2))
    offset = frame.offset_for(machine, wanted)
    after = WorkFrame(frame.axes, offset, frame.g92, frame.tool, frame.rotation_deg)
    assert after.to_work(machine) == pytest.approx(wanted, abs=1e-8)


@given(frames(), st.data())
def test_only_what_is_said_to_move_does(frame: WorkFrame, data: st.DataObject) -> None:
    letter = data.draw(st.sampled_from(frame.axes))
    work = [0.0] * len(frame.axes)
    work[frame.axes.index(letter)] = 10.0
    moved = {
        name
        for name, a, b in zip(frame.axes, frame.origin, frame.to_machine(tuple(work)), strict=True)
        if a != b
    }
    assert moved <= frame.moved_with(letter)


@pytest.mark.parametrize(
    ("angle_deg", "there"),
    [
        (90, (-2, 10, 3)),
        (-270, (-2, 10, 3)),
        (180, (-10, -2, 3)),
        (-90, (2, -10, 3)),
        (450.0, (-2, 10, 3)),
        (360, (10, 2, 3)),
    ],
)
def test_a_right_angle_leaves_no_remains(angle_deg: float, there: tuple[float, ...]) -> None:
    frame = WorkFrame("xyz", (0, 0, 0), (0, 0, 0), (0, 0, 0), angle_deg)
    assert frame.to_machine((10, 2, 3)) == there
    assert frame.to_work(there) == (10, 2, 3)
    for point in ((0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (0.0, 10.0, 0.0)):
        values = (*frame.to_machine(point), *frame.to_work(point))
        assert "-0.0" not in map(str, values)


def test_turned_first_then_shifted() -> None:
    frame = WorkFrame("xyz", (100, 40, -5), (2, 0, 0), (0, 0, 3), 90)
    assert frame.to_machine((10, 1, 0)) == pytest.approx((99, 52, -2))
    assert frame.origin == pytest.approx((100, 42, -2))


@pytest.mark.parametrize("axes", ["".join(letters) for letters in permutations("xya")])
def test_the_order_of_the_axes_is_the_machines(axes: str) -> None:
    frame = WorkFrame.of({5220: 2, 5241: 1, 5242: 2, 5244: 4, 5250: 90, 5401: 10}, axes)
    assert frame.system == 2
    assert dict(zip(axes, frame.offset, strict=True)) == {"x": 1, "y": 2, "a": 4}
    point = tuple({"x": 5.0, "y": 0.0, "a": 7.0}[letter] for letter in axes)
    at = dict(zip(axes, frame.to_machine(point), strict=True))
    assert at == pytest.approx({"x": 11, "y": 7, "a": 11})


def test_nothing_is_turned_without_both_axes() -> None:
    frame = WorkFrame.of({5230: 90}, "xz")
    assert not frame.is_rotated
    assert frame.to_machine((1, 2)) == (1, 2)


def test_g92_counts_where_it_is_on() -> None:
    kept = {5211: 3.0, 5213: -1.0}
    assert WorkFrame.of(kept, "xz").g92 == (0, 0)
    assert WorkFrame.of({**kept, 5210: 1.0}, "xz").g92 == (3, -1)


def test_tables_are_in_the_order_of_the_language() -> None:
    assert numbers(5221, "xyzabcuvw") == tuple(range(5221, 5230))
    assert numbers(5401, "za") == (5403, 5404)
    assert {5161, 5169, 5181, 5189, 5210, 5219, 5220, 5390, 5400, 5409} <= set(PERSISTENT)
    assert not {5160, 5170, 5190, 5391, 5410, 5420} & set(PERSISTENT)
