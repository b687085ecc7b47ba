"""The stage that bends moves to a height map: behind the interpreter, before all else.

    interpreter --flat moves--> bend --> planner, survey, outline, what is kept to go on with
                <--flat facts--      <-- where the machine really is

Rule 1: the program lives in a flat world. What it commands is lifted by the height of the surface
        where it is; what comes back (a probe, a person's visit) is lowered by it again.
Rule 2: one move stays one move, along several points: its number, line and feed are the program's.
Rule 3: rapids are bent too: they keep their distance from the work. None rises above the travel.
Rule 4: a place of the machine in Z (G53, G28, G30) is gone to as it is, and kept until the program
        moves Z again. What the height there differs by is lost evenly on the way, and won back so.
Rule 5: the map lies in the work coordinates of its system as the program finds them; what a
        person changes of them while the program waits counts from then on.
"""

import math
from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

from fraese.feedway import NO_WAY
from fraese.gcode.canon import BARRIERS, Along, Arc, Facts, Feed, Message, Move, Probe, Rapid
from fraese.heightmap.heights import Flat, HeightMap
from fraese.heightmap.pieces import knots
from fraese.phrases import phrase
from fraese.planner.arcs import ArcShape, arc_shape, planes_of
from fraese.workframe import Point, WorkFrame

Moves = Generator[Move, Facts | None, None]
Motion = Rapid | Feed | Arc

#: A piece is nowhere further from the surface between the points of the map.
TOLERANCE_MM: Final = 0.002
#: What lies so little outside the grid lies on its edge.
_EDGE_MM: Final = 0.01
#: Whoever comes back so near has come back.
_SAME_MM: Final = 0.05
#: An arc is looked at so closely to see whether it leaves the grid: a share of its radius.
_ARC_SHARE: Final = 0.02


@dataclass(frozen=True, slots=True)
class Site:
    """Where a map is to be used.

    Attributes:
        axes: letters of the machine's axes; X, Y and Z are among them.
        parameters: of the language, as the program finds them.
        start_mm: where the machine stands.
        chord_mm: how far chords may be from an arc.
        top_mm: no rapid rises above this because of the map; infinite: nobody knows the travel.
    """

    axes: str
    parameters: Mapping[int, float]
    start_mm: Point
    chord_mm: float
    top_mm: float = math.inf


class Ground:
    """The surface, under points of the machine.

    Args:
        heights: the map.
        site: where it is used.
        parameters: of the language; they say where the work lies.
    """

    def __init__(self, heights: HeightMap, site: Site, parameters: Mapping[int, float]) -> None:
        self._heights = heights
        self._frame: WorkFrame = heights.frame(parameters, site.axes)
        self._x, self._y, self._z = (site.axes.index(name) for name in "xyz")
        self._top_mm = site.top_mm

    def flat(self, point: Point) -> Flat:
        """X and Y of a point, as the map sees them."""
        work = self._frame.to_work(point)
        return work[self._x], work[self._y]

    def under(self, point: Point) -> float:
        """Height of the surface there."""
        return self._heights.at(*self.flat(point))

    def raised(self, point: Point, by_mm: float) -> Point:
        """The same point, so much higher."""
        z = self._z
        return (*point[:z], point[z] + by_mm, *point[z + 1 :])

    def below_top(self, point: Point, lift_mm: float) -> float:
        """By how much a rapid may be lifted: no higher than the travel, or than it goes anyway."""
        return min(lift_mm, max(self._top_mm - point[self._z], 0.0))

    def along(
        self, at: Point, to: Point, off_mm: tuple[float, float], *, is_rapid: bool = False
    ) -> Iterator[Point]:
        """Ends of the pieces of a straight way.

        Args:
            at: where it begins, flat.
            to: where it ends, likewise.
            off_mm: what its ends are above the surface; it is spread evenly along the way.
            is_rapid: it goes no higher than the travel.
        """
        first_mm, last_mm = off_mm
        for part, height_mm in knots(self._heights, self.flat(at), self.flat(to), TOLERANCE_MM):
            flat, over_mm = to, last_mm
            if part < 1:
                flat = tuple([a + (b - a) * part for a, b in zip(at, to, strict=True)])
                over_mm = first_mm + (last_mm - first_mm) * part
            lift_mm = height_mm + over_mm
            yield self.raised(flat, self.below_top(flat, lift_mm) if is_rapid else lift_mm)


@dataclass(frozen=True, slots=True)
class ArcWay:
    """The points of a bent arc: can be asked for again and again.

    Attributes:
        ground: below it.
        shape: of the flat arc.
        chord_mm: how far chords may be from it.
        off_mm: see ``Ground.along``.
    """

    ground: Ground
    shape: ArcShape
    chord_mm: float
    off_mm: tuple[float, float]

    def __iter__(self) -> Iterator[Point]:
        shape, (first_mm, last_mm) = self.shape, self.off_mm
        count, at, off_mm = shape.chords(self.chord_mm), shape.start_mm, self.off_mm[0]
        for number, corner in enumerate(shape.corners(self.chord_mm), start=1):
            before_mm, off_mm = off_mm, first_mm + (last_mm - first_mm) * number / count
            yield from self.ground.along(at, corner, (before_mm, off_mm))
            at = corner


