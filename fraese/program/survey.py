"""Moves summed up as they pass: where they go, how far, and what they ask for.

Rule 1: what leaves the travel is a complaint, with its line; it is refused in ``guard`` alone.
Rule 2: memory does not grow with the number of moves.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from operator import sub
from typing import TYPE_CHECKING, Final

from fraese.control.softlimits import why_not, within_travel
from fraese.errors import LimitError, placed
from fraese.gcode import canon
from fraese.gcode.extents import arc_extent, course_extent
from fraese.phrases import phrase
from fraese.planner.ramps import SLOWEST_HZ
from fraese.program.box import Box
from fraese.program.complaint import Complaint
from fraese.program.context import ProgramContext
from fraese.program.sentences import behind_probe
from fraese.program.source import ProgramSource
from fraese.program.translate import Moves
from fraese.program.wants import WANTING, Wants
from fraese.workframe import Point

if TYPE_CHECKING:
    from fraese.program.outline import OutlineMaker

#: More are counted, not kept.
_MOST_WARNINGS: Final = 20
#: What has a feed of its own.
_FED: Final = (canon.Feed, canon.Arc, canon.Along)
#: Who goes further out, in travels of an axis, means no place: planning it would take for ever.
_LOST_TRAVELS: Final = 100


@dataclass
class Survey:
    """Sums up moves as they pass.

    Attributes:
        outside: where they leave the travel.
        notes: what the interpreter tells of them.
        is_lost: one goes so far out that nothing more is to be planned.
        drawing: collects the outline; None: nobody wants it.
        wants: what was asked for so far.
        moves: so many moves have passed.
    """

    context: ProgramContext
    source: ProgramSource
    length_mm: float = 0.0
    outside: list[Complaint] = field(default_factory=list)
    notes: list[Complaint] = field(default_factory=list)
    is_lost: bool = False
    drawing: "OutlineMaker | None" = None
    wants: Wants = field(default_factory=Wants)
    moves: int = 0

    def __post_init__(self) -> None:
        self._at: Point = self.context.start_mm
        self._told_of_feed = False
        # From here on no feed is too slow, along whichever axis.
        self._slow_mm_min = max(
            60 * SLOWEST_HZ / float(axis.steps_per_mm) for axis in self.context.machine.axes
        )
        self.low = [math.inf] * len(self._at)
        self.high = [-math.inf] * len(self._at)
        self.cut = Box(len(self._at))
        # Axes along which something is probed: nobody knows where the program is behind it.
        self._unknown: frozenset[int] = frozenset()

    def watch(self, moves: Moves) -> Moves:
        """Pass everything on, both ways."""
        facts: canon.Facts | None = None
        kinds = canon.MOTIONS
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            kind = type(move)
            # Numbered as for the run: a breath is no move of the program.
            if kind is not canon.Breath:
                self.moves += 1
            before = self._at
            if kind in kinds:
                self._take(self._sought(move) if isinstance(move, canon.Probe) else move)
            if isinstance(move, canon.Message) and move.kind == "note":
                self.notes.append(Complaint(*self.source.complaint(move.line, move.text)))
            if kind in WANTING:
                self.wants = self.wants.taking(move)
            facts = yield move
            if isinstance(move, canon.Probe):
                self._probed(move, before, facts)

    def guard(self, moves: Moves, file: str) -> Moves:
        """The same for a run: what a look through could not know (a probe) is refused here.

        Raises:
            LimitError: a move leaves the travel; it is not passed on.
        """
        facts: canon.Facts | None = None
        watched = self.watch(moves)
        while True:
            try:
                move = watched.send(facts)
            except StopIteration:
                return
            if self.outside:
                at = self.outside[0]
                raise LimitError(placed(at.message, at.line, file))
            facts = yield move

    def _take(self, move: canon.Move) -> None:
        axes, before = self.source.axes, self._at
        if isinstance(move, canon.Arc):
            low, high, length_mm = arc_extent(before, move, axes)
        elif isinstance(move, canon.Along):
            low, high, length_mm = course_extent(before, move.points, axes)
        else:
            low = high = move.to  # type: ignore[union-attr]
            if low == before:
                # A motion code alone on its line: canonical, but it goes nowhere.
                return
            way = axes.way(before, low)
            length_mm = 0.0 if way.is_angle else way.length
        if self.drawing is not None:
            self.drawing.take(move, self.moves)  # type: ignore[arg-type]
        self._at = move.to  # type: ignore[union-attr]
        self.length_mm += length_mm
        feed_mm_min = move.feed_mm_min if isinstance(move, _FED) else None
        if feed_mm_min is not None:
            self.cut.take(before, low, high, self._at)
            if feed_mm_min < self._slow_mm_min:
                by = tuple(map(sub, self._at, before))
                self._check_feed(move.line, feed_mm_min, by, length_mm)
        for i, before_mm in enumerate(before):
            if low[i] < self.low[i]:
                self.low[i] = low[i]
                # An axis that stands outside and is not moved harms nothing.
                if low[i] < before_mm:
                    self._check(i, before_mm, low[i], move.line)
            if high[i] > self.high[i]:
                self.high[i] = high[i]
                if high[i] > before_mm:
                    self._check(i, before_mm, high[i], move.line)

    def _sought(self, move: canon.Probe) -> canon.Probe:
        """A probe as far as the travel goes: the end switches are no probe."""
        context = self.context
        to = within_travel(context.machine, context.referenced, self._at, move.to)
        return move if to == self._at else replace(move, to=to)

    def _probed(self, move: canon.Probe, before: Point, facts: canon.Facts | None) -> None:
        """What is known behind a probe: where it stands, or nothing of the axes that it moved."""
        if facts is None:
            moved = {n for n, (a, b) in enumerate(zip(before, move.to, strict=True)) if a != b}
            if not moved <= self._unknown:
                self._unknown |= moved
                told = behind_probe(self.context.machine.names[n] for n in sorted(self._unknown))
                self.notes.append(Complaint(*self.source.complaint(move.line, told)))
        else:
            self._at = facts.position_mm

    def _check_feed(self, line: int, feed_mm_min: float, way: Sequence[float], mm: float) -> None:
        """A feed below the slowest step is driven faster than it says: the first one is told."""
        if self._told_of_feed or mm <= 0:
            return
        axes = self.context.machine.axes
        most = max(abs(by) * float(axis.steps_per_mm) for by, axis in zip(way, axes, strict=True))
        least_mm_min = 60 * SLOWEST_HZ * mm / most if most else 0.0
        if feed_mm_min < least_mm_min:
            self._told_of_feed = True
            told = phrase(
                "F{feed_mm_min:g} is slower than the slowest step, one in"
                " {slowest_hz:.2f} s: it is driven at {least_mm_min:.3g} mm/min",
                feed_mm_min=feed_mm_min,
                slowest_hz=1 / SLOWEST_HZ,
                least_mm_min=least_mm_min,
            )
            self.notes.append(Complaint(*self.source.complaint(line, told)))

    def _check(self, index: int, from_mm: float, to_mm: float, line: int) -> None:
        """A new extreme: is it still inside?"""
        context = self.context
        if index in self._unknown:
            return
        at_mm = context.start_mm[index]
        span_mm = max(self.high[index], at_mm) - min(self.low[index], at_mm)
        axis, referenced = context.machine.axes[index], context.referenced[index]
        if not axis.is_endless and span_mm > _LOST_TRAVELS * (axis.high_mm - axis.low_mm):
            self.is_lost = True
        if len(self.outside) >= _MOST_WARNINGS:
            return
        said = why_not(axis, referenced, from_mm, to_mm, span_mm, self.source.frame)
        if said:
            self.outside.append(Complaint(*self.source.complaint(line, said)))
