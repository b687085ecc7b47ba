"""Drawings in SVG, read by svgelements.

    text --> tree --checked, definitions put away--> text --svgelements--> shapes --> paths in mm

Rule 1: a pixel is 1/96 inch, as CSS has it; width, height and viewBox say the rest.
Rule 2: what nobody sees is not cut: shapes without fill and stroke, hidden ones, definitions.
Rule 3: circles and circular arcs stay arcs; others are flattened when paths are asked for.
"""

import io
import math
from collections import Counter
from collections.abc import Iterator
from typing import Any, Final
from xml.etree import ElementTree

import numpy as np
import svgelements

from fraese.engrave import curves
from fraese.engrave.chains import chained
from fraese.engrave.drawing import checked
from fraese.engrave.shapes import Path, Points, arc, one, straight
from fraese.errors import FraeseError, UsageError
from fraese.phrases import phrase
from fraese.plaintext import plain

_PX_MM: Final = 25.4 / 96
#: Elements of a drawing at most, those counted that are used again and again.
_MOST: Final = 500_000
_DEEPEST: Final = 200
_SVG: Final = "{http://www.w3.org/2000/svg}"
_HREFS: Final = ("{http://www.w3.org/1999/xlink}href", "href")
#: What is drawn only where it is referred to, or never.
_ASIDE: Final = ("symbol", "marker", "mask", "pattern", "clipPath", "filter")
#: Elements that cannot be drawn here, and what is said of them.
_UNDRAWN: Final = {
    "text": phrase("text"),
    "image": phrase("pictures"),
    "foreignObject": phrase("foreign objects"),
}
#: Ellipses whose radii differ by less than this share are circles.
_ROUND: Final = 1e-6
#: Points that are no further apart are one.
_SAME_MM: Final = 1e-6

Element = ElementTree.Element


class SvgDrawing:
    """See ``drawing.Drawing``.

    Args:
        data: what is in the file.
        name: of the file.

    Raises:
        UsageError: if it is no SVG, or has more elements than can be drawn.
    """

    def __init__(self, data: bytes, name: str) -> None:
        self._name = name
        tree = _tree(data, name)
        self.notes = [str(note) for note in _left_out(tree, name)]
        self._shapes = list(_shapes(tree, name))

    def paths(self, tolerance_mm: float) -> list[Path]:
        """See ``drawing.Drawing``."""
        found = [path for shape in self._shapes for path in _subpaths(shape, tolerance_mm)]
        return chained(checked(found, self._name))


def read(data: bytes, name: str) -> SvgDrawing:
    """A drawing.

    Raises:
        UsageError: if it cannot be read.
    """
    return SvgDrawing(data, name)


# --- the tree ----------------------------------------------------------------------------------


def _tree(data: bytes, name: str) -> Element:
    try:
        tree = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise UsageError(
            phrase("{name} is no well-formed SVG: {why}.", name=name, why=plain(str(error)))
        ) from error
    _check_size(tree, name)
    _put_aside(tree)
    return tree


def _check_size(tree: Element, name: str) -> None:
    """Drawings that use themselves, or parts of parts ten times over, would never end."""
    by_id = {each.get("id", ""): each for each in tree.iter()}
    sizes: dict[Element, int] = {}
    too_much = UsageError(
        phrase("{name} uses parts of itself without end, or too often.", name=name)
    )

    def size(element: Element, depth: int) -> int:
        if depth > _DEEPEST or sizes.get(element) == 0:
            raise too_much
        if element not in sizes:
            sizes[element] = 0
            total = 1 + sum(size(child, depth + 1) for child in element)
            used = _used(element, by_id)
            total += 0 if used is None else size(used, depth + 1)
            if total > _MOST:
                raise too_much
            sizes[element] = total
        return sizes[element]

    size(tree, 0)


def _used(element: Element, by_id: dict[str, Element]) -> Element | None:
    if _word(element) != "use":
        return None
    link = next((element.get(href, "") for href in _HREFS if element.get(href)), "")
    return by_id.get(link[1:]) if link[1:] else None


def _word(element: Element) -> str:
    """Its tag without the name space; comments have none."""
    return element.tag.removeprefix(_SVG) if isinstance(element.tag, str) else ""


def _put_aside(tree: Element) -> None:
    """Let definitions outside of ``defs`` be in one, so that they are not drawn by themselves."""
    for parent in list(tree.iter()):
        if _word(parent) == "defs":
            continue
        for place, child in enumerate(list(parent)):
            if _word(child) in _ASIDE:
                aside = Element(f"{_SVG}defs")
                aside.append(child)
                parent[place] = aside


def _left_out(tree: Element, name: str) -> Iterator[str]:
    """A sentence for each kind of element that is not drawn."""
    counts = Counter(map(_word, tree.iter()))
    for word, what in _UNDRAWN.items():
        if counts[word]:
            yield phrase(
                "{name}: {what} ({count}) cannot be drawn; make paths of it in the program that"
                " it comes from.",
                name=name,
                what=what,
                count=counts[word],
            )
    if any(each.get("clip-path") or each.get("mask") for each in tree.iter()):
        yield phrase(
            "{name}: clips and masks are not applied; all of what they hide is cut.", name=name
        )


