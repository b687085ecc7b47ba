"""A program looked through without motors: everything but the steps.

Rule 1: the same interpreter and the same planner as for the run; nothing is estimated.
Rule 2: what leaves the travel is a warning here, with its line; who wants to run the program
        refuses it.
Rule 3: memory does not grow with the length of the file.
"""

import math
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field
from operator import sub
from typing import Final

from fraese.blocks import Block
from fraese.control.softlimits import why_not
from fraese.errors import LimitError, ProgramError
from fraese.gcode import canon
from fraese.gcode.extents import arc_extent
from fraese.machine import Millimetres
from fraese.motor.seams import Report
from fraese.planner.lines import planned_s
from fraese.planner.ramps import SLOWEST_HZ
from fraese.program.context import ProgramContext
from fraese.program.source import ProgramSource
from fraese.program.taken import Taken
from fraese.program.translate import Moves, Translation
from fraese.workframe import Point

#: More are counted, not kept.
_MOST_WARNINGS: Final = 20
#: Who goes further out, in travels of an axis, means no place: planning it would take for ever.
_LOST_TRAVELS: Final = 100


@dataclass(frozen=True, slots=True)
class Complaint:
    """Something wrong, and the line; 0 where no line applies."""

    line: int
    message: str


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of a program before it runs.

    Attributes:
        errors: why it is refused; empty: it can run.
        outside: where it leaves the travel.
        low_mm: corners of the bounding box of all moves, machine coordinates; None: no moves.
        high_mm: likewise.
        duration_s: planned time, pauses and operators left out; 0 if it was not planned.
        length_mm: way of the tool.
        lines: lines read.
        blocks: blocks planned; 0 if it was not planned.
        notes: what is passed over in it.
    """

    errors: tuple[Complaint, ...]
    outside: tuple[Complaint, ...]
    low_mm: Millimetres | None
    high_mm: Millimetres | None
    duration_s: float
    length_mm: float
    lines: int
    blocks: int
    notes: tuple[Complaint, ...] = ()

    @classmethod
    def refused(cls, message: str) -> "Facts":
        """Of a program of which no line can be told."""
        return cls((Complaint(0, message),), (), None, None, 0.0, 0.0, 0, 0)

    @property
    def ok(self) -> bool:
        """It can be run as far as the language goes."""
        return not self.errors

    @property
    def warnings(self) -> tuple[str, ...]:
        """What leaves the travel, in sentences."""
        return tuple(f"line {item.line}: {item.message}" for item in self.outside)


@dataclass
class Survey:
    """Sums up moves as they pass.

    Attributes:
        outside: where they leave the travel.
        notes: what the interpreter tells of them.
        is_lost: one goes so far out that nothing more is to be planned.
    """

    context: ProgramContext
    source: ProgramSource
    length_mm: float = 0.0
    outside: list[Complaint] = field(default_factory=list)
    notes: list[Complaint] = field(default_factory=list)
    is_lost: bool = False

    def __post_init__(self) -> None:
        self._at: Point = self.context.start_mm
        self._told_of_feed = False
        # From here on no feed is too slow, along whichever axis.
        self._slow_mm_min = max(
            60 * SLOWEST_HZ / float(axis.steps_per_mm) for axis in self.context.machine.axes
        )
        self.low = [math.inf] * len(self._at)
        self.high = [-math.inf] * len(self._at)

    def watch(self, moves: Moves) -> Moves:
        """Pass everything on, both ways."""
        facts: canon.Facts | None = None
        kinds = canon.MOTIONS
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            if type(move) in kinds:
                self._take(move)
            elif isinstance(move, canon.Message) and move.kind == "note":
                self.notes.append(Complaint(*self.source.complaint(move.line, move.text)))
            facts = yield move

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
                raise LimitError(f"{file}, line {at.line}: {at.message}")
            facts = yield move

    def _take(self, move: canon.Move) -> None:
        axes, before = self.source.axes, self._at
        if isinstance(move, canon.Arc):
            low, high, length_mm = arc_extent(before, move, axes)
        else:
            low = high = move.to  # type: ignore[union-attr]
            if low == before:
                # A motion code alone on its line: canonical, but it goes nowhere.
                return
            way = axes.way(before, low)
            length_mm = 0.0 if way.is_angle else way.length
        self._at = move.to  # type: ignore[union-attr]
        self.length_mm += length_mm
        if isinstance(move, canon.Feed | canon.Arc):
            self._check_feed(move, tuple(map(sub, move.to, before)), length_mm)
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

    def _check_feed(self, move: canon.Feed | canon.Arc, way: Sequence[float], mm: float) -> None:
        """A feed below the slowest step is driven faster than it says: the first one is told."""
        if move.feed_mm_min >= self._slow_mm_min or self._told_of_feed or mm <= 0:
            return
        axes = self.context.machine.axes
        most = max(abs(by) * float(axis.steps_per_mm) for by, axis in zip(way, axes, strict=True))
        least_mm_min = 60 * SLOWEST_HZ * mm / most if most else 0.0
        if move.feed_mm_min < least_mm_min:
            self._told_of_feed = True
            told = (
                f"F{move.feed_mm_min:g} is slower than the slowest step, one in"
                f" {1 / SLOWEST_HZ:.2f} s: it is driven at {least_mm_min:.3g} mm/min"
            )
            self.notes.append(Complaint(*self.source.complaint(move.line, told)))

    def _check(self, index: int, from_mm: float, to_mm: float, line: int) -> None:
        """A new extreme: is it still inside?"""
        context = self.context
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


def check_program(taken: Taken, context: ProgramContext, *, plan: bool = True) -> Facts:
    """Look a program through.

    Args:
        taken: its files.
        context: the machine as the program finds it.
        plan: plan the motion too, up to where it is lost; else duration and blocks stay 0.
    """
    source = ProgramSource(taken, context)
    survey = Survey(context, source)
    errors: list[Complaint] = []
    duration_s, blocks = 0.0, 0
    try:
        moves = survey.watch(source.moves())
        if plan:
            for block in _planned(Translation(context, None), moves):
                if survey.is_lost:
                    break
                duration_s += planned_s(block)
                blocks += 1
        for _ in moves:
            pass
    except ProgramError as error:
        errors.append(Complaint(*error.in_program(taken.main.file)))
    moved = survey.low[0] <= survey.high[0]
    return Facts(
        errors=tuple(errors),
        outside=tuple(survey.outside),
        low_mm=tuple(survey.low) if moved else None,
        high_mm=tuple(survey.high) if moved else None,
        duration_s=duration_s,
        length_mm=survey.length_mm,
        lines=source.lines_read,
        blocks=blocks,
        notes=tuple(survey.notes),
    )


def _planned(translation: Translation, moves: Moves) -> Iterator[Block]:
    """The blocks of a job that waits for nothing."""
    job: Generator[object, Report | None, None] = translation.blocks(moves)  # type: ignore[assignment]
    for demand in job:
        if isinstance(demand, Block):
            yield demand
