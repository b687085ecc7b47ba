"""DXF: units, blocks, layers, what is left out."""

import math
from typing import Any

import pytest

from fraese.engrave.dxffile import DxfDrawing, read
from fraese.engrave.shapes import Path, bounds
from tests.engrave.drawings import dxf, written


def drawing(unit: int = 4) -> tuple[Any, Any]:
    document = dxf(unit)
    return document, document.modelspace()


def opened(document: Any) -> DxfDrawing:
    return read(written(document), "a.dxf")


def paths(document: Any) -> list[Path]:
    return opened(document).paths(0.01)


@pytest.mark.parametrize(("unit", "mm"), [(1, 25.4), (2, 304.8), (4, 1), (5, 10), (6, 1000)])
def test_units(unit: int, mm: float) -> None:
    document, space = drawing(unit)
    space.add_line((0, 0), (3, 0))
    (path,) = paths(document)
    assert path.length_mm == pytest.approx(3 * mm)
    assert opened(document).notes == []


def test_a_drawing_without_unit_is_in_mm_and_that_is_told() -> None:
    document, space = drawing(0)
    space.add_line((0, 0), (3, 0))
    (path,) = paths(document)
    assert path.length_mm == 3
    assert opened(document).notes == ["a.dxf says no unit; mm are assumed."]


def test_bulges_become_arcs() -> None:
    document, space = drawing()
    space.add_lwpolyline(
        [(0, 0, 1), (10, 0, 0), (10, 10, -1), (0, 10, 0)], format="xyb", close=True
    )
    (path,) = paths(document)
    assert path.is_closed
    assert path.turns.tolist() == [1, 0, -1, 0]
    assert path.length_mm == pytest.approx(20 + 10 * math.pi)
    low, high = path.bounds
    # The first one swings out below, the other one in from above.
    assert low.tolist() == pytest.approx([0, -5])
    assert high.tolist() == pytest.approx([10, 10])


def test_what_is_seen_from_below_is_mirrored() -> None:
    document, space = drawing()
    space.add_arc((10, 0), 5, 0, 90, dxfattribs={"extrusion": (0, 0, -1)})
    (path,) = paths(document)
    assert path.turns.tolist() == [-1]
    assert path.points.tolist() == [pytest.approx([-15, 0]), pytest.approx([-10, 5])]
    document, space = drawing()
    points = [(0, 0, 1), (10, 0, 0)]
    space.add_lwpolyline(points, format="xyb", dxfattribs={"extrusion": (0, 0, -1)})
    (half,) = paths(document)
    assert half.turns.tolist() == [-1]
    assert half.bounds[0].tolist() == pytest.approx([-10, -5])


def test_blocks_are_drawn_where_they_are_inserted() -> None:
    document, space = drawing()
    block = document.blocks.new("PART")
    block.add_circle((0, 0), 1)
    space.add_blockref("PART", (10, 10), dxfattribs={"xscale": 3, "yscale": 3})
    space.add_blockref("PART", (30, 10), dxfattribs={"xscale": 4, "yscale": 2, "rotation": 90})
    circle, oval = paths(document)
    assert circle.turns.tolist() == [1]
    assert circle.radii[0] == pytest.approx(3)
    low, high = oval.bounds
    assert high - low == pytest.approx([4, 8], abs=0.02)


def test_ellipses_splines_and_old_polylines() -> None:
    document, space = drawing()
    space.add_ellipse((0, 0), (10, 0), 0.5)
    space.add_spline([(20, 0), (25, 5), (30, 0)])
    space.add_polyline2d([(40, 0, 1), (50, 0, 0)], format="xyb")
    space.add_polyline3d([(60, 0, 5), (70, 0, 9)])
    space.add_solid([(80, 0), (90, 0), (80, 10), (90, 10)])
    oval, spline, half, line, solid = paths(document)
    assert oval.is_closed
    assert oval.length_mm == pytest.approx(48.44, abs=0.01)
    assert spline.points[0].tolist() == pytest.approx([20, 0])
    assert half.turns.tolist() == [1]
    assert line.length_mm == pytest.approx(10)
    assert solid.length_mm == pytest.approx(40)


def test_layers_that_are_off_are_left_out_and_that_is_told() -> None:
    document, space = drawing()
    document.layers.add("HIDDEN").off()
    space.add_line((0, 0), (1, 0))
    space.add_line((5, 0), (9, 0), dxfattribs={"layer": "hidden"})
    found = opened(document)
    assert len(found.paths(0.01)) == 1
    assert found.notes == ["a.dxf: layers that are off or frozen are left out: hidden."]


def test_texts_are_told_once() -> None:
    document, space = drawing()
    space.add_line((0, 0), (1, 0))
    space.add_text("one")
    space.add_text("two")
    space.add_mtext("three")
    found = opened(document)
    assert len(found.paths(0.01)) == 1
    assert [note.split(" ")[1] for note in found.notes] == ["TEXT", "MTEXT"]


def test_of_a_fill_its_edges_are_drawn() -> None:
    document, space = drawing()
    fill = space.add_hatch()
    fill.paths.add_polyline_path([(0, 0, 1), (9, 0, 0), (9, 9, 0), (0, 9, 0)], is_closed=True)
    fill.paths.add_edge_path().add_arc((4, 4), 2, 0, 360)
    outer, hole = paths(document)
    assert outer.is_closed
    assert outer.length_mm == pytest.approx(27 + 4.5 * math.pi, rel=0.01)
    assert hole.is_closed
    assert hole.length_mm == pytest.approx(4 * math.pi, rel=0.01)


def test_the_edge_of_a_fill_that_is_drawn_as_a_line_is_cut_once() -> None:
    document, space = drawing(1)
    corners = [(0, 0), (3, 0), (3, 2), (0, 2)]
    for begin, end in zip(corners, corners[1:] + corners[:1], strict=True):
        space.add_line(begin, end)
    space.add_circle((1, 1), 0.5)
    for _ in range(2):
        fill = space.add_hatch()
        fill.paths.add_polyline_path(corners, is_closed=True)
        fill.paths.add_edge_path().add_arc((1, 1), 0.5, 0, 360)
    fill.paths.add_polyline_path([(1.9, 1), (2.1, 1), (2, 1.2)], is_closed=True)
    found = paths(document)
    assert [path.is_closed for path in found] == [True] * 3
    assert found[2].bounds[0].tolist() == pytest.approx([1.9 * 25.4, 25.4])


def test_dimensions_are_drawn_as_lines() -> None:
    document, space = drawing()
    space.add_linear_dim(base=(0, 5), p1=(0, 0), p2=(20, 0)).render()
    low, high = bounds(paths(document))
    assert (high - low)[0] >= 20