class Bend:
    """The stage.

    Args:
        heights: the map.
        site: where it is used.
    """

    def __init__(self, heights: HeightMap, site: Site) -> None:
        self._heights = heights
        self._site = site
        self._across = tuple(site.axes.index(name) for name in "xy")
        self._up = (site.axes.index("z"),)
        self._planes = planes_of(site.axes)
        self._parameters = dict(site.parameters)
        self._ground = Ground(heights, site, self._parameters)
        # Where the program believes to be, and how much higher the machine is.
        self._at = site.start_mm
        self._lift_mm = 0.0
        self._is_at_place = False
        self._has_told = False

    def through(self, moves: Moves) -> Moves:
        """Pass everything on, both ways: bent down, flat up."""
        facts: Facts | None = None
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            facts = None
            if isinstance(move, Rapid | Feed | Arc):
                if not self._has_told and not isinstance(move, Rapid):
                    yield from self._told(move)
                yield self._bent(move)
            elif isinstance(move, Probe):
                facts = self._probed(move, (yield self._towards(move)))
            elif type(move) in BARRIERS:
                facts = self._visited((yield move))
            else:
                yield move

    # --- down ------------------------------------------------------------------------------------

    def _bent(self, move: Motion) -> Motion | Along:
        ground, at, to, before_mm = self._ground, self._at, move.to, self._lift_mm
        if self._keeps_height(move):
            self._at = to
            return replace(move, to=ground.raised(to, before_mm))
        self._is_at_place = not isinstance(move, Arc) and move.is_place
        if isinstance(move, Arc):
            self._at, self._lift_mm = to, ground.under(to)
            off_mm = before_mm - ground.under(at), 0.0
            way = ArcWay(ground, self._shape(move, at), self._site.chord_mm, off_mm)
            there, radius_mm = ground.raised(to, self._lift_mm), way.shape.radius_mm
            return Along(move.line, there, way, move.feed_mm_min, move.plane, radius_mm)
        height_mm = ground.under(to)
        lift_mm = 0.0 if move.is_place else height_mm
        is_rapid = isinstance(move, Rapid)
        self._at, self._lift_mm = to, ground.below_top(to, lift_mm) if is_rapid else lift_mm
        there = ground.raised(to, self._lift_mm)
        if not self._is_way(at, to, self._across):
            return replace(move, to=there)
        off_mm = before_mm - ground.under(at), lift_mm - height_mm
        points = tuple(ground.along(at, to, off_mm, is_rapid=is_rapid))
        if len(points) == 1:
            return replace(move, to=there)
        feed_mm_min = move.feed_mm_min if isinstance(move, Feed) else None
        return Along(move.line, points[-1], points, feed_mm_min)

    def _keeps_height(self, move: Motion) -> bool:
        """The tool does not move at all, or goes over at a place of the machine."""
        at, to = self._at, move.to
        if isinstance(move, Arc):
            return self._is_at_place and move.plane == 17 and not self._is_way(at, to, self._up)
        if self._is_at_place and not move.is_place:
            return not self._is_way(at, to, self._up)
        return not self._is_way(at, to, (*self._across, *self._up))

    @staticmethod
    def _is_way(at: Point, to: Point, axes: tuple[int, ...]) -> bool:
        return any(abs(at[axis] - to[axis]) > NO_WAY for axis in axes)

    def _shape(self, arc: Arc, start: Point) -> ArcShape:
        return arc_shape(start, arc.to, arc.centre, arc.plane, arc.turns, self._planes)

    def _towards(self, probe: Probe) -> Probe:
        """A probe goes straight: its end is bent, and not the way there."""
        return replace(probe, to=self._ground.raised(probe.to, self._ground.under(probe.to)))

    # --- up --------------------------------------------------------------------------------------

    def _probed(self, probe: Probe, facts: Facts | None) -> Facts | None:
        """Where a probe has ended: as the program would see it on flat work."""
        ground, self._is_at_place = self._ground, False
        if facts is None:
            self._at, self._lift_mm = probe.to, ground.under(probe.to)
            return None
        self._lift_mm = ground.under(facts.position_mm)
        self._at = ground.raised(facts.position_mm, -self._lift_mm)
        contact = facts.contact_mm
        if contact is not None:
            contact = ground.raised(contact, -ground.under(contact))
        return replace(facts, position_mm=self._at, contact_mm=contact)

    def _visited(self, facts: Facts | None) -> Facts | None:
        """A person was there, and may have moved the tool or its zero."""
        if facts is None:
            return None
        if facts.parameters:
            self._parameters |= facts.parameters
            self._ground = Ground(self._heights, self._site, self._parameters)
        there, here = facts.position_mm, self._at
        if any(abs(there[axis] - here[axis]) > _SAME_MM for axis in self._across):
            self._is_at_place = False
            self._lift_mm = self._ground.under(there)
        self._at = self._ground.raised(there, -self._lift_mm)
        return replace(facts, position_mm=self._at)

    # --- outside the grid ------------------------------------------------------------------------

    def _told(self, move: Feed | Arc) -> Iterator[Message]:
        """The first cut outside the grid is told."""
        points = [move.to]
        if isinstance(move, Arc):
            shape = self._shape(move, self._at)
            points += shape.corners(_ARC_SHARE * shape.radius_mm)
        x_mm, y_mm = max(map(self._ground.flat, points), key=self._beyond_mm)
        beyond_mm = self._beyond_mm((x_mm, y_mm))
        if beyond_mm > _EDGE_MM:
            self._has_told = True
            said = phrase(
                "X{x:.3f} Y{y:.3f} lies {beyond_mm:.1f} mm outside the height map ({reach}):"
                " there the height of its edge holds",
                x=x_mm,
                y=y_mm,
                beyond_mm=beyond_mm,
                reach=self._heights.reach(),
            )
            yield Message(move.line, said, "note")

    def _beyond_mm(self, flat: Flat) -> float:
        return self._heights.beyond_mm(*flat)
