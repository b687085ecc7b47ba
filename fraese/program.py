"""Program files: look through, run, run from a line, drive round the frame."""

from collections.abc import Generator, Sequence
from functools import cached_property
from pathlib import Path

from fraese.errors import LimitError, ProgramError, StateError
from fraese.examine import Facts, examine
from fraese.gcode import canon
from fraese.gcode.text import read_lines
from fraese.jobs import STANDSTILL, Job
from fraese.controller import Controller
from fraese.log import logged
from fraese.sources import ProgramSource
from fraese.translate import Moves, Translation

#: Lines shown to people; behind that the text is cut.
_MOST_SHOWN_LINES = 200_000


class Program:
    """A program file.

    Args:
        path: that there is something to read has been seen.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.name = path.name

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
        facts = examine(self.path, controller.program_context(), plan=plan)
        for refused in facts.errors:
            raise ProgramError(refused.message, refused.line, str(self.path))
        for outside in facts.outside:
            raise LimitError(f"{self.path}, line {outside.line}: {outside.message}")
        return facts

    @logged
    def start(
        self, controller: Controller, facts: Facts | None = None, *, from_line: int = 0
    ) -> None:
        """Give it to the controller; its ``run`` works it off.

        Args:
            controller: the machine.
            facts: from ``check``, for the progress.
            from_line: begin there; what lies before is only read.

        Raises:
            StateError: if the machine is not ready, or may not run unreferenced.
        """
        context = controller.program_context()
        if not all(context.referenced) and context.config.run.unreferenced == "forbid":
            raise StateError(
                "The machine is not referenced and run.unreferenced forbids running so:"
                " reference it first; nothing has moved."
            )
        controller.check_moves([])
        source = ProgramSource(self.path, context)
        translation = Translation(context, controller)
        moves = source.moves()
        if from_line > 1:
            moves = skip_to(moves, from_line, context.safe_z_mm(), source)

        def job() -> Job:
            try:
                yield from translation.blocks(moves)
                yield STANDSTILL
            finally:
                controller.offsets.replace(source.parameters())

        controller.start(
            self.name,
            job(),
            lines=facts.lines if facts else 0,
            expected_s=facts.duration_s if facts else 0.0,
        )


def open_program(path: Path) -> Program:
    """A program that can be read.

    Raises:
        ProgramError: if there is nothing to read.
    """
    if not path.is_file():
        raise ProgramError("there is no such file.", file=str(path))
    try:
        with path.open("rb"):
            pass
    except OSError as error:
        raise ProgramError(f"cannot be read: {error.strerror}.", file=str(path)) from error
    return Program(path)


def skip_to(moves: Moves, from_line: int, safe_z_mm: float, source: ProgramSource) -> Moves:
    """The moves from a line on, with the way there in front.

    What lies before is read for what it leaves in force; of what it commands the last word of
    each kind (path mode, spindle, coolant) is repeated. Then: up to the safe height, over to where
    the program would be, and down with its feed.

    Raises:
        ProgramError: if there is no such line.
    """
    kept: dict[type, canon.Move] = {}
    for move in moves:
        if move.line >= from_line and not isinstance(move, canon.End):
            break
        if isinstance(move, canon.End):
            raise ProgramError(
                f"there is nothing to run from line {from_line} on; the program ends in line"
                f" {move.line}.",
                from_line,
            )
        if isinstance(move, canon.Rapid | canon.Feed | canon.Arc | canon.Probe):
            kept[canon.Rapid] = move
        elif isinstance(move, canon.Spindle | canon.Coolant | canon.PathControl | canon.Tool):
            kept[type(move)] = move
    else:
        raise ProgramError(f"there is nothing to run from line {from_line} on.", from_line)
    yield from _way_to(kept, safe_z_mm, source, from_line)
    facts = yield move
    yield from _rest(moves, facts)


def _rest(moves: Moves, facts: canon.Facts | None) -> Moves:
    while True:
        try:
            move = moves.send(facts)
        except StopIteration:
            return
        facts = yield move


def _way_to(
    kept: dict[type, canon.Move], safe_z_mm: float, source: ProgramSource, line: int
) -> Generator[canon.Move, canon.Facts | None, None]:
    """From wherever the machine stands to where the program would be."""
    for kind in (canon.Tool, canon.Spindle, canon.Coolant, canon.PathControl):
        if kind in kept:
            yield kept[kind]
    last = kept.get(canon.Rapid)
    if last is None:
        return
    x_mm, y_mm, z_mm = last.to  # type: ignore[union-attr]
    here_x, here_y, _ = source.start_mm
    top_mm = max(safe_z_mm, z_mm)
    yield canon.Rapid(line, (here_x, here_y, top_mm))
    yield canon.Rapid(line, (x_mm, y_mm, top_mm))
    feed_mm_min = source.modal_state().feed_mm_min or source.default_feed_mm_min
    yield canon.Feed(line, (x_mm, y_mm, z_mm), feed_mm_min)

