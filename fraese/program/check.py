"""A program looked through without motors: everything but the steps.

Rule 1: the same interpreter and the same planner as for the run; nothing is estimated.
Rule 2: what leaves the travel is a warning here, with its line; who wants to run the program
        refuses it.
Rule 3: memory does not grow with the length of the file.
Rule 4: a line that is refused does not hide those behind it; nothing is planned any more then.
"""

import gc
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from fraese.blocks import Block
from fraese.errors import ProgramError, placed
from fraese.machine import Millimetres
from fraese.motor.seams import Report
from fraese.program.complaint import Complaint
from fraese.program.context import ProgramContext
from fraese.program.source import ProgramSource
from fraese.program.survey import Survey
from fraese.program.taken import Taken
from fraese.program.telling import Tell, Teller
from fraese.program.timetable import Timetable
from fraese.program.timetablemaker import TimetableMaker
from fraese.program.translate import Moves, Translation
from fraese.program.wants import Wants

if TYPE_CHECKING:
    from fraese.program.outline import Outline, OutlineMaker

#: With more refused lines the rest is not worth reading.
_MOST_ERRORS: Final = 50
#: Between two garbage collections, in objects: a line leaves some, and hardly ever a circle.
_OBJECTS: Final = 20_000

__all__ = ["Complaint", "Facts", "Survey", "check_program"]


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
    with _rarely_collected():
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


@contextmanager
def _rarely_collected() -> Iterator[None]:
    """Garbage is looked for less often than usual."""
    before = gc.get_threshold()
    gc.set_threshold(_OBJECTS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)


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
