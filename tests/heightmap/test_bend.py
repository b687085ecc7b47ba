"""Moves bent to a height map: a flat world below, the warped one above."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.gcode.canon import Along, Arc, Facts, Feed, Message, Move, Probe, Rapid
from fraese.gcode.interpreter import Interpreter
from fraese.gcode.setup import Setup
from fraese.heightmap.bend import TOLERANCE_MM, Bend, Site
from fraese.heightmap.heights import HeightMap
from fraese.heightmap.pieces import knots
from fraese.planner.arcs import arc_shape
from fraese.workframe import FIRST_SYSTEM, ROTATION, Point
from tests.heightmap.test_heights import maps

SITE = Site("xyz", {}, (0.0, 0.0, 0.0), 0.005)
WARPED = HeightMap((0, 10, 20, 40), (0, 10, 30), ((0, 0.1, 0, 0.2), (0.1, 0.3, 0, 0), (0, 0, 1, 0)))
TILTED = HeightMap((0, 50), (0, 50), ((0, 0.5), (1, 1.5)))


def level(height_mm: float) -> HeightMap:
    return HeightMap((0, 50), (0, 50), ((height_mm, height_mm), (height_mm, height_mm)))


def bent(text: str, heights: HeightMap, site: Site = SITE, *answers: Facts) -> list[Move]:
    """The moves of a program on this map; barriers are answered in their order."""
    setup = Setup(position_mm=site.start_mm, parameters=dict(site.parameters))
    moves = Bend(heights, site).through(Interpreter(setup).run(text.splitlines()))
    found: list[Move] = []
    facts, waiting = None, list(answers)
    while True:
        try:
            move = moves.send(facts)
        except StopIteration:
            return found
        found.append(move)
        facts = waiting.pop(0) if waiting and isinstance(move, Probe) else None


def motions(moves: Iterable[Move]) -> list[Any]:
    return [move for move in moves if isinstance(move, Rapid | Feed | Arc | Along)]


def course(start: Point, moves: Iterable[Move]) -> list[tuple[Point, Point]]:
    """Straight pieces, from where to where."""
    points = [start]
    for move in motions(moves):
        if isinstance(move, Arc):
            points += arc_shape(points[-1], move.to, move.centre, move.plane, move.turns).corners(
                SITE.chord_mm
            )
        else:
            points += move.points if isinstance(move, Along) else [move.to]
    return list(pairwise(points))


def test_a_point_is_lifted_by_the_height_there() -> None:
    found = motions(bent("G90 G0 X10 Y10 Z5\nG1 Z-1 F100", WARPED))
    assert [move.to for move in found] == [(10, 10, 5.3), (10, 10, -0.7)]


def test_a_line_is_one_move_of_its_line_along_the_surface() -> None:
    cut = motions(bent("G90 G0 Z0\nG1 X40 Y30 F120", WARPED))[-1]
    assert isinstance(cut, Along)
    assert (cut.line, cut.feed_mm_min, cut.to) == (2, 120, (40, 30, 0))
    before: Point = (0.0, 0.0, 0.0)
    for point in cut.points:
        for n in range(11):
            x, y, z = (a + (b - a) * n / 10 for a, b in zip(before, point, strict=True))
            assert z == pytest.approx(WARPED.at(x, y), abs=TOLERANCE_MM + 1e-9)
        before = point
    assert list(cut.points) == list(cut.points)


def test_an_arc_keeps_to_the_surface_between_its_chords() -> None:
    text = "G90 G0 X10 Y10 Z0\nG2 X30 Y10 I10 J0 F100\nG3 X10 Y10 Z-2 R10"
    found = bent(text, WARPED)
    first = motions(found)[1]
    assert isinstance(first, Along)
    assert first.radius_mm == pytest.approx(10)
    for begin, end in course((10.0, 10.0, 0.3), [first]):
        for n in range(11):
            x, y, z = (a + (b - a) * n / 10 for a, b in zip(begin, end, strict=True))
            assert z == pytest.approx(WARPED.at(x, y), abs=TOLERANCE_MM + 1e-9)
            assert (x - 20) ** 2 + (y - 10) ** 2 == pytest.approx(100, abs=0.2)
    helix = motions(found)[2]
    assert helix.to == pytest.approx((10, 10, -2 + 0.3))


@given(maps(), st.sampled_from(["G2 X20 Y0 I10 J0 F100", "G18 G3 X20 Z1 I10 K0 F100", "G1 X20 F9"]))
def test_every_point_of_a_course_lies_on_the_surface(heights: HeightMap, line: str) -> None:
    flat = motions(Interpreter(Setup()).run(["G0 Z1", line]))
    for move in motions(bent(f"G0 Z1\n{line}", heights))[1:]:
        for x, y, z in move.points if isinstance(move, Along) else [move.to]:
            # The way is known in X and Y; Z is what an arc in another plane adds.
            if "G18" not in line:
                assert z - heights.at(x, y) == pytest.approx(flat[-1].to[2], abs=TOLERANCE_MM)
        assert move.to[2] == pytest.approx(flat[-1].to[2] + heights.at(*flat[-1].to[:2]))


@given(st.floats(-2, 2))
def test_a_level_map_only_shifts(height_mm: float) -> None:
    text = "G90 G0 X5 Y5 Z3\nG1 Z-1 F100\nG1 X20 Y30\nG2 X30 Y20 I5 J-5\nG0 Z3\nG81 X9 Y9 Z-1 R2"
    flat = motions(Interpreter(Setup()).run(text.splitlines()))
    lifted = motions(bent(text, level(height_mm)))
    assert [move.to[:2] for move in lifted] == [move.to[:2] for move in flat]
    assert [move.to[2] for move in lifted] == pytest.approx([m.to[2] + height_mm for m in flat])
    # Chords of an arc are the same ones.
    for (a, b), (c, d) in zip(
        course((0.0, 0.0, 0.0), flat)[1:], course((0.0, 0.0, 0.0), lifted)[1:], strict=True
    ):
        assert (*a[:2], *b[:2]) == (*c[:2], *d[:2])
        assert (c[2] - a[2], d[2] - b[2]) == pytest.approx((height_mm, height_mm), abs=1e-9)


def test_on_a_tilted_plane_lines_stay_whole() -> None:
    found = motions(bent("G90 G0 Z0\nG1 X40 Y30 F100\nG1 X5", TILTED))
    assert not any(isinstance(move, Along) for move in found)
    assert found[1].to == pytest.approx((40, 30, 0.4 + 0.6))


def test_the_first_move_begins_where_the_machine_stands() -> None:
    """Nothing jumps: what the start is off the surface is lost on the way."""
    site = replace(SITE, start_mm=(10.0, 10.0, 8.0))
    (over,) = motions(bent("G90 G0 X20", WARPED, site))
    assert over.to == (20, 10, 8.0 + WARPED.at(20, 10))


def test_nothing_moves_where_nothing_is_commanded() -> None:
    site = replace(SITE, start_mm=(10.0, 10.0, 8.0))
    assert motions(bent("G1 F100\nG1 X10", WARPED, site))[0].to == (10, 10, 8.0)


# --- places of the machine -----------------------------------------------------------------------


def test_a_place_of_the_machine_is_gone_to_as_it_is() -> None:
    text = "G90 G0 X10 Y10 Z-5\nG53 G0 Z0\nG0 X20 Y10\nG53 G0 X40 Y30\nG0 Z-5\nG1 X10 Y10 F100"
    found = motions(bent(text, WARPED))
    heights = [move.to[2] for move in found]
    assert heights == pytest.approx([-4.7, 0, 0, 0, -5 + WARPED.at(40, 30), -4.7])


def test_home_is_a_place() -> None:
    site = replace(SITE, parameters={5161: 10.0, 5162: 10.0, 5163: -1.0})
    heights = [move.to[2] for move in motions(bent("G28 Z-3\nG0 Z-3", WARPED, site))]
    assert heights == pytest.approx([-3.0, -1.0, -3.0 + WARPED.at(10, 10)], abs=0.31)
    assert heights[1] == -1.0


def test_no_rapid_rises_above_the_travel() -> None:
    site = replace(SITE, top_mm=0.0)
    found = motions(bent("G90 G0 Z-0.1\nG0 X40 Y30\nG0 X20 Y30\nG1 X19 F100", WARPED, site))
    tops = [max(p[2] for p in getattr(move, "points", [move.to])) for move in found]
    assert tops[:3] == pytest.approx([-0.1, 0.0, 0.0], abs=1e-9)
    # A feed there is not altered: the look-through refuses it.
    assert tops[3] > 0.5


# --- where the map lies --------------------------------------------------------------------------


def test_the_map_lies_in_work_coordinates() -> None:
    site = replace(SITE, parameters={FIRST_SYSTEM: 100.0, FIRST_SYSTEM + 1: 50.0})
    found = motions(bent("G90 G0 X10 Y10 Z0", WARPED, site))
    assert found[0].to == (110, 60, 0.3)


def test_the_map_turns_with_the_work() -> None:
    site = replace(SITE, parameters={FIRST_SYSTEM + ROTATION: 90.0})
    found = motions(bent("G90 G0 X10 Y10 Z0", WARPED, site))
    assert found[0].to == pytest.approx((-10, 10, 0.3))


def test_another_offset_of_the_program_leaves_the_work_where_it_lies() -> None:
    text = "G90 G0 X0 Y0 Z0\nG92 X5 Y5\nG0 X15 Y15\nG55 G0 X10 Y10"
    for text_ in (text, text.replace("G92 X5 Y5", "G10 L2 P1 X-5 Y-5")):
        assert motions(bent(text_, WARPED))[1].to == pytest.approx((10, 10, 0.3))


# --- what comes back -----------------------------------------------------------------------------


def test_a_probe_is_told_as_on_flat_work() -> None:
    """It touches the warped work at -4; on flat work that would be lower by the height there."""
    answer = Facts((10.0, 10.0, -4.01), touched=True, contact_mm=(10.0, 10.0, -4.0))
    text = "G90 G0 X10 Y10 Z0\nG38.2 Z-6 F50\nG10 L20 P1 Z0\nG0 Z5\nG1 X20 Y10 Z0 F100"
    found = bent(text, WARPED, SITE, answer)
    probe = next(move for move in found if isinstance(move, Probe))
    assert probe.to == pytest.approx((10, 10, -5.7))
    after = motions(found)[1:]
    # Z0 was set where the tool stood, -4.01 there; over another place it is the surface again.
    assert after[0].to == pytest.approx((10, 10, 0.99))
    assert after[1].to == pytest.approx((20, 10, -4.01 - 0.3 + WARPED.at(20, 10)))


def test_a_probe_goes_straight() -> None:
    found = bent("G90 G0 X0 Y0 Z0\nG38.3 X40 F50", WARPED)
    assert [type(move) for move in found[:2]] == [Rapid, Probe]


# --- outside -------------------------------------------------------------------------------------


def test_outside_the_edge_holds_and_it_is_told_once() -> None:
    found = bent("G90 G0 X-50 Y0 Z0\nG1 X-5 F100\nG1 X-9\nG1 X0", WARPED)
    told = [move for move in found if isinstance(move, Message)]
    assert [(move.line, move.kind) for move in told] == [(2, "note")]
    assert told[0].text == (
        "X-5.000 Y0.000 lies 5.0 mm outside the height map (X 0 to 40, Y 0 to 30): there the height"
        " of its edge holds"
    )


def test_an_arc_that_bulges_out_is_told() -> None:
    found = bent("G90 G0 X30 Y0 Z0\nG3 X30 Y20 I0 J10 F100", level(0.1))
    assert not any(isinstance(move, Message) for move in found)
    found = bent("G90 G0 X45 Y0 Z0\nG3 X45 Y20 I0 J10 F100", level(0.1))
    assert any("5.0 mm outside" in move.text for move in found if isinstance(move, Message))


def test_few_pieces_where_the_work_is_nearly_level() -> None:
    nearly = HeightMap((0, 10, 20, 30), (0, 10), ((0, 0.0005, 0, 0.0005), (0, 0, 0.0005, 0)))
    assert len(knots(nearly, (0, 0), (30, 10), TOLERANCE_MM)) == 1
