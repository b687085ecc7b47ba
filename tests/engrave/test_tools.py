"""Cutters and lasers: passes, tabs, overscan, power; and what must hold of any program."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fraese.engrave.curves import simplified
from fraese.engrave.job import Job, Tabs
from fraese.engrave.moves import RAPID, Figures, Move
from fraese.engrave.order import nesting, ordered
from fraese.engrave.shapes import Path as Shape
from fraese.engrave.shapes import arc, bounds, circle, straight
from fraese.engrave.strokes import Row, Run
from fraese.engrave.tools import Cutter, Laser
from tests.engrave.bench import SQUARE_SVG, Bench, Way
from tests.engrave.drawings import png, square_png
from tests.engrave.test_svg import off

JOB = Job()
_NEAR = st.integers(-30_000, 30_000).map(lambda n: n / 1000)
_POINTS = st.lists(st.tuples(_NEAR, _NEAR), min_size=2, max_size=8, unique=True)
_LINES = st.builds(straight, _POINTS)
_RINGS = st.builds(lambda points: straight(points, close=True), st.lists(
    st.tuples(_NEAR, _NEAR), min_size=3, max_size=8, unique=True))  # fmt: skip
_CIRCLES = st.builds(circle, st.tuples(_NEAR, _NEAR), st.floats(0.1, 20))
_ARCS = st.builds(
    lambda at, radius, first, sweep: arc(
        (at[0] + radius * math.cos(first), at[1] + radius * math.sin(first)),
        (at[0] + radius * math.cos(first + sweep), at[1] + radius * math.sin(first + sweep)),
        at,
        1 if sweep > 0 else -1,
    ),
    st.tuples(_NEAR, _NEAR),
    st.floats(0.1, 20),
    st.floats(0, 6),
    st.floats(0.1, 6) | st.floats(-6, -0.1),
)
PATHS = st.lists(st.one_of(_LINES, _RINGS, _CIRCLES, _ARCS), min_size=1, max_size=8)


def moved(tool: Cutter | Laser, shapes: list[Shape], job: Job = JOB) -> list[Move]:
    found = list(tool.begin())
    for shape in shapes:
        found += tool.cut(shape, job)
    return found + list(tool.end())


def cut_mm(moves: list[Move]) -> float:
    figures = Figures()
    for move in moves:
        figures.take(move)
    return figures.cut_mm


@given(shapes=PATHS)
@settings(deadline=None)
def test_what_is_drawn_is_cut_as_long_as_it_is(shapes: list[Shape]) -> None:
    drawn = sum(shape.length_mm for shape in shapes)
    assert cut_mm(moved(Laser(power=5), shapes)) == pytest.approx(drawn, rel=1e-3, abs=0.02)
    deep = Cutter(depth_mm=1, pass_mm=0.4)
    assert cut_mm(moved(deep, ordered(shapes))) == pytest.approx(3 * drawn, rel=1e-3, abs=0.06)


@given(shapes=PATHS)
@settings(deadline=None)
def test_the_order_leaves_no_path_out_and_cuts_what_is_inside_first(shapes: list[Shape]) -> None:
    made = ordered(shapes)
    assert sorted(round(s.length_mm, 6) for s in made) == sorted(
        round(s.length_mm, 6) for s in shapes
    )
    # Turned round, a path that touches another one begins inside or outside of it.
    places = {corners(shape): place for place, shape in enumerate(made)}
    assume(len(places) == len(shapes))
    for shape, holders in zip(shapes, nesting(shapes), strict=True):
        for holder in holders:
            assert places[corners(shape)] < places[corners(shapes[holder])]


def corners(shape: Shape) -> frozenset[tuple[float, ...]]:
    """What stays of a path wherever it is begun."""
    return frozenset(map(tuple, shape.points.round(9).tolist()))


@given(shapes=PATHS)
@settings(deadline=None)
def test_every_point_is_within_the_bounds(shapes: list[Shape]) -> None:
    low, high = bounds(shapes)
    for shape in shapes:
        flat = shape.flattened(0.01)
        assert (flat >= low - 1e-9).all()
        assert (flat <= high + 1e-9).all()
        assert flat.shape[1] == 2


@given(lines=st.lists(_POINTS, min_size=1, max_size=5), tolerance=st.floats(0.01, 20))
def test_points_that_are_left_out_are_no_further_off_than_allowed(
    lines: list[list[tuple[float, float]]], tolerance: float
) -> None:
    whole = [np.array([*line, line[0]]) for line in lines]
    made = simplified(whole, tolerance)
    assert len(made) == len(whole)
    for line, few in zip(whole, made, strict=True):
        assert few[0].tolist() == line[0].tolist()
        assert few[-1].tolist() == line[-1].tolist()
        for x, y in line.tolist():
            assert off(straight(few), x, y) <= tolerance + 1e-9


def test_a_line_of_many_points_becomes_two() -> None:
    bow = np.column_stack((np.linspace(0, 100, 1001), np.zeros(1001)))
    assert simplified([bow], 0.01)[0].tolist() == [[0, 0], [100, 0]]


@given(shape=st.one_of(_RINGS, _CIRCLES), number=st.integers(1, 5), width=st.floats(0.5, 3))
@settings(deadline=None)
def test_tabs_take_their_part_of_the_way(shape: Shape, number: int, width: float) -> None:
    job = Job(tabs=Tabs(number, width, 0.5))
    whole = cut_mm(moved(Laser(power=5), [shape]))
    left = cut_mm(moved(Laser(power=5), [shape], job))
    fits = shape.length_mm > 2 * number * width
    assert whole - left == pytest.approx(number * width if fits else 0, abs=0.01)
    # A cutter goes over them, and does not leave its way.
    assert cut_mm(moved(Cutter(depth_mm=2), [shape], job)) == pytest.approx(
        whole, rel=1e-3, abs=0.02
    )


def test_tabs_are_left_as_high_as_wanted_and_in_the_last_passes_only(bench: Bench) -> None:
    words = ["--depth", 3, "--pass-depth", 1, "--tabs", 2, "--tab-height", 0.8, "--tab-width", 5]
    made = bench.engrave(bench.file("a.svg", SQUARE_SVG), *words)
    assert made["notes"] == []
    cut = bench.cut(bench.ways())
    high = [way for way in cut if way.end[2] == -2.2]
    assert sum(way.length_mm for way in high) == pytest.approx(2 * 2 * 5, abs=0.01)
    assert {way.end[2] for way in cut} == {-1, -2, -2.2, -3}
    # A circle of 25 mm has no room for five of them.
    words = ["--tabs", 5, "--tab-width", 4]
    made = bench.engrave(bench.file("a.svg", SQUARE_SVG), *words)
    assert "1 of 2 closed outlines" in made["notes"][0]


def test_passes_are_equal_and_an_open_line_goes_there_and_back() -> None:
    line = straight([(0, 0), (10, 0)])
    made = moved(Cutter(depth_mm=1, pass_mm=0.4), [line])
    assert [m.z for m in made if m.z is not None and m.z < 0] == pytest.approx([-1 / 3, -2 / 3, -1])
    assert [m.x for m in made if m.cuts] == [10, 0, 10]


# --- lasers ------------------------------------------------------------------------------------


def lit(ways: list[Way]) -> list[Way]:
    return [way for way in ways if way.power]


def test_a_laser_is_dark_on_every_way_but_its_strokes(bench: Bench) -> None:
    bench.engrave(bench.file("a.svg", SQUARE_SVG), "--power", 700)
    ways = bench.ways()
    assert sum(w.length_mm for w in lit(ways)) == pytest.approx(100 + 8 * math.pi, abs=0.01)
    assert {w.power for w in lit(ways)} == {700}
    assert all(w.begin[2] == w.end[2] == 0 for w in ways)
    assert bench.text.count("M3") == bench.text.count("M5") == 1
    bench.engrave(bench.file("a.svg", SQUARE_SVG), "--power", 700, "--dynamic")
    assert "M4" in bench.text
    assert "M3" not in bench.text


@pytest.mark.parametrize("way", ["sweep", "bitmap"])
def test_overscan_is_outside_of_what_is_burnt_and_dark(bench: Bench, way: str) -> None:
    file = bench.file("a.png", square_png())
    words = ["--way", way, "--power", 500, "--distance", 0.5, "--width", 32, "--overscan", 3]
    bench.engrave(file, *words)
    ways = bench.ways()
    xs = [x for w in lit(ways) for x in (w.begin[0], w.end[0])]
    assert min(xs) == pytest.approx(1, abs=0.3)
    assert max(xs) == pytest.approx(31, abs=0.3)
    feeds = [w for w in ways if w.kind == "feed" and not w.power]
    outside = [
        w for w in feeds if min(w.end[0], w.begin[0]) < 0.7 or max(w.end[0], w.begin[0]) > 31.3
    ]
    assert len(outside) == 2 * len({w.begin[1] for w in lit(ways)})
    assert {round(w.length_mm, 3) for w in outside} == {3}
    # There and back.
    rights = {w.end[0] > w.begin[0] for w in lit(ways)}
    assert rights == {True, False}
    bench.engrave(file, *words, "--one-way")
    assert {w.end[0] > w.begin[0] for w in lit(bench.ways())} == {True}


def test_what_is_burnt_is_what_is_dark(bench: Bench) -> None:
    words = ["--power", 500, "--distance", 0.25, "--width", 32]
    area = 30 * 20 - 16 * math.pi
    for way in (["--way", "sweep"], ["--way", "sweep", "--angle", 37], ["--way", "bitmap"]):
        bench.engrave(bench.file("a.png", square_png()), *words, *way)
        burnt = sum(w.length_mm for w in lit(bench.ways()))
        assert burnt * 0.25 == pytest.approx(area, rel=0.01), way


def test_greys_are_dots_as_dense_or_power_as_high_as_it_is_dark(bench: Bench) -> None:
    ramp = np.tile(np.linspace(0, 255, 200), (100, 1))
    file = bench.file("ramp.png", png(ramp))
    words = ["--way", "bitmap", "--width", 40, "--distance", 0.2]
    bench.engrave(file, *words, "--power", 100)
    parts = [0.0] * 4
    for way in lit(bench.ways()):
        middle = (way.begin[0] + way.end[0]) / 2
        parts[min(3, int(middle / 10))] += way.length_mm * 0.2
    assert [part / 200 for part in parts] == pytest.approx([0.125, 0.375, 0.625, 0.875], abs=0.03)
    bench.engrave(file, *words, "--power", 100, "--power-min", 20, "--grey", "steps", "--levels", 5)
    assert {w.power for w in lit(bench.ways())} == {40, 60, 80, 100}
    row = [w for w in lit(bench.ways()) if w.begin[1] == lit(bench.ways())[0].begin[1]]
    assert [w.power for w in row] == [40, 60, 80, 100]


def test_a_cutter_makes_greys_by_depth_or_by_dots(bench: Bench) -> None:
    ramp = np.tile(np.linspace(0, 255, 200), (20, 1))
    file = bench.file("ramp.png", png(ramp))
    words = ["--way", "bitmap", "--width", 40, "--distance", 1, "--depth", 2]
    bench.engrave(file, *words, "--grey", "steps", "--levels", 5)
    assert {w.end[2] for w in bench.cut(bench.ways())} == {-0.5, -1, -1.5, -2}
    bench.engrave(file, *words)
    ways = bench.ways()
    assert bench.cut(ways) == []
    holes = [w.end for w in ways if w.end[2] < 0]
    assert len(holes) == pytest.approx(40 * 4 / 2, abs=6)
    assert {(x - 0.5) % 1 for x, _, _ in holes} == {0}


@given(
    edges=st.lists(st.integers(0, 400), min_size=2, max_size=20, unique=True),
    overscan=st.sampled_from([0.0, 1.0, 4.0]),
)
def test_rows_burn_their_runs_and_nothing_else(edges: list[int], overscan: float) -> None:
    at = sorted(edges)
    runs = [Run(a / 4, b / 4, 1.0) for a, b in zip(at[::2], at[1::2], strict=False)]
    row = Row((5.0, 1.0), (-1.0, 0.0), runs)
    laser = Laser(power=9, overscan_mm=overscan)
    x, burnt = 0.0, []
    for move in laser.cut(row, JOB):
        assert move.x is not None
        if move.cuts:
            burnt.append((5 - x, 5 - move.x))
        elif move.kind != RAPID:
            assert move.x < x
        x = move.x
    assert burnt == [pytest.approx((run.begin_mm, run.end_mm)) for run in runs]


def test_a_dot_is_a_hole_or_a_short_line() -> None:
    dot = straight([(3, 4)])
    assert [m.z for m in moved(Cutter(), [dot])] == [2, None, -0.5, 2]
    (line,) = [m for m in moved(Laser(power=5), [dot]) if m.cuts]
    assert (line.x, line.y, line.power) == (3.1, 4, 5)


def test_many_paths_are_brought_into_order_in_a_bearable_number_of_looks(tmp_path: Path) -> None:
    grid = [straight([(x, y), (x + 0.5, y)]) for x in range(60) for y in range(60)]
    shuffled = [grid[n] for n in np.random.default_rng(1).permutation(len(grid))]

    def rapids_mm(shapes: list[Shape]) -> float:
        figures = Figures()
        for move in moved(Laser(power=1), shapes):
            figures.take(move)
        return figures.rapid_mm

    assert rapids_mm(ordered(shuffled)) < 0.05 * rapids_mm(shuffled)


def test_a_laser_on_an_output_is_lit_as_often_and_as_long_as_the_program_says(bench: Bench) -> None:
    bench.file("fraese.toml", '[card]\nkind = "stepdir"\n[outputs]\nlaser = { pin = 14 }\n')
    words = ["--way", "sweep", "--power", 500, "--distance", 1, "--feed", 300, "--width", 15]
    bench.engrave(bench.file("a.svg", SQUARE_SVG), *words)
    burnt = lit(bench.ways())
    assert bench.run("home").exit_code == 0
    assert bench.run("move", "X20", "Y20").exit_code == 0
    assert bench.run("zero").exit_code == 0
    done = bench.run("run", "out.ngc", "--trace", "out.vcd")
    assert done.exit_code == 0, done.output
    shown = json.loads(bench.run("trace", "out.vcd", "--json").stdout)
    (light,) = [line for name, line in shown["lines"].items() if "laser" in name]
    assert light["rising"] == len(burnt) > 9
    # At the full feed all the way: it got up to it where it was dark.
    shortest_s = min(way.length_mm for way in burnt) / 5
    assert light["shortest_high_s"] == pytest.approx(shortest_s, rel=0.02)
