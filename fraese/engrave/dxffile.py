"""Drawings in DXF, read by ezdxf.

Rule 1: $INSUNITS says what a unit is; without it, mm, and that is noted.
Rule 2: what the model space shows is drawn: blocks where they are inserted; no layers that are
        off or frozen; nothing of the paper space.
Rule 3: lines, arcs, circles and polylines with their bulges stay what they are; all other curves
        are flattened when paths are asked for.
Rule 4: of a fill its edge is drawn, unless it is drawn as a line already.
"""

import io
import logging
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path as FilePath
from typing import Any, Final

import numpy as np

from fraese.engrave.chains import MEETING_MM, chained, unlike
from fraese.engrave.drawing import checked
from fraese.engrave.nofonts import no_fonts
from fraese.engrave.shapes import Path, Points, arc, circle, one, straight
from fraese.errors import FraeseError, UsageError
from fraese.phrases import phrase
from fraese.plaintext import plain

with no_fonts():
    from ezdxf import recover
    from ezdxf.filemanagement import readfile
    from ezdxf.path import make_path
    from ezdxf.protocols import SupportsVirtualEntities, virtual_entities

#: Entities of a drawing at most, those counted that are inserted again and again.
_MOST: Final = 500_000
_DEEPEST: Final = 50
_BINARY: Final = b"AutoCAD Binary DXF"
#: mm of a unit, by its number in $INSUNITS.
_UNITS_MM: Final = {
    1: 25.4,
    2: 304.8,
    3: 1_609_344.0,
    4: 1.0,
    5: 10.0,
    6: 1e3,
    7: 1e6,
    8: 25.4e-6,
    9: 0.0254,
    10: 914.4,
    11: 1e-7,
    12: 1e-6,
    13: 1e-3,
    14: 100.0,
    15: 1e4,
    16: 1e5,
    17: 1e12,
    21: 1200 / 3937 * 1e3,
    22: 100 / 3937 * 1e3,
    23: 3600 / 3937 * 1e3,
}
#: What has no line that could be cut, and need not be told of.
_WITHOUT_LINE: Final = frozenset({"POINT", "VIEWPORT", "ATTDEF", "SEQEND"})
#: Of these the edge is taken.
_FILLS: Final = frozenset({"HATCH", "MPOLYGON"})
#: Of a vertex: it belongs to the frame of a spline.
_FRAME: Final = 16
#: A direction that the drawing is seen from, or from behind.
_FLAT: Final = 1e-9

Entity = Any
logging.getLogger("ezdxf").addHandler(logging.NullHandler())
logging.getLogger("ezdxf").propagate = False


