r"""Probing a height map: the reference point first, then point by point, row by row.

    start     ------.                                    the height at which the tool stood
                     \   .--------.   .---.   .--->      clearance above the reference, or above
    clearance         |  |        |  |     | |           the last contact where that was higher
    work      ........v..'........v..'.....v.'
               reference       first     second

Rule 1: what is measured is the difference to the reference point: the tool's length and the zero of
        Z do not count. Going on with a map that is not whole begins with that point again.
Rule 2: every point is kept as soon as it is known.
Rule 3: a point where nothing is touched ends the job: a hole in the work is no height.
"""

import math
from collections.abc import Callable, Generator, Iterator
from collections.abc import Mapping as Mapping_
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from fraese import alarms
from fraese.control.about import About
from fraese.control.controller import Controller
from fraese.control.jobs import Doing, Job
from fraese.errors import ProbeError, StateError, UsageError
from fraese.gcode import canon
from fraese.heightmap.heights import Flat, origin_of
from fraese.heightmap.mapfile import PartMap
from fraese.machine import Millimetres
from fraese.phrases import phrase
from fraese.program.context import ProgramContext
from fraese.program.cutjob import noting_cuts
from fraese.program.grid import Grid
from fraese.program.mapfiles import MapFile
from fraese.program.program import require_reference
from fraese.program.translate import Moves, Translation
from fraese.workframe import WorkFrame

#: Digits behind the point of a height, mm: finer than any step.
_DIGITS: Final = 4
#: What a person is asked of a grid that begins at the work zero.
_GRID_WORDS: Final = ("x", "y", "every")
#: A row and a column.
_Place = tuple[int, int]
_Felt = Generator[canon.Move, canon.Facts | None, float]
#: Zeros that are no further apart are the same, mm.
_SAME_ZERO_MM: Final = 0.1


@dataclass(frozen=True, slots=True)
class Feeling:
    """How a point is felt for.

    Attributes:
        clearance_mm: above the reference the tool goes over at this height.
        depth_mm: below the reference it is felt for down to this.
        reach_mm: the reference is no further below where the tool stands than this.
        feed_mm_min: towards the work.
    """

    clearance_mm: float = 2.0
    depth_mm: float = 2.0
    reach_mm: float = 20.0
    feed_mm_min: float = 60.0

    def check(self) -> None:
        """See that there is something to do.

        Raises:
            UsageError: a value is out of bounds.
        """
        for name in self.__slots__:
            value = getattr(self, name)
            if not 0 < value <= _MOST:
                raise UsageError(
                    phrase(
                        "{name} {value:g}: above 0 and at most {most:g}.",
                        name=name.split("_")[0],
                        value=value,
                        most=_MOST,
                    )
                )


_MOST: Final = 1000.0


