"""SVG: units, what is seen, what is left out."""

import math

import pytest

from fraese.engrave.shapes import Path, bounds
from fraese.engrave.svgfile import SvgDrawing, read
from fraese.errors import UsageError


def svg(
    inside: str, head: str = 'width="100mm" height="100mm" viewBox="0 0 100 100"'
) -> SvgDrawing:
    space = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    return read(f"<svg {space} {head}>{inside}</svg>".encode(), "a.svg")


def paths(
    inside: str, head: str = 'width="100mm" height="100mm" viewBox="0 0 100 100"'
) -> list[Path]:
    return svg(inside, head).paths(0.01)


def size(found: list[Path]) -> list[float]:
    low, high = bounds(found)
    return [float(side) for side in high - low]


SQUARE = '<rect x="10" y="10" width="20" height="30"/>'


@pytest.mark.parametrize(
    ("head", "width_mm"),
    [
        ('width="100mm" height="100mm" viewBox="0 0 100 100"', 20),
        ('width="4in" height="4in" viewBox="0 0 100 100"', 20 * 1.016),
        ('width="10cm" height="10cm" viewBox="0 0 50 50"', 40),
        ('width="100" height="100"', 20 * 25.4 / 96),
        ('width="100px" height="100px" viewBox="0 0 50 50"', 40 * 25.4 / 96),
        ('viewBox="0 0 100 100"', 20 * 25.4 / 96),
        ('width="72pt" height="72pt" viewBox="0 0 72 72"', 20 * 25.4 / 72),
    ],
)
def test_units(head: str, width_mm: float) -> None:
    assert size(paths(SQUARE, head)) == pytest.approx([width_mm, 1.5 * width_mm])


def test_y_grows_upwards() -> None:
    (path,) = paths('<polyline points="0,0 10,0 10,5" fill="none" stroke="red"/>')
    assert path.points.tolist() == [
        pytest.approx([0, 0]),
        pytest.approx([10, 0]),
        pytest.approx([10, -5]),
    ]


def test_circles_and_round_arcs_stay_arcs_ellipses_do_not() -> None:
    (circle,) = paths('<circle cx="50" cy="50" r="20"/>')
    assert len(circle.turns) == 1
    assert circle.is_closed
    assert circle.length_mm == pytest.approx(40 * math.pi)
    (arc,) = paths('<path d="M10 50 A 20 20 0 0 1 50 50" fill="none" stroke="#000"/>')
    # Up on the paper and to the right: clockwise.
    assert arc.turns.tolist() == [-1]
    assert size([arc]) == pytest.approx([40, 20])
    (oval,) = paths('<g transform="scale(2,1)"><circle cx="20" cy="50" r="10"/></g>')
    assert not oval.turns.any()
    assert size([oval]) == pytest.approx([40, 20], abs=0.02)
    assert oval.length_mm == pytest.approx(96.88, abs=0.02)


def test_round_arcs_in_mirrored_groups_turn_the_other_way() -> None:
    arc = '<path d="M10 50 A 20 20 0 0 1 50 50" fill="none" stroke="#000"/>'
    (path,) = paths(f'<g transform="translate(60,0) scale(-1,1)">{arc}</g>')
    assert path.turns.tolist() == [1]
    assert path.points.tolist() == [pytest.approx([50, -50]), pytest.approx([10, -50])]
    assert size([path]) == pytest.approx([40, 20])
    assert path.bounds[1].tolist() == pytest.approx([50, -30])


@pytest.mark.parametrize("turn", ["", "scale(-1,1)", "rotate(40) scale(1,-2)", "skewX(30)"])
@pytest.mark.parametrize("flags", ["0 0", "0 1", "1 0", "1 1"])
def test_parts_of_ellipses_have_no_jumps(turn: str, flags: str) -> None:
    arc = f'<path d="M10 10 A 20 9 25 {flags} 30 22" fill="none" stroke="red" transform="{turn}"/>'
    (path,) = paths(arc)
    assert len(path.points) > 20
    assert path.lengths.max() < 4 * path.lengths.mean()
    (whole,) = paths(f'<g transform="{turn}"><ellipse cx="9" cy="9" rx="20" ry="9"/></g>')
    assert whole.is_closed
    assert whole.lengths.max() < 4 * whole.lengths.mean()


@pytest.mark.parametrize(
    "inside",
    [
        '<path d="M0 0h24v24H0z" fill="none"/>',
        '<rect width="10" height="10" display="none"/>',
        '<rect width="10" height="10" visibility="hidden"/>',
        f"<defs>{SQUARE}</defs>",
        f'<symbol id="s">{SQUARE}</symbol>',
        f'<clipPath id="c">{SQUARE}</clipPath>',
        f'<g><marker id="m">{SQUARE}</marker></g>',
    ],
)
def test_what_nobody_sees_is_not_cut(inside: str) -> None:
    assert paths(inside) == []


def test_symbols_are_drawn_where_they_are_used() -> None:
    found = paths(f'<symbol id="s">{SQUARE}</symbol><use href="#s" x="40"/><use xlink:href="#s"/>')
    assert len(found) == 2
    assert size(found) == pytest.approx([60, 30])


@pytest.mark.parametrize(
    ("inside", "word"),
    [
        ("<text>hello</text>", "text"),
        ('<image width="5" height="5" href="x.png"/>', "pictures"),
        (f'<clipPath id="c">{SQUARE}</clipPath><g clip-path="url(#c)">{SQUARE}</g>', "clips"),
    ],
)
def test_what_cannot_be_drawn_is_told_once(inside: str, word: str) -> None:
    (note,) = svg(inside + inside + SQUARE).notes
    assert word in note


def test_curves_keep_the_tolerance() -> None:
    curve = '<path d="M0 0 C 0 50 50 50 50 0 Q 60 -20 70 0" fill="none" stroke="red"/>'
    drawing = svg(curve)
    (fine,), (rough,) = drawing.paths(0.0005), drawing.paths(0.05)
    assert 5 < len(rough.points) < len(fine.points) / 5
    for x, y in fine.points[:: len(fine.points) // 200].tolist():
        assert off(rough, x, y) <= 0.0505


def off(path: Path, x: float, y: float) -> float:
    best = math.inf
    for (x0, y0), (x1, y1) in zip(path.points[:-1].tolist(), path.points[1:].tolist(), strict=True):
        dx, dy = x1 - x0, y1 - y0
        share = min(1, max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy or 1)))
        best = min(best, math.hypot(x0 + share * dx - x, y0 + share * dy - y))
    return best


def test_a_drawing_that_uses_itself_is_refused() -> None:
    with pytest.raises(UsageError, match="without end"):
        svg('<g id="a"><use href="#a"/></g>')
