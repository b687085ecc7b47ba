"""Program files: look through, run, run from a line, drive round the frame."""

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Final

from fraese.control.controller import Controller
from fraese.control.jobs import STANDSTILL, Job
from fraese.control.retract import Retract
from fraese.control.state import WorkFacts
from fraese.errors import LimitError, ProgramError, StateError
from fraese.gcode import canon
from fraese.gcode.text import read_lines
from fraese.log import logged
from fraese.machine import Millimetres
from fraese.program.check import Facts, Survey, check_apart, check_program
from fraese.program.context import ProgramContext
from fraese.program.offsethistory import OffsetHistory
from fraese.program.runfromline import Place, in_words, skip_to
from fraese.program.source import ProgramSource, require_readable
from fraese.program.translate import Translation

#: Corners of a frame, low or high, for so many axes.
_ROUND: Final[dict[int, tuple[tuple[int, ...], ...]]] = {
    0: (),
    1: ((0,), (1,), (0,)),
    2: ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0)),
}
#: Lines shown to people; behind that the text is cut.
_MOST_SHOWN_LINES = 200_000
#: Smaller files are looked through sooner than a process starts.
_LARGE_BYTES = 200_000


class Program:
    """A program file.

    Args:
        path: that there is something to read has been seen.
        apart: look a large file through in a process of its own, so that an app stays awake.
    """

    def __init__(self, path: Path, *, apart: bool = False) -> None:
        self.path = path
        self.name = path.name
        self._apart = apart
        self._facts: Facts | None = None

    @cached_property
    def lines(self) -> Sequence[str]:
        """Its text, for people.

        Raises:
            ProgramError: if it is not text.
        """
        lines = []
        for line in read_lines(self.path):
            lines.append(line)
            if len(lines) == _MOST_SHOWN_LINES:
                break
        return lines

    @logged
    def check(self, controller: Controller, *, plan: bool = True) -> Facts:
        """Look it through as this machine would run it now.

        Raises:
            ProgramError: if a line is refused.
            LimitError: if it leaves the travel.
        """
        large = self.path.stat().st_size > _LARGE_BYTES
        look = check_apart if self._apart and large else check_program
        facts = look(self.path, ProgramContext.of(controller), plan=plan)
        for refused in facts.errors:
            raise ProgramError(refused.message, refused.line, str(self.path))
        for outside in facts.outside:
            raise LimitError(f"{self.path}, line {outside.line}: {outside.message}")
        self._facts = facts
        return facts

    @logged
    def start(
        self, controller: Controller, facts: Facts | None = None, *, from_line: int = 0
    ) -> None:
        """Give it to the controller; its ``run`` works it off.

        Args:
            controller: the machine.
            facts: for the progress; None: from the last ``check``, if there was one.
            from_line: begin there; what lies before is only read.

        Raises:
            StateError: if the machine is not ready, or may not run unreferenced.
        """
        facts = facts or self._facts
        context = ProgramContext.of(controller)
        _require_reference(context)
        controller.check_moves([])
        source = ProgramSource(self.path, context)
        translation = Translation(context, controller)
        moves = source.moves()
        if from_line > 1:
            moves = skip_to(moves, Place(from_line), context, source, translation.numbers)
        history = OffsetHistory(controller, source, translation)

        def job() -> Job:
            controller.position.offsets.follow(history.in_force)
            try:
                guarded = Survey(context, source).guard(history.watch(moves), str(self.path))
                yield from translation.blocks(guarded)
                yield STANDSTILL
                history.close()
            finally:
                controller.position.offsets.replace(history.in_force()[0])

        controller.start(
            self.name,
            job(),
            lines=facts.lines if facts else 0,
            expected_s=facts.duration_s if facts else 0.0,
            detour=Retract(controller.position, retract_mm)
            if (retract_mm := context.retract_mm())
            else None,
        )

    def drive_frame(self, controller: Controller) -> None:
        """Drive round the bounding box at the safe height; the controller's ``run`` does it.

        Raises:
            ProgramError: if the program is refused, or moves nothing.
            LimitError: if it leaves the travel.
            StateError: if the machine is not ready.
        """
        _require_reference(ProgramContext.of(controller))
        facts = self.check(controller, plan=False)
        if facts.low_mm is None or facts.high_mm is None:
            raise ProgramError("nothing moves in this program.", file=str(self.path))
        context = ProgramContext.of(controller)
        points = _frame_of(context, facts.low_mm, facts.high_mm)
        if not points:
            raise ProgramError("there is no frame: no axis X or Y moves.", file=str(self.path))
        controller.drive_points(f"frame {self.name}", points)

    def way_from(self, controller: Controller, from_line: int) -> list[str]:
        """What a start at a line would do, in words; nothing moves.

        Raises:
            ProgramError: if there is nothing to run there, or a line before it is refused.
        """
        context = ProgramContext.of(controller)
        source = ProgramSource(self.path, context)
        said = [f"{self.name} from line {from_line}:"]
        here = context.start_mm
        for move in skip_to(source.moves(), Place(from_line), context, source):
            unit = "mm"
            if isinstance(move, canon.Rapid | canon.Feed):
                unit = "°" if source.axes.way(here, move.to).is_angle else "mm"
                here = move.to
            said.append("  " + in_words(move, context.machine, unit))
            if isinstance(move, canon.Feed) or move.line > from_line:
                break
        modal, frame = source.modal, WorkFacts.of(source.frame, 0)
        said.append(
            f"  then the program, with feed {_feed_in_words(source)}, tool {modal.tool},"
            f" plane G{modal.plane}, work offset {frame.system}{frame.more()}"
        )
        return said


def _feed_in_words(source: ProgramSource) -> str:
    """The feed in force; where there are rotary axes, it is one of degrees for them."""
    modal = source.modal
    said = f"{modal.feed_mm_min:g} mm/min"
    return said if source.axes.only_linear else f"{said} or {modal.feed_word:g} °/min"


def _frame_of(
    context: ProgramContext, low_mm: Millimetres, high_mm: Millimetres
) -> list[Millimetres]:
    """Round the bounding box in X and Y at the safe height; all other axes stay where they are."""
    names, here = context.machine.names, context.start_mm
    height = context.safe_height()
    if height is not None and context.referenced[height.axis]:
        here = height.at_least(high_mm[height.axis]).at(here)
    flat = [names.index(letter) for letter in "xy" if letter in names]
    points = [here] if flat else []
    for corner in _ROUND[len(flat)]:
        point = list(here)
        for axis, is_high in zip(flat, corner, strict=True):
            point[axis] = (high_mm if is_high else low_mm)[axis]
        points.append(tuple(point))
    return points


def _require_reference(context: ProgramContext) -> None:
    if not all(context.referenced) and context.config.run.unreferenced == "forbid":
        raise StateError(
            "The machine is not referenced and run.unreferenced forbids running so:"
            " reference it first; nothing has moved."
        )


def open_program(path: Path, *, apart: bool = False) -> Program:
    """A program that can be read.

    Args:
        path: the file.
        apart: see ``Program``.

    Raises:
        ProgramError: if there is nothing to read.
    """
    require_readable(path)
    return Program(path, apart=apart)
