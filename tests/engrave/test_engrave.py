"""``fraese engrave``: every kind of file becomes a program that the machine takes."""

import math
from pathlib import Path

import pytest

from fraese.control.state import Status
from fraese.program.program import open_program
from tests.engrave.bench import SQUARE_SVG, Bench
from tests.engrave.drawings import EVERY
from tests.helpers import homed

DRAWINGS = [name for name in EVERY if not name.endswith("png")]


@pytest.mark.parametrize("name", EVERY)
def test_every_kind_is_cut_as_large_as_wanted(bench: Bench, name: str) -> None:
    file = bench.file(name, EVERY[name])
    # The picture has an edge of 10 dots round the same rectangle.
    wide = 64 if name.endswith("png") else 60
    made = bench.engrave(file, "--width", wide)
    assert made["size_mm"] == pytest.approx([wide, wide * (220 / 320 if wide == 64 else 2 / 3)])
    cut = bench.cut(bench.ways())
    xs = [w.end[0] for w in cut]
    assert max(xs) - min(xs) == pytest.approx(60, abs=0.05)
    total = sum(w.length_mm for w in cut)
    assert total == pytest.approx(200 + 16 * math.pi, rel=0.01 if wide == 64 else 0.001)


@pytest.mark.parametrize("name", DRAWINGS)
def test_circles_stay_arcs_and_what_is_inside_comes_first(bench: Bench, name: str) -> None:
    bench.engrave(bench.file(name, EVERY[name]))
    cut = bench.cut(bench.ways())
    assert [w.kind for w in cut] == ["arc", "feed", "feed", "feed", "feed"]
    assert cut[0].length_mm == pytest.approx(8 * math.pi, abs=0.01)
    # What is up in the drawing is up on the machine.
    assert name == "square.plt" or cut[0].begin[1] > 12


def test_nothing_is_cut_at_the_safe_height_and_no_rapid_goes_below_it(bench: Bench) -> None:
    bench.engrave(bench.file("a.svg", SQUARE_SVG), "--safe-height", 3)
    for way in bench.ways()[1:]:
        sideways = way.begin[:2] != way.end[:2] or way.kind == "arc"
        if sideways and way.kind == "rapid":
            assert way.begin[2] == way.end[2] == 3
        elif sideways:
            assert way.begin[2] == way.end[2] == -0.5
        elif way.kind == "rapid":
            assert way.end[2] == 3


#: Of files in which the circle is not in the upper half: its middle above the lower edge, mm.
CIRCLE_Y_MM = {"square.plt": 4.0}


def _off(x: float, y: float, circle_y: float) -> float:
    """How far a place is from the drawing as it was meant: 12 x 8 mm, and a circle in it."""
    inside = min(x, 12 - x, y, 8 - y)
    beyond = math.hypot(max(-x, x - 12, 0), max(-y, y - 8, 0))
    return min(abs(inside) if inside > 0 else beyond, abs(math.dist((x, y), (6, circle_y)) - 1.6))


def _drawn(circle_y: float) -> list[tuple[float, float]]:
    """Places all along it."""
    turns = [math.tau * n / 24 for n in range(24)]
    return [
        *((12 * n / 24, y) for n in range(25) for y in (0, 8)),
        *((x, 8 * n / 16) for n in range(17) for x in (0, 12)),
        *((6 + 1.6 * math.cos(a), circle_y + 1.6 * math.sin(a)) for a in turns),
    ]


