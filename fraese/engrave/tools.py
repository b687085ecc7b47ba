"""What strokes become with a cutter, and with a laser.

Rule 1: a cutter goes sideways by rapid at the safe height only, and down by the plunge feed only.
Rule 2: a laser burns along strokes only: it has power 0 on every other way, its approach included.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Protocol

from fraese.engrave.job import Job, Tabs
from fraese.engrave.moves import FEED, RAPID, Move, follow
from fraese.engrave.shapes import Path, straight
from fraese.engrave.strokes import Row, Run, Stroke

#: Parts of a row that follow each other so closely are one, mm.
_TOGETHER_MM: Final = 1e-6
#: A gap of a row is passed by rapid if it is longer than this, mm.
_LONG_GAP_MM: Final = 5.0
#: A laser burns while it moves only: a dot is a line of this length, mm.
_DOT_MM: Final = 0.1


class Tool(Protocol):
    """Something that cuts."""

    def begin(self) -> Iterator[Move]:
        """Before the first stroke."""

    def cut(self, stroke: Stroke, job: Job) -> Iterator[Move]:
        """One stroke, from wherever the tool is."""

    def end(self) -> Iterator[Move]:
        """Behind the last one."""


@dataclass(frozen=True, kw_only=True)
class Cutter:
    """A cutter, a graver, a pen.

    Attributes:
        depth_mm: below the surface.
        pass_mm: no deeper at a time.
        safe_mm: above the surface.
        feed_mm_min: along strokes.
        plunge_mm_min: down.
        spindle_rev_min: 0: there is none.
    """

    depth_mm: float = 0.5
    pass_mm: float = math.inf
    safe_mm: float = 2.0
    feed_mm_min: float = 300.0
    plunge_mm_min: float = 100.0
    spindle_rev_min: float = 10_000.0

    @property
    def depths_mm(self) -> list[float]:
        """Of each pass, the same further each time."""
        # A pass of a hair is none.
        count = max(1, math.ceil(self.depth_mm / self.pass_mm - 1e-9))
        return [self.depth_mm * (number + 1) / count for number in range(count)]

    def begin(self) -> Iterator[Move]:
        """Up, where nothing is in the way."""
        yield Move(RAPID, z=self.safe_mm)

    def end(self) -> Iterator[Move]:
        """Each stroke ends at the safe height."""
        return iter(())

    def cut(self, stroke: Stroke, job: Job) -> Iterator[Move]:
        """See ``Tool``."""
        if isinstance(stroke, Path):
            yield from self._path(stroke, job)
        elif stroke.pitch_mm:
            for at in _dots(stroke):
                yield from self._path(straight([at]), job)
        else:
            for runs in _stretches(stroke, _TOGETHER_MM):
                yield from self._runs(stroke, runs)

    def _path(self, path: Path, job: Job) -> Iterator[Move]:
        yield self._over(*path.points[0].tolist())
        for number, depth_mm in enumerate(self.depths_mm):
            yield self._down(-depth_mm)
            back = number % 2 == 1 and not path.is_closed
            top_mm = self.depth_mm - job.tabs.height_mm
            tabs = job.tabs if depth_mm > top_mm + 1e-9 else None
            for part, is_tab in parts(path.reversed() if back else path, tabs):
                if is_tab:
                    yield self._down(-max(0.0, top_mm))
                yield from follow(part, self.feed_mm_min, None, job.tolerance_mm, cuts=True)
                if is_tab:
                    yield self._down(-depth_mm)
        yield Move(RAPID, z=self.safe_mm)

    def _runs(self, row: Row, runs: list[Run]) -> Iterator[Move]:
        """Parts of a row that follow each other, each as deep as it is strong."""
        yield self._over(*row.at(runs[0].begin_mm))
        for number, depth_mm in enumerate(self.depths_mm):
            back = number % 2 == 1
            for run in reversed(runs) if back else runs:
                yield self._down(-min(depth_mm, self.depth_mm * run.strength))
                x, y = row.at(run.begin_mm if back else run.end_mm)
                yield Move(FEED, x, y, feed=self.feed_mm_min, cuts=True)
        yield Move(RAPID, z=self.safe_mm)

    def _over(self, x: float, y: float) -> Move:
        return Move(RAPID, x, y)

    def _down(self, z_mm: float) -> Move:
        return Move(FEED, z=z_mm, feed=self.plunge_mm_min)


@dataclass(frozen=True, kw_only=True)
class Laser:
    """A laser.

    Attributes:
        power: S where it burns most,
        power_min: and where it burns least.
        feed_mm_min: along strokes.
        overscan_mm: way before and behind rows on which it gets up to its feed, dark.
        dynamic: M4: controllers that can lower the power where it is slower.
    """

    power: float
    power_min: float = 0.0
    feed_mm_min: float = 1000.0
    overscan_mm: float = 2.0
    dynamic: bool = False

    def begin(self) -> Iterator[Move]:
        """It is dark where it stands."""
        return iter(())

    def end(self) -> Iterator[Move]:
        """And goes dark behind the last stroke."""
        yield Move(RAPID, power=0.0)

    def cut(self, stroke: Stroke, job: Job) -> Iterator[Move]:
        """See ``Tool``."""
        if isinstance(stroke, Path):
            yield from self._path(stroke, job)
            return
        for runs in _stretches(stroke, max(_LONG_GAP_MM, 2 * self.overscan_mm)):
            yield from self._runs(stroke, runs)

    def _path(self, path: Path, job: Job) -> Iterator[Move]:
        yield self._dark(*path.points[0].tolist())
        if len(path.points) == 1:
            x, y = path.points[0].tolist()
            yield Move(FEED, x + _DOT_MM, y, power=self.power, feed=self.feed_mm_min, cuts=True)
            return
        for part, is_tab in parts(path, job.tabs):
            power = 0.0 if is_tab else self.power
            yield from follow(part, self.feed_mm_min, power, job.tolerance_mm, cuts=not is_tab)

    def _runs(self, row: Row, runs: list[Run]) -> Iterator[Move]:
        at_mm = runs[0].begin_mm - self.overscan_mm
        yield self._dark(*row.at(at_mm))
        for run in runs:
            if run.begin_mm > at_mm + _TOGETHER_MM:
                yield self._along(row, run.begin_mm, 0.0)
            span = self.power - self.power_min
            yield self._along(row, run.end_mm, self.power_min + span * run.strength)
            at_mm = run.end_mm
        if self.overscan_mm:
            yield self._along(row, at_mm + self.overscan_mm, 0.0)

    def _dark(self, x: float, y: float) -> Move:
        return Move(RAPID, x, y, power=0.0)

    def _along(self, row: Row, way_mm: float, power: float) -> Move:
        x, y = row.at(way_mm)
        return Move(FEED, x, y, power=power, feed=self.feed_mm_min, cuts=power > 0)


def _dots(row: Row) -> Iterator[tuple[float, float]]:
    """The middles of the dots of a row."""
    for run in row.runs:
        count = max(1, round((run.end_mm - run.begin_mm) / row.pitch_mm))
        for number in range(count):
            yield row.at(run.begin_mm + (number + 0.5) * row.pitch_mm)


def _stretches(row: Row, gap_mm: float) -> Iterator[list[Run]]:
    """Runs of a row in parts that are further apart than this."""
    part: list[Run] = []
    for run in row.runs:
        if part and run.begin_mm - part[-1].end_mm > gap_mm:
            yield part
            part = []
        part.append(run)
    if part:
        yield part


def has_room(path: Path, tabs: Tabs) -> bool:
    """Whether there is more between the tabs than there is of them."""
    return path.length_mm > 2 * tabs.number * tabs.width_mm


def parts(path: Path, tabs: Tabs | None) -> Iterator[tuple[Path, bool]]:
    """A path, cut up where tabs are, and whether a part is one."""
    if tabs is None or not tabs.number or not path.is_closed or not has_room(path, tabs):
        yield path, False
        return
    length = path.length_mm
    at_mm = 0.0
    for number in range(tabs.number):
        middle = (number + 0.5) * length / tabs.number
        begin_mm, end_mm = middle - tabs.width_mm / 2, middle + tabs.width_mm / 2
        yield path.part(at_mm, begin_mm), False
        yield path.part(begin_mm, end_mm), True
        at_mm = end_mm
    yield path.part(at_mm, length), False