class Mapping:
    """One map that is probed.

    Args:
        controller: the machine.
        part: the map as far as it is known.
        feeling: how points are felt for.
        keep: told of it after every point.

    Attributes:
        part: the map so far.
    """

    def __init__(
        self,
        controller: Controller,
        part: PartMap,
        feeling: Feeling,
        keep: Callable[[PartMap], None],
    ) -> None:
        self.part = part
        self._controller = controller
        self._feeling = feeling
        self._keep = keep
        self._context = ProgramContext.of(controller)
        self._doing = ""

    def require_ready(self) -> None:
        """See that it can be started.

        Raises:
            UsageError: nothing is missing, or a value is out of bounds.
            LimitError: a point lies outside the travel.
            StateError: the machine is not ready, or its work zero is another than when the first
                points were probed.
        """
        self._feeling.check()
        if not self.part.missing:
            raise UsageError(phrase("This height map is whole: nothing is left to probe."))
        context, controller = self._context, self._controller
        require_reference(context)
        # On a machine without the axes this is refused.
        context.site()
        self._require_same_zero()
        corners = [
            (x, y)
            for x in (self.part.x_mm[0], self.part.x_mm[-1])
            for y in (self.part.y_mm[0], self.part.y_mm[-1])
        ]
        here_mm = self._z(context.start_mm)
        points = [self._point(flat, here_mm) for flat in (self.part.reference_mm, *corners)]
        controller.check_moves([context.machine.to_steps(point) for point in points])

    def start(self) -> None:
        """Give it to the controller; its ``run`` probes. Raises as ``require_ready``."""
        self.require_ready()
        controller, translation = self._controller, Translation(self._context, self._controller)
        job = noting_cuts(controller, self._job(translation))
        controller.start(phrase("height map"), job, About(lines=self.part.missing + 1))

    def _require_same_zero(self) -> None:
        before, now = self.part.origin_mm, origin_now(self._context, self._frame)
        if before is not None and now is not None and math.dist(before, now) > _SAME_ZERO_MM:
            raise StateError(
                phrase(
                    "The zero of X and Y has moved since the first points were probed, from"
                    " machine {before} to {now}: set it back, or probe a new map.",
                    before=_words(before),
                    now=_words(now),
                )
            )

    @property
    def _frame(self) -> WorkFrame:
        context = self._context
        return WorkFrame.of(context.parameters, "".join(context.machine.names), self.part.system)

    def _job(self, translation: Translation) -> Job:
        """The blocks, and in between what is being done."""
        blocks, report, told = translation.blocks(self._moves()), None, ""
        while True:
            try:
                demand = next(blocks) if report is None else blocks.send(report)
            except StopIteration:
                return
            except ProbeError as error:
                if error.kind is not alarms.PROBE_TOUCHES:
                    raise
                raise ProbeError(self._touches_already(), error.kind) from error
            if self._doing != told:
                told = self._doing
                yield Doing(told)
            report = yield demand

    def _touches_already(self) -> str:
        return phrase(
            "{doing}: the probe touches before it is moved down; the machine stands at {place}.",
            doing=self._doing,
            place=self._controller.position.in_words(),
        )

    # --- point by point --------------------------------------------------------------------------

    def _moves(self) -> Moves:
        feeling, part = self._feeling, self.part
        start_mm = self._z(self._context.start_mm)
        self._doing = phrase("reference point")
        zero_mm = yield from self._felt(1, part.reference_mm, start_mm, start_mm - feeling.reach_mm)
        over_mm = self._within(zero_mm + feeling.clearance_mm)
        yield self._up(1, part.reference_mm, over_mm)
        total, missing = part.points, part.missing
        for number, (row, column) in enumerate(_in_order(part), start=2):
            flat = part.x_mm[column], part.y_mm[row]
            self._doing = phrase(
                "point {number} of {total}", number=total - missing + number - 1, total=total
            )
            found_mm = yield from self._felt(number, flat, over_mm, zero_mm - feeling.depth_mm)
            self._found(row, column, found_mm - zero_mm)
            last = number > missing
            top_mm = (
                start_mm if last else self._within(max(zero_mm, found_mm) + feeling.clearance_mm)
            )
            over_mm = max(top_mm, found_mm)
            yield self._up(number, flat, over_mm)
        yield canon.End(0)

    def _felt(self, number: int, flat: Flat, over_mm: float, down_mm: float) -> _Felt:
        """Over it and down; machine Z of the contact."""
        yield canon.Rapid(number, self._point(flat, over_mm))
        towards = self._point(flat, min(down_mm, over_mm - 1e-3))
        facts = yield canon.Probe(
            number, towards, self._feeling.feed_mm_min, until_closed=True, must_touch=False
        )
        assert facts is not None
        if not facts.touched:
            raise ProbeError(
                phrase(
                    "{doing}, at work {place}: nothing was touched down to {stands}.",
                    doing=self._doing,
                    place=_words(flat),
                    stands=self._context.machine.in_words(facts.position_mm),
                )
            )
        return self._z(facts.position_mm if facts.contact_mm is None else facts.contact_mm)

    def _up(self, number: int, flat: Flat, to_mm: float) -> canon.Rapid:
        return canon.Rapid(number, self._point(flat, to_mm))

    def _found(self, row: int, column: int, height_mm: float) -> None:
        rows = [list(each) for each in self.part.heights_mm]
        rows[row][column] = round(height_mm, _DIGITS) + 0.0
        self.part = replace(self.part, heights_mm=tuple(map(tuple, rows)))
        self._keep(self.part)

    # --- places ----------------------------------------------------------------------------------

    def _point(self, flat: Flat, z_mm: float) -> Millimetres:
        """A point of the work at this height of the machine; other axes stay where they are."""
        machine, frame = self._context.machine, self._frame
        work = list(frame.to_work(self._context.start_mm))
        work[machine.index("x")], work[machine.index("y")] = flat
        point = list(frame.to_machine(tuple(work)))
        point[machine.index("z")] = z_mm
        return tuple(point)

    def _z(self, point: Millimetres) -> float:
        return point[self._context.machine.index("z")]

    def _within(self, z_mm: float) -> float:
        """No higher than the travel."""
        return min(z_mm, self._context.site().top_mm)


def origin_now(context: ProgramContext, frame: WorkFrame) -> Flat | None:
    """Machine X and Y of the work zero; None: nobody knows where the machine is."""
    names = context.machine.names
    known = all(
        is_known for name, is_known in zip(names, context.referenced, strict=True) if name in "xy"
    )
    return origin_of(frame) if known else None


def empty_map(controller: Controller, grid: Grid) -> PartMap:
    """A map in the work coordinates in force, of which nothing is probed yet.

    Raises:
        UsageError: the grid has no width, or too many points.
    """
    context, frame = ProgramContext.of(controller), controller.position.frame
    return grid.empty(frame.system, origin_now(context, frame))


def _in_order(part: PartMap) -> Iterator[_Place]:
    """Points that are missing, each row the other way round than the one before."""
    columns = range(len(part.x_mm))
    for row, heights in enumerate(part.heights_mm):
        for column in reversed(columns) if row % 2 else columns:
            if heights[column] is None:
                yield row, column


def _words(flat: Flat) -> str:
    return f"X {flat[0]:.3f} Y {flat[1]:.3f}"


def probe_map(controller: Controller, path: Path, values: Mapping_[str, float]) -> None:
    """Start to probe a map from the work zero to X and Y, into a new file.

    Args:
        controller: the machine; its ``run`` probes.
        path: of the file.
        values: "x", "y" and "every", and what else is other than usual, without the unit.

    Raises:
        UsageError: if a value is not known, missing or out of bounds, or the file is not to be
            written.
        LimitError: if a point lies outside the travel.
        StateError: if the machine is not ready.
    """
    usual = Feeling()
    names = {name.split("_")[0]: name for name in usual.__slots__}
    for name in values:
        if name not in (*_GRID_WORDS, *names):
            raise UsageError(
                phrase(
                    'Probing knows no "{name}"; it knows {names}.',
                    name=name,
                    names=", ".join(sorted([*_GRID_WORDS, *names])),
                )
            )
    grid = Grid((0.0, 0.0), (values.get("x", 0.0), values.get("y", 0.0)), values.get("every", 10.0))
    feeling = replace(usual, **{names[each]: values[each] for each in values if each in names})
    file = MapFile(path)

    def keep(part: PartMap) -> None:
        file.keep(part)
        if not part.missing:
            said = part.whole().in_words()
            controller.say(phrase("{path}: {in_words}.", path=path.name, in_words=said))

    one = Mapping(controller, empty_map(controller, grid), feeling, keep)
    one.require_ready()
    file.begin(one.part)
    one.start()