# --- shapes ------------------------------------------------------------------------------------


def _shapes(tree: Element, name: str) -> Iterator[Any]:
    """Everything that is seen, as paths of svgelements in pixels."""
    text = io.BytesIO(ElementTree.tostring(tree))
    try:
        drawn = svgelements.SVG.parse(text, ppi=96)
        if isinstance(drawn, svgelements.SVG):
            for shape in drawn.elements():
                if isinstance(shape, svgelements.Shape) and _is_seen(shape):
                    path = svgelements.Path(shape)
                    path.reify()
                    yield path
    except FraeseError:
        raise
    except Exception as error:
        # Of values that make no sense it raises nearly anything.
        raise UsageError(
            phrase("{name} cannot be read as SVG: {why}.", name=name, why=plain(repr(error)))
        ) from error


def _is_seen(shape: Any) -> bool:
    if shape.values.get("visibility") in ("hidden", "collapse"):
        return False
    return any(
        colour is not None and colour.value is not None for colour in (shape.fill, shape.stroke)
    )


def _subpaths(shape: Any, tolerance_mm: float) -> Iterator[Path]:
    """What a shape draws without lifting the pen."""
    parts: list[Path] = []
    for segment in shape:
        if isinstance(segment, svgelements.Move):
            if parts:
                yield _ended(parts)
            parts = []
            continue
        if segment.start is None or segment.end is None:
            continue
        is_close = isinstance(segment, svgelements.Close)
        # Mostly the last point is the first one already.
        if not (is_close and parts and abs(segment.end - segment.start) * _PX_MM < _SAME_MM):
            parts.append(_piece(segment, tolerance_mm))
        if is_close:
            yield _ended(parts)
            parts = []
    if parts:
        yield _ended(parts)


def _ended(parts: list[Path]) -> Path:
    path = _with_whole_arcs(one(parts))
    begin, end = path.points[0], path.points[-1]
    if len(path.points) > 2 and np.allclose(begin, end, rtol=0, atol=_SAME_MM):
        path.points[-1] = begin
    return path


def _with_whole_arcs(path: Path) -> Path:
    """Arcs that go on round the same centre as one: a circle comes in quarters."""
    turns, centres = path.turns, path.centres
    if len(turns) < 2 or not turns.any():
        return path
    same = (turns[1:] == turns[:-1]) & (turns[1:] != 0)
    near = np.hypot(*(centres[1:] - centres[:-1]).T) <= 1e-6 * (1 + path.radii[1:])
    goes_on = np.concatenate(((False,), same & np.nan_to_num(near, nan=0).astype(bool)))
    swept = 0.0
    for number, sweep in enumerate(np.abs(path.sweeps).tolist()):
        swept = swept + sweep if goes_on[number] else sweep
        if swept > 2 * math.pi + 1e-6:
            goes_on[number], swept = False, sweep
    kept = np.flatnonzero(~goes_on)
    ends = np.append(kept[1:], len(turns))
    points = np.concatenate((path.points[:1], path.points[ends]))
    for number in np.flatnonzero(turns[kept]).tolist():
        if np.allclose(points[number], points[number + 1], rtol=0, atol=_SAME_MM):
            points[number + 1] = points[number]
    return Path(points, centres[kept], turns[kept])


def _piece(segment: Any, tolerance_mm: float) -> Path:
    begin, end = _mm(segment.start), _mm(segment.end)
    match segment:
        case svgelements.QuadraticBezier():
            return straight(curves.bezier([begin, _mm(segment.control), end], tolerance_mm))
        case svgelements.CubicBezier():
            controls = [begin, _mm(segment.control1), _mm(segment.control2), end]
            return straight(curves.bezier(controls, tolerance_mm))
        case svgelements.Arc():
            return _arc(segment, begin, end, tolerance_mm)
    return straight([begin, end])


def _arc(segment: Any, begin: Points, end: Points, tolerance_mm: float) -> Path:
    radii, sweep = (float(segment.rx), float(segment.ry)), float(segment.sweep)
    if abs(radii[0] - radii[1]) <= _ROUND * max(radii) and sweep:
        # Angles grow downwards there.
        return arc(begin, end, _mm(segment.center), -1 if sweep > 0 else 1)

    centre = _mm(segment.center)
    across, up = _mm(segment.prx) - centre, _mm(segment.pry) - centre
    frame = np.column_stack((across, up))
    side = float(np.linalg.det(frame))
    if abs(side) < _SAME_MM**2:
        return straight([begin, end])
    # It turns downwards, its frame may be mirrored.
    swept = -sweep if side > 0 else sweep
    # Its own angle at the start is wrong in turned and mirrored groups.
    c, s = np.linalg.solve(frame, begin - centre)
    first = math.atan2(s, c)

    def where(shares: Points) -> Points:
        angles = (first + swept * shares)[:, None]
        return np.asarray(centre + across * np.cos(angles) + up * np.sin(angles))

    points = curves.sampled(where, sweep, max(radii) * _PX_MM, tolerance_mm)
    points[0], points[-1] = begin, end
    return straight(points)


def _mm(point: Any) -> Points:
    return np.array((point.x * _PX_MM, -point.y * _PX_MM))
