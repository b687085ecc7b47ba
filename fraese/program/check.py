"""A program looked through without motors: everything but the steps.

Rule 1: the same interpreter and the same planner as for the run; nothing is estimated.
Rule 2: what leaves the travel is a warning here, with its line; who wants to run the program
        refuses it.
Rule 3: memory does not grow with the length of the file.
Rule 4: a line that is refused does not hide those behind it; nothing is planned any more then.
"""

import math
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field, replace
from operator import sub
from typing import TYPE_CHECKING, Final

from fraese.blocks import Block
from fraese.control.softlimits import why_not, within_travel
from fraese.errors import LimitError, ProgramError, placed
from fraese.gcode import canon
from fraese.gcode.extents import arc_extent, course_extent
from fraese.machine import Millimetres
from fraese.motor.seams import Report
from fraese.phrases import phrase
from fraese.planner.ramps import SLOWEST_HZ
from fraese.program.box import Box
from fraese.program.context import ProgramContext
from fraese.program.sentences import behind_probe
from fraese.program.source import ProgramSource
from fraese.program.taken import Taken
from fraese.program.telling import Tell, Teller
from fraese.program.timetable import Timetable, TimetableMaker
from fraese.program.translate import Moves, Translation
from fraese.program.wants import WANTING, Wants
from fraese.workframe import Point

if TYPE_CHECKING:
    from fraese.program.outline import Outline, OutlineMaker

#: More are counted, not kept.
_MOST_WARNINGS: Final = 20
#: With more refused lines the rest is not worth reading.
_MOST_ERRORS: Final = 50
#: What has a feed of its own.
_FED: Final = (canon.Feed, canon.Arc, canon.Along)
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
        cut_low_mm: corners of the box of what is cut: feeds and arcs; None: nothing is.
        cut_high_mm: likewise.
        duration_s: planned time, pauses and operators left out; 0 if it was not planned.
        length_mm: way of the tool.
        lines: lines read.
        blocks: blocks planned; 0 if it was not planned.
        notes: what is passed over in it.
        wants: what it asks for.
        outline: where the tool goes.
        timetable: when it comes to which move; None: it was not planned to its end.
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
    wants: Wants = field(default_factory=Wants)
    cut_low_mm: Millimetres | None = None
    cut_high_mm: Millimetres | None = None
    outline: "Outline | None" = field(default=None, compare=False)
    timetable: Timetable | None = field(default=None, compare=False)

    @classmethod
    def refused(cls, message: str) -> "Facts":
        """Of a program of which no line can be told."""
        return cls((Complaint(0, message),), (), None, None, 0.0, 0.0, 0, 0)

    @property
    def ok(self) -> bool:
        """It would be run: nothing is refused, and nothing leaves the travel."""
        return not (self.errors or self.outside)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What leaves the travel, in sentences."""
        return tuple(placed(item.message, item.line) for item in self.outside)


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


def check_program(
    taken: Taken,
    context: ProgramContext,
    *,
    plan: bool = True,
    draw: bool = True,
    tell: Tell | None = None,
) -> Facts:
    """Look a program through.

    Args:
        taken: its files.
        context: the machine as the program finds it.
        plan: plan the motion too, up to where it is lost; else duration and blocks stay 0.
        draw: an outline is wanted.
        tell: told how far it is.
    """
    source = ProgramSource(taken, context)
    drawing = _drawing(context) if draw else None
    survey = Survey(context, source, drawing=drawing)
    errors = _Errors(taken)
    timetable, blocks = TimetableMaker(), 0
    try:
        moves = survey.watch(source.moves(errors.take))
        if tell is not None:
            moves = Teller(survey, tell).passing(moves)
        if plan:
            for block in _planned(Translation(context, None), moves):
                if survey.is_lost or errors.found:
                    break
                timetable.take(block)
                blocks += 1
        for _ in moves:
            pass
    except ProgramError as error:
        errors.take(error)
    moved = survey.low[0] <= survey.high[0]
    whole = plan and not survey.is_lost and not errors.found
    return Facts(
        errors=tuple(errors.found),
        outside=tuple(survey.outside),
        low_mm=tuple(survey.low) if moved else None,
        high_mm=tuple(survey.high) if moved else None,
        duration_s=timetable.total_s,
        length_mm=survey.length_mm,
        lines=source.lines_read,
        blocks=blocks,
        notes=(*_moved_map(context), *survey.notes),
        wants=survey.wants,
        cut_low_mm=survey.cut.low_mm,
        cut_high_mm=survey.cut.high_mm,
        outline=drawing.outline() if drawing is not None else None,
        timetable=timetable.timetable() if whole else None,
    )


def _moved_map(context: ProgramContext) -> list[Complaint]:
    """That a height map lies elsewhere than where it was probed."""
    heights = context.heights
    names = "".join(context.machine.names)
    said = "" if heights is None else heights.moved(context.parameters, names)
    return [Complaint(0, said)] if said else []


def _drawing(context: ProgramContext) -> "OutlineMaker":
    # It takes numpy along, which a command that draws nothing does not pay for.
    from fraese.program.outline import OutlineMaker

    return OutlineMaker(context.machine.names, context.start_mm)


class _Errors:
    """Lines that were refused, each once."""

    def __init__(self, taken: Taken) -> None:
        self._file = taken.main.file
        self.found: list[Complaint] = []

    def take(self, error: ProgramError) -> bool:
        """One more; whether it is worth reading on."""
        complaint = Complaint(*error.in_program(self._file))
        if complaint not in self.found:
            self.found.append(complaint)
        return len(self.found) < _MOST_ERRORS


def _planned(translation: Translation, moves: Moves) -> Iterator[Block]:
    """The blocks of a job that waits for nothing."""
    job: Generator[object, Report | None, None] = translation.blocks(moves)  # type: ignore[assignment]
    for demand in job:
        if isinstance(demand, Block):
            yield demand