@pytest.mark.parametrize("name", EVERY)
def test_it_is_looked_through_and_run_and_the_carriages_go_along_it(
    bench: Bench, name: str
) -> None:
    # The picture has an edge of 10 dots, 0.4 mm, round the rectangle.
    edge_mm, within_mm = (0.4, 0.06) if name.endswith("png") else (0.0, 0.015)
    bench.engrave(bench.file(name, EVERY[name]), "--spindle", 0, "--width", 12 + 2 * edge_mm)
    assert bench.run("check", bench.folder / "out.ngc").stdout.endswith("ok\n")
    mill = homed()
    # The work lies at X 10, Y 10 and 20 mm below the upper end.
    mill.controller.move_to({"x": 10, "y": 10, "z": -20})
    assert mill.controller.run() is Status.OK
    (bench.folder / "lies.ngc").write_text("G10 L20 P1 X0 Y0 Z0\n" + bench.text)
    cut: list[tuple[float, float]] = []
    start = mill.controller.state().carriages_mm

    def look() -> None:
        x, y, z = (
            now - then
            for now, then in zip(mill.controller.state().carriages_mm, start, strict=True)
        )
        if z < -0.49:
            cut.append((x - edge_mm, y - edge_mm))

    mill.controller.set_break_key(look)
    program = open_program(bench.folder / "lies.ngc")
    program.start(mill.controller)
    assert mill.controller.run() is Status.OK, mill.controller.state().message
    circle_y = CIRCLE_Y_MM.get(name, 6.0)
    assert max(_off(x, y, circle_y) for x, y in cut) < within_mm
    missed = [at for at in _drawn(circle_y) if min(math.dist(at, here) for here in cut) > 0.25]
    assert missed == []
    last = bench.ways()[-1].end
    end = mill.controller.state().carriages_mm
    assert [b - a for a, b in zip(start, end, strict=True)] == pytest.approx(last, abs=0.006)


def test_the_same_file_gives_the_same_program(bench: Bench) -> None:
    file = bench.file("a.svg", SQUARE_SVG)
    bench.engrave(file)
    first = bench.text
    bench.engrave(file)
    assert bench.text == first


def test_a_file_that_is_there_stays(bench: Bench) -> None:
    file, out = bench.file("a.svg", SQUARE_SVG), bench.file("mine.ngc", "G0 X1\n")
    said = bench.refused(file, "-o", out)
    assert "--force" in said
    assert out.read_text() == "G0 X1\n"
    assert bench.run("engrave", file, "-o", out, "--force").exit_code == 0
    assert "M2" in out.read_text()
    assert "not overwritten" in bench.refused(file, "-o", file, "--force")
    assert file.read_text() == SQUARE_SVG


def test_the_program_goes_to_standard_output(bench: Bench) -> None:
    result = bench.run("engrave", bench.file("a.svg", SQUARE_SVG), "-o", "-")
    assert result.exit_code == 0
    assert result.stdout.startswith("(from a.svg: outline; 30.000 x 20.000 mm)\n")
    assert result.stdout.endswith("M2\n")


def test_what_is_no_drawing_is_one_sentence(bench: Bench, tmp_path: Path) -> None:
    assert "cannot be read" in bench.refused("missing.svg", "-o", "x.ngc")
    assert "is no file" in bench.refused(tmp_path, "-o", "x.ngc")
    assert "is empty" in bench.refused(bench.file("e.png", b""), "-o", "x.ngc")
    assert "none of the files" in bench.refused(bench.file("a.svg", "G0 X1\nM2\n"), "-o", "x.ngc")
    broken = bench.file("b.png", EVERY["square.png"][:200])
    assert "as a picture" in bench.refused(broken, "-o", "x.ngc")
    scrap = bench.file("s.png", b"\x89PNG and no more")
    assert "as a picture: it is broken" in bench.refused(scrap, "--output", "x.ngc")
    assert "well-formed" in bench.refused(bench.file("c.svg", "<svg><g></svg>"), "-o", "x.ngc")
    torn = bench.file("t.dxf", "0\nSECTION\n2\nENTITIES\n0\nHATCH\n91\n9\n0\nENDSEC\n0\nEOF\n")
    assert "t.dxf cannot be read as DXF: it is broken." in bench.refused(torn, "-o", "x.ngc")
    half = bench.file("d.dxf", EVERY["binary.dxf"][:400])
    assert "as DXF" in bench.refused(half, "-o", "x.ngc")
    assert "no lines" in bench.refused(bench.file("e.dxf", "0\nSECTION\n2\n"), "-o", "x.ngc")
    assert not (tmp_path / "x.ngc").exists()