class DxfDrawing:
    """See ``drawing.Drawing``.

    Args:
        data: what is in the file.
        name: of the file.

    Raises:
        UsageError: if it is no DXF, or has more entities than can be drawn.
    """

    def __init__(self, data: bytes, name: str) -> None:
        self._name = name
        self.notes: list[str] = []
        with _refusals(name):
            document = _document(data)
            self._unit_mm = self._unit(document)
            # What cannot be drawn is found out when it is tried.
            undrawn = Counter[str]()
            drawn = self._drawn(document)
            entities = [each for each in drawn if _is_drawn(each, undrawn)]
        self._fills = [each for each in entities if each.dxftype() in _FILLS]
        self._entities = [each for each in entities if each.dxftype() not in _FILLS]
        self._note(undrawn)

    def paths(self, tolerance_mm: float) -> list[Path]:
        """See ``drawing.Drawing``."""
        with _refusals(self._name):
            lines = self._scaled(self._entities, tolerance_mm)
            fills = self._scaled(self._fills, tolerance_mm)
        drawn = chained(checked(lines, self._name))
        edges = [path for path in chained(checked(fills, self._name)) if path.is_closed]
        return drawn + unlike(edges, drawn, MEETING_MM + 2 * tolerance_mm)

    def _scaled(self, entities: Sequence[Entity], tolerance_mm: float) -> list[Path]:
        """What they draw, mm."""
        return [
            path.placed(self._unit_mm, (0.0, 0.0))
            for entity in entities
            for path in _paths(entity, tolerance_mm / self._unit_mm)
        ]

    def _note(self, undrawn: Counter[str]) -> None:
        """A sentence for each kind that is left out."""
        for kind, count in undrawn.items():
            self.notes.append(
                phrase(
                    "{name}: {what} ({count}) cannot be drawn; make paths of it in the program that"
                    " it comes from.",
                    name=self._name,
                    what=plain(kind),
                    count=count,
                )
            )

    def _unit(self, document: Any) -> float:
        number = int(document.header.get("$INSUNITS", 0))
        if not number:
            self.notes.append(phrase("{name} says no unit; mm are assumed.", name=self._name))
            return 1.0
        if number not in _UNITS_MM:
            self.notes.append(
                phrase(
                    "{name} has the unit {number}, which is not known; mm are assumed.",
                    name=self._name,
                    number=number,
                )
            )
        return _UNITS_MM.get(number, 1.0)

    def _drawn(self, document: Any) -> Iterator[Entity]:
        """Entities in the end, behind blocks and dimensions."""
        hidden = {
            layer.dxf.name.lower()
            for layer in document.layers
            if layer.is_off() or layer.is_frozen()
        }
        if hidden:
            self.notes.append(
                phrase(
                    "{name}: layers that are off or frozen are left out: {layers}.",
                    name=self._name,
                    layers=plain(", ".join(sorted(hidden))),
                )
            )
        for count, entity in enumerate(_decomposed(document.modelspace(), self._name, 0)):
            if count >= _MOST:
                raise UsageError(
                    phrase("{name} has more than {most} entities.", name=self._name, most=_MOST)
                )
            if entity.dxf.get("layer", "0").lower() not in hidden and not entity.dxf.get(
                "invisible", 0
            ):
                yield entity


def read(data: bytes, name: str) -> DxfDrawing:
    """A drawing.

    Raises:
        UsageError: if it cannot be read.
    """
    return DxfDrawing(data, name)


@contextmanager
def _refusals(name: str) -> Iterator[None]:
    """Whatever ezdxf raises is one sentence: of broken files it raises nearly anything."""
    try:
        yield
    except FraeseError:
        raise
    except Exception as error:
        # What it stumbles over says nothing to whoever drew it.
        stumbled = isinstance(error, LookupError | TypeError | AttributeError)
        said = "" if stumbled else plain(str(error)).strip().rstrip(".")
        raise UsageError(
            phrase(
                "{name} cannot be read as DXF: {why}.",
                name=name,
                why=said or phrase("it is broken"),
            )
        ) from error


def _document(data: bytes) -> Any:
    if data.startswith(_BINARY):
        with tempfile.TemporaryDirectory() as folder:
            # Only files are read with what belongs to them.
            file = FilePath(folder) / "drawing.dxf"
            file.write_bytes(data)
            return readfile(file)
    document, _ = recover.read(io.BytesIO(data))
    return document


def _decomposed(entities: Any, name: str, depth: int) -> Iterator[Entity]:
    if depth > _DEEPEST:
        raise UsageError(
            phrase("{name} uses parts of itself without end, or too often.", name=name)
        )
    for entity in entities:
        if entity.dxftype() == "INSERT":
            inserted = entity.multi_insert() if entity.mcount > 1 else (entity,)
            for each in inserted:
                yield from each.attribs
                yield from _decomposed(virtual_entities(each), name, depth + 1)
        elif entity.dxftype() not in _DIRECT and isinstance(entity, SupportsVirtualEntities):
            yield from _decomposed(virtual_entities(entity), name, depth + 1)
        else:
            yield entity


# --- what entities draw ------------------------------------------------------------------------


def _is_drawn(entity: Entity, undrawn: Counter[str]) -> bool:
    kind = entity.dxftype()
    if kind in _DIRECT:
        return True
    if kind in _WITHOUT_LINE:
        return False
    try:
        make_path(entity)
    except TypeError:
        undrawn[kind] += 1
        return False
    return True


def _paths(entity: Entity, tolerance: float) -> Iterator[Path]:
    yield from _DIRECT.get(entity.dxftype(), _flattened)(entity, tolerance)


