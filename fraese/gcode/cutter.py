"""Cutter compensation: a stage between the interpreter's moves and what comes out.

Rule 1  The interpreter goes on thinking of the path as programmed. Its moves pass through here,
        and come out beside that path, in machine coordinates like all others.
Rule 2  One move waits, since the corner behind it may shorten it; whatever else happens
        meanwhile (spindle, dwell, a stop) waits behind it in its order.
Rule 3  What cannot be done without gouging is refused, with LinuxCNC's rules: an entry no longer
        than the radius, an arc no wider than the cutter, a move that an inside corner eats up.
Rule 4  Plane and work frame stay what they are while it is on.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final, Literal, NamedTuple

from fraese.errors import ProgramError
from fraese.gcode.axes import Plane as PlaneAxes
from fraese.gcode.canon import Arc, End, Feed, Move, Plane, Rapid
from fraese.gcode.outline import (
    SAME_MM,
    Corner,
    Course,
    Flat,
    beside,
    corner,
    entry_centre,
    inside,
    line,
)
from fraese.gcode.position import Position
from fraese.phrases import phrase
from fraese.workframe import Point, WorkFrame

Motion = Rapid | Feed | Arc

#: By the number of an orientation (L): where the controlled point lies from the cutter's centre,
#: in radii, along the first and second axis of the plane. Found on rs274.
ORIENTATIONS: Final[tuple[Flat, ...]] = (
    (0, 0), (1, -1), (-1, -1), (-1, 1), (1, 1), (1, 0), (0, -1), (-1, 0), (0, 1), (0, 0),
)  # fmt: skip
#: By so much an inside corner may lengthen an arc instead of shortening it, rad.
_ROUNDING: Final = 1e-6
_GOUGES: Final = phrase("the cutter cannot go through this inside corner without gouging")


class Side(NamedTuple):
    """How the cutter is kept off the path.

    ``code``: 410, 411, 420 or 421, for ``#<_ccomp>``.
    ``distance_mm``: its radius, negative to the right of the path.
    """

    code: int
    distance_mm: float
    shift: Flat = (0, 0)


@dataclass
class _Waiting:
    """A move whose end is not final. All points lie on the cutter's course.

    ``begin``: where it really starts; ``full``: where it would without the corner before.
    ``bend``: the curvature of the move as programmed.
    """

    move: Motion
    course: Course
    begin: Flat
    full: Flat
    end: Flat
    bend: float = 0.0
    is_entry: bool = False


class Cutter:
    """The stage.

    Args:
        position: of the program.
    """

    def __init__(self, position: Position) -> None:
        self._position = position
        self.side: Side | None = None
        self._plane: Plane = 17
        self._axes = PlaneAxes(0, 1, None)
        self._frame: WorkFrame | None = None
        # As programmed, and as it came out: machine mm.
        self._at: Point = ()
        self._out: Point = ()
        self._waiting: _Waiting | None = None
        self._behind: list[Move] = []
        #: Behind G40 the cutter stands beside its place: only a straight move leads back.
        self._is_beside = False
        self._is_leaving = False

    @property
    def acts(self) -> bool:
        """Moves have to pass through here."""
        return self._is_beside or self.side is not None

    def switch_on(self, side: Side) -> None:
        """G41, G41.1, G42, G42.1.

        Raises:
            ProgramError: not in this plane, or it is on already.
        """
        position = self._position
        self._plane = position.modal.plane
        if self.side is not None:
            raise ProgramError(phrase("cutter compensation is on already; end it with G40 before"))
        if self._plane == 19:
            raise ProgramError(phrase("cutter compensation is of the planes G17 and G18"))
        self._frame = position.coordinates.frame
        if self._frame.is_rotated and self._plane != 17:
            raise ProgramError(
                phrase("a rotated coordinate system allows compensation in G17 only")
            )
        self._axes = position.axes.plane(self._plane, phrase("cutter compensation"))
        self._at = self._out = position.machine
        self.side = side

    def switch_off(self) -> None:
        """G40: what comes next is no more compensated."""
        self._is_leaving = True

    def through(self, moves: Iterable[Move]) -> Iterator[Move]:
        """What comes out for what goes in.

        Raises:
            ProgramError: it cannot be done without gouging.
        """
        for move in moves:
            if self._is_leaving or isinstance(move, End):
                yield from self._leave()
            if not isinstance(move, Rapid | Feed | Arc):
                if self._waiting is None:
                    yield move
                else:
                    self._behind.append(move)
            elif self.side is None:
                yield self._back(move)
            elif not self.side.distance_mm:
                yield move
            else:
                yield from self._take(move)
        if self._is_leaving:
            yield from self._leave()

    def _leave(self) -> Iterator[Move]:
        self._is_leaving = False
        waiting = self._waiting
        if waiting is not None:
            yield from self._flush(waiting.end)
            self._waiting = None
            self._is_beside = True
        self.side = None

    def _back(self, move: Motion) -> Motion:
        if self._is_beside and isinstance(move, Arc):
            raise ProgramError(phrase("behind G40 the first move has to be straight: G0 or G1"))
        self._is_beside = False
        return move

    # --- on the way ----------------------------------------------------------------------------

    def _take(self, move: Motion) -> Iterator[Move]:
        position = self._position
        if position.coordinates.frame != self._frame or position.modal.plane != self._plane:
            raise ProgramError(phrase("plane and offsets must stay as they are under compensation"))
        start, end = self._flat(self._at), self._flat(move.to)
        self._at = move.to
        if isinstance(move, Arc):
            course = Course(move.centre, (0, 0), math.dist(move.centre, end), move.turns > 0)
        elif math.dist(start, end) > SAME_MM:
            course = line(start, end)
        elif self._waiting is None:
            raise ProgramError(
                phrase(
                    "the way to the path has to be longer than the cutter's radius,"
                    " {distance_mm:g} mm; this move does not go across at all",
                    distance_mm=abs(self._distance_mm),
                )
            )
        else:
            self._behind.append(move)
            return
        if self._waiting is None:
            self._enter(move, course, start, end)
        else:
            yield from self._turn(self._waiting, move, course, start, end)

    @property
    def _distance_mm(self) -> float:
        return 0.0 if self.side is None else self.side.distance_mm

    def _enter(self, move: Motion, course: Course, start: Flat, end: Flat) -> None:
        """The first move ends beside its end."""
        distance_mm = self._distance_mm
        radius_mm = abs(distance_mm)
        to = beside(end, course.heading(end), distance_mm)
        if math.dist(start, end) <= radius_mm:
            raise ProgramError(
                phrase(
                    "the way to the path has to be longer than the cutter's radius,"
                    " {radius_mm:g} mm",
                    radius_mm=radius_mm,
                )
            )
        if isinstance(move, Arc):
            is_wide = course.beside(distance_mm).radius_mm > SAME_MM
            centre = entry_centre(start, to, move.centre) if is_wide else None
            if centre is None:
                raise ProgramError(
                    phrase(
                        "no such arc leads from here to the path for a cutter of radius"
                        " {radius_mm:g} mm; begin farther away, or with a straight move",
                        radius_mm=radius_mm,
                    )
                )
            move = replace(move, centre=centre)
            course = course._replace(at=centre, radius_mm=math.dist(centre, to))
        else:
            course = course._replace(at=to)
        self._waiting = _Waiting(move, course, start, start, to, course.bend, is_entry=True)

    def _turn(
        self, before: _Waiting, move: Motion, course: Course, start: Flat, end: Flat
    ) -> Iterator[Move]:
        """Every further move: the corner that leads to it, and the move itself waits."""
        distance_mm = self._distance_mm
        beside_it = course.beside(distance_mm)
        if course.radius_mm and beside_it.radius_mm < SAME_MM:
            raise ProgramError(
                phrase(
                    "the arc of radius {radius_mm:g} mm is too narrow for the cutter's"
                    " radius, {distance_mm:g} mm",
                    radius_mm=course.radius_mm,
                    distance_mm=abs(distance_mm),
                )
            )
        heading = course.heading(start)
        begin = full = beside(start, heading, distance_mm)
        bends = before.bend + course.bend
        kind = corner(before.course.heading(before.end), heading, bends, distance_mm)
        if kind is Corner.INSIDE:
            crossing = inside(before.course, beside_it, distance_mm)
            if crossing is None:
                raise ProgramError(_GOUGES)
            yield from self._flush(crossing)
            begin = crossing
        else:
            yield from self._flush(before.end)
            if kind is Corner.OUTSIDE:
                yield self._round(move, start, full)
            else:
                begin = full = before.end
        to = beside(end, course.heading(end), distance_mm)
        self._waiting = _Waiting(move, beside_it, begin, full, to, course.bend)

    def _round(self, move: Motion, about: Flat, to: Flat) -> Motion:
        """Round an outside corner to where the next move begins; a rapid cuts it short."""
        point = self._placed(self._out, to)
        self._out = point
        if isinstance(move, Rapid):
            return Rapid(move.line, point)
        turns: Literal[-1, 1] = -1 if self._distance_mm > 0 else 1
        return Arc(move.line, point, self._shifted(about), self._plane, turns, move.feed_mm_min)

    def _flush(self, end: Flat) -> Iterator[Move]:
        """Let the waiting move go, and what stands behind it.

        Raises:
            ProgramError: nothing is left of it.
        """
        waiting = self._waiting
        assert waiting is not None
        _check_left(waiting, end)
        move = waiting.move
        if isinstance(move, Arc):
            move = replace(move, centre=self._shifted(move.centre))
        behind, self._behind = self._behind, []
        for each in (move, *behind):
            if isinstance(each, Rapid | Feed | Arc):
                self._out = self._placed(each.to, end)
                yield replace(each, to=self._out)
            else:
                yield each

    # --- points --------------------------------------------------------------------------------

    def _flat(self, point: Point) -> Flat:
        return point[self._axes.first], point[self._axes.second]

    def _shifted(self, point: Flat) -> Flat:
        """Where the controlled point is when the cutter's centre is there."""
        assert self.side is not None
        radius_mm = abs(self.side.distance_mm)
        a, b = self.side.shift
        return point[0] + a * radius_mm, point[1] + b * radius_mm

    def _placed(self, point: Point, flat: Flat) -> Point:
        to = list(point)
        to[self._axes.first], to[self._axes.second] = self._shifted(flat)
        return tuple(to)


def _check_left(waiting: _Waiting, end: Flat) -> None:
    """See that a move goes on in its direction when both its ends are cut."""
    course = waiting.course
    if not course.radius_mm:
        way = end[0] - waiting.begin[0], end[1] - waiting.begin[1]
        along = way[0] * course.direction[0] + way[1] * course.direction[1]
        if not waiting.is_entry and along < -SAME_MM:
            raise ProgramError(_GOUGES)
        return
    whole = course.sweep(waiting.full, waiting.end) or math.tau
    cut = course.sweep(waiting.full, waiting.begin) + course.sweep(end, waiting.end)
    if not waiting.is_entry and cut > whole + _ROUNDING:
        raise ProgramError(_GOUGES)
