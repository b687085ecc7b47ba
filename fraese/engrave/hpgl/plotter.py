"""A pen on paper: where it is, what it draws, and how numbers become places.

    user units --scaled by SC and IP, turned by RO--> plotter units --0.025 mm--> paths

Rule 1: places are kept in mm, so that a new scale does not move the pen.
Rule 2: what would be drawn twice exactly is drawn once: a filled rectangle and its edge.
"""

import math
from typing import Final

import numpy as np

from fraese.engrave import curves
from fraese.engrave.chains import chained
from fraese.engrave.shapes import Path, Points, arc, one, straight
from fraese.phrases import phrase

UNIT_MM: Final = 0.025
#: P1 and P2 where no IP says them: an A4 plotter (HP 7475A).
_P1, _P2 = (603.0, 521.0), (10603.0, 7721.0)
_FULL_DEG: Final = 360.0

Place = tuple[float, float]


class Plotter:
    """What the commands of a file act on.

    Args:
        name: of the file.
        tolerance_mm: of what has to be flattened.

    Attributes:
        paths: what is drawn so far, mm.
        notes: what was passed over, a sentence each.
    """

    def __init__(self, name: str, tolerance_mm: float) -> None:
        self.paths: list[Path] = []
        self.notes: list[str] = []
        self.polygon: list[Path] | None = None
        self._name = name
        self._tolerance_mm = tolerance_mm
        self._noted: set[str] = set()
        self._shapes: set[bytes] = set()
        self._pens: set[int] = set()
        self.reset()

    def reset(self) -> None:
        """As it is when it is switched on; what was drawn stays."""
        self.is_down = self.is_relative = False
        self._at = np.zeros(2)
        self._trail: list[Points] = []
        self._corners = (_P1, _P2)
        self._user: tuple[float, float, float, float] | None = None
        self._isotropic = False
        self._turn = 0
        self._was_down = False
        self.polygon = None
        self._last_polygon: list[Path] = []
        self._lay_scale()

    # --- what is said -------------------------------------------------------------------------

    def note(self, key: str, sentence: str) -> None:
        """Say something of a command, once."""
        if key not in self._noted:
            self._noted.add(key)
            self.notes.append(phrase("{name}: {sentence}", name=self._name, sentence=sentence))

    def take_pen(self, number: int) -> None:
        """All pens cut alike."""
        if number:
            self._pens.add(number)
        if len(self._pens) > 1:
            self.note("SP", phrase("SP: several pens are used; all of them cut alike."))

    # --- how numbers become places --------------------------------------------------------------

    def scale(self, user: tuple[float, float, float, float] | None, *, isotropic: bool) -> None:
        """SC: numbers are user units from now on; None: plotter units again."""
        self._user, self._isotropic = user, isotropic
        self._lay_scale()

    def frame(self, p1: Place, p2: Place) -> None:
        """IP: the two places that SC is about."""
        self._corners = (p1, p2)
        self._lay_scale()

    def usual_frame(self) -> None:
        """IP alone: as a plotter has it without."""
        self._corners = (_P1, _P2)
        self._lay_scale()

    @property
    def is_framed(self) -> bool:
        """IP has been said."""
        return self._corners != (_P1, _P2)

    def size(self) -> Place:
        """From P1 to P2."""
        (x1, y1), (x2, y2) = self._corners
        return x2 - x1, y2 - y1

    def rotate(self, quarters: int) -> None:
        """RO: the coordinate system is turned."""
        self._turn = quarters % 4
        self._lay_scale()

    def _lay_scale(self) -> None:
        factor, offset = np.ones(2), np.zeros(2)
        if self._user is not None:
            low = np.array((self._user[0], self._user[2]))
            span = np.array((self._user[1], self._user[3])) - low
            p1, p2 = np.array(self._corners[0]), np.array(self._corners[1])
            factor = (p2 - p1) / span
            if self._isotropic:
                least = float(np.abs(factor).min())
                rest = (p2 - p1) - np.sign(factor) * least * span
                factor, p1 = np.sign(factor) * least, p1 + rest / 2
            offset = p1 - factor * low
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[self._turn]
        turn = np.array(((c, -s), (s, c)), np.float64)
        self._matrix, self._shift = UNIT_MM * turn * factor, UNIT_MM * turn @ offset
        self._is_round = bool(np.isclose(abs(factor[0]), abs(factor[1]), rtol=1e-9))
        self._side = 1 if factor[0] * factor[1] > 0 else -1

    def _place(self, user: Points) -> Points:
        there: Points = self._matrix @ user + self._shift
        return there

    def here(self) -> Points:
        """Where the pen is, in the unit that numbers have now."""
        return np.asarray(np.linalg.solve(self._matrix, self._at - self._shift), np.float64)

    def target(self, x: float, y: float, *, relative: bool | None = None) -> Points:
        """The place that two numbers mean, in their unit."""
        is_way = self.is_relative if relative is None else relative
        there = np.array((x, y), np.float64)
        return self.here() + there if is_way else there

    # --- what is drawn --------------------------------------------------------------------------

    def go(self, user: Points, *, draws: bool | None = None) -> None:
        """Move in a straight line."""
        to = self._place(user)
        if self.is_down if draws is None else draws:
            if not self._trail:
                self._trail.append(self._at)
            self._trail.append(to)
        else:
            self.lift()
        self._at = to

    def lift(self) -> None:
        """What the pen has drawn until now is a path."""
        if len(self._trail) > 1:
            self._keep(straight(np.array(self._trail)))
        self._trail = []

    def touch(self) -> None:
        """The pen comes down; where it does not move it leaves a dot."""
        if not self.is_down:
            self.lift()
            self._trail = [self._at]
        self.is_down = True

    def rise(self) -> None:
        """The pen goes up."""
        if self.is_down and len(self._trail) == 1 and self.polygon is None:
            self._keep(straight(self._trail[0]))
        self.lift()
        self.is_down = False

    def swing(self, centre: Points, sweep_deg: float, *, draws: bool | None = None) -> None:
        """Move along an arc round a place."""
        begin = self.here()
        path, end = self._arc(begin, centre, sweep_deg)
        is_drawn = (self.is_down if draws is None else draws) and path is not None
        if is_drawn and path is not None:
            self.lift()
            self._keep(path)
        elif not is_drawn:
            self.lift()
        self._at = self._place(end)
        if is_drawn and self.is_down:
            self._trail = [self._at]

    def bend(self, controls: Points) -> None:
        """Move along a cubic curve from here."""
        begin = self._at
        at = np.array([begin, *map(self._place, controls)])
        for point in curves.bezier(at, self._tolerance_mm)[1:]:
            if self.is_down:
                self._trail = self._trail or [begin]
                self._trail.append(point)
        self._at = at[-1]

    def ring(self, radius: float) -> None:
        """A circle round the pen, which stays where it is, up or down."""
        here, at, trail = self.here(), self._at, self._trail
        path, _ = self._arc(here + np.array((radius, 0.0)), here, _FULL_DEG)
        self.lift()
        if path is not None:
            self._keep(path)
        self._at, self._trail = at, trail[-1:]

    def outline(self, corners: list[Points]) -> None:
        """A closed shape, whatever the pen does; it stays where it is."""
        self.lift()
        self._add([straight(np.array([self._place(at) for at in corners]), close=True)])

    def wedge(self, radius: float, start_deg: float, sweep_deg: float) -> None:
        """A piece of a cake round the pen; it stays where it is."""
        self.lift()
        here = self.here()
        turn = math.radians(start_deg)
        begin = here + radius * np.array((math.cos(turn), math.sin(turn)))
        path, end = self._arc(begin, here, sweep_deg)
        if path is None:
            return
        if abs(sweep_deg) >= _FULL_DEG:
            self._add([path])
            return
        middle = self._place(here)
        first, last = self._place(begin), self._place(end)
        path.points[0], path.points[-1] = first, last
        points = np.concatenate(((middle,), path.points, (middle,)))
        gap = np.full((1, 2), np.nan)
        none = np.zeros(1, np.int8)
        centres = np.concatenate((gap, path.centres, gap))
        self._add([Path(points, centres, np.concatenate((none, path.turns, none)))])

    def _arc(self, begin: Points, centre: Points, sweep_deg: float) -> tuple[Path | None, Points]:
        """An arc in user units as a path in mm, and where it ends; None: it has no length."""
        away = begin - centre
        radius = math.hypot(*away)
        sweep = math.radians(max(-_FULL_DEG, min(_FULL_DEG, sweep_deg)))
        first = math.atan2(away[1], away[0])
        is_full = abs(sweep_deg) >= _FULL_DEG
        turned = math.radians(math.fmod(sweep_deg, _FULL_DEG))
        last = first + turned
        end = begin if not turned else centre + radius * np.array((math.cos(last), math.sin(last)))
        if not radius or not sweep:
            return None, begin
        where = self._place
        if self._is_round:
            turn = self._side * (1 if sweep > 0 else -1)
            to = begin if is_full else end
            return arc(where(begin), where(to), where(centre), turn), end

        def at(shares: Points) -> Points:
            angles = first + sweep * shares
            around = centre + radius * np.column_stack((np.cos(angles), np.sin(angles)))
            return around @ self._matrix.T + self._shift

        widest = radius * float(np.abs(self._matrix).max())
        points = curves.sampled(at, sweep, widest, self._tolerance_mm)
        return straight(points, close=is_full), end

    def _keep(self, path: Path) -> None:
        if self.polygon is not None:
            self.polygon.append(path)
        else:
            self.paths.append(path)

    def _add(self, shapes: list[Path]) -> None:
        """Closed shapes, each once."""
        for shape in shapes:
            key = shape.points.tobytes() + shape.turns.tobytes()
            if key not in self._shapes:
                self._shapes.add(key)
                self._keep(shape)

    # --- polygons -------------------------------------------------------------------------------

    def begin_polygon(self) -> None:
        """PM0: from now on moves are corners, whether the pen is down or not."""
        self.lift()
        self.polygon = []
        self._trail = [self._at]
        self._was_down, self.is_down = self.is_down, True

    def close_polygon(self) -> None:
        """PM1: what follows is another part of the polygon."""
        if self.polygon is not None:
            self.lift()
            self._trail = [self._at]

    def end_polygon(self) -> None:
        """PM2: it is kept until it is drawn."""
        if self.polygon is None:
            return
        self.lift()
        self._last_polygon = chained(self.polygon)
        self.polygon, self.is_down = None, self._was_down
        if self.is_down:
            self._trail = [self._at]

    def draw_polygon(self) -> None:
        """EP, FP: the edge of the polygon."""
        if self.polygon is None:
            trail = self._trail
            self.lift()
            self._add([_closed(path) for path in self._last_polygon])
            self._trail = trail[-1:]


def _closed(path: Path) -> Path:
    if path.is_closed or len(path.points) < 3:
        return path
    return one([path, straight((path.points[-1], path.points[0]))])