def _flattened(entity: Entity, tolerance: float) -> Iterator[Path]:
    """Ellipses, splines, hatches and the like."""
    for part in make_path(entity).sub_paths():
        if len(part):
            points = np.array([(at.x, at.y) for at in part.flattening(tolerance)])
            yield straight(points, close=part.is_closed)


def _line(entity: Entity, _tolerance: float) -> Iterator[Path]:
    begin, end = entity.dxf.start, entity.dxf.end
    yield straight(((begin.x, begin.y), (end.x, end.y)))


def _arc(entity: Entity, tolerance: float) -> Iterator[Path]:
    side = _side(entity)
    if not side:
        yield from _flattened(entity, tolerance)
        return
    begin, end = entity.start_point, entity.end_point
    centre = entity.ocs().to_wcs(entity.dxf.center)
    if abs(entity.dxf.radius) > 0:
        yield arc((begin.x, begin.y), (end.x, end.y), (centre.x, centre.y), side)


def _circle(entity: Entity, tolerance: float) -> Iterator[Path]:
    if not _side(entity):
        yield from _flattened(entity, tolerance)
        return
    centre = entity.ocs().to_wcs(entity.dxf.center)
    if abs(entity.dxf.radius) > 0:
        yield circle((centre.x, centre.y), abs(entity.dxf.radius))


def _side(entity: Entity) -> int:
    """1: seen from above; -1: from below, so it turns the other way; 0: neither."""
    extrusion = entity.dxf.extrusion
    if abs(extrusion.x) > _FLAT or abs(extrusion.y) > _FLAT:
        return 0
    return 1 if extrusion.z > 0 else -1


def _polyline(entity: Entity, tolerance: float) -> Iterator[Path]:
    is_flat = entity.dxftype() == "LWPOLYLINE" or entity.is_2d_polyline
    if not is_flat or not _side(entity):
        if entity.dxftype() == "POLYLINE" and not (is_flat or entity.is_3d_polyline):
            for face in entity.virtual_entities():
                yield from _flattened(face, tolerance)
            return
        yield from _flattened(entity, tolerance)
        return
    corners, is_closed = _corners(entity)
    at = [entity.ocs().to_wcs((x, y, 0)) for x, y, _ in corners]
    points = [(p.x, p.y) for p in at]
    bulges = [bulge * _side(entity) for *_, bulge in corners]
    if is_closed and len(points) > 1:
        points.append(points[0])
    pieces = [
        _bulged(np.array(begin), np.array(end), bulge)
        for begin, end, bulge in zip(points[:-1], points[1:], bulges, strict=False)
        if begin != end
    ]
    if pieces:
        yield one(pieces)


def _corners(entity: Entity) -> tuple[list[tuple[float, float, float]], bool]:
    """X, Y and bulge of each, and whether the last one leads to the first."""
    if entity.dxftype() == "LWPOLYLINE":
        return [(x, y, bulge) for x, y, bulge in entity.get_points("xyb")], bool(entity.closed)
    found = []
    for vertex in entity.vertices:
        # Of splines that were made lines the frame stays in the file.
        if not vertex.dxf.get("flags", 0) & _FRAME:
            found.append((*vertex.format("xy"), float(vertex.dxf.get("bulge", 0.0))))
    return found, bool(entity.is_closed)


def _bulged(begin: Points, end: Points, bulge: float) -> Path:
    """A straight line, or the arc whose bulge is the tangent of a quarter of its angle."""
    if abs(bulge) < 1e-9:
        return straight((begin, end))
    middle, way = (begin + end) / 2, end - begin
    left = np.array((-way[1], way[0]))
    centre = middle + left * (1 - bulge * bulge) / (4 * bulge)
    return arc(begin, end, centre, 1 if bulge > 0 else -1)


_DIRECT: Final[dict[str, Callable[[Entity, float], Iterator[Path]]]] = {
    "LINE": _line,
    "ARC": _arc,
    "CIRCLE": _circle,
    "LWPOLYLINE": _polyline,
    "POLYLINE": _polyline,
}
