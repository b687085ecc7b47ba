"""Program files: look through, run, run from a line, drive round the frame."""

from collections import deque
from collections.abc import Generator, Sequence
from functools import cached_property
from pathlib import Path

from fraese.context import ProgramContext
from fraese.controller import Controller
from fraese.errors import LimitError, ProgramError, StateError
from fraese.examine import Facts, Survey, examine
from fraese.gcode import canon
from fraese.gcode.text import read_lines
from fraese.jobs import STANDSTILL, Job
from fraese.lift import Lift
from fraese.log import logged
from fraese.sources import ProgramSource, require_readable
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
        _require_reference(context)
        controller.check_moves([])
        source = ProgramSource(self.path, context)
        translation = Translation(context, controller)
        moves = source.moves()
        if from_line > 1:
            moves = skip_to(moves, from_line, safe_z(context), source)
        ledger = _Ledger(controller, source, translation)

        def job() -> Job:
            try:
                guarded = Survey(context).guard(ledger.watch(moves), str(self.path))
                yield from translation.blocks(guarded)
                yield STANDSTILL
                ledger.close()
            finally:
                controller.whereabouts.offsets.replace(ledger.in_force())

        controller.start(
            self.name,
            job(),
            lines=facts.lines if facts else 0,
            expected_s=facts.duration_s if facts else 0.0,
            detour=Lift(controller.whereabouts, retract_mm)
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
        _require_reference(controller.program_context())
        facts = self.check(controller, plan=False)
        if facts.low_mm is None or facts.high_mm is None:
            raise ProgramError("nothing moves in this program.", file=str(self.path))
        context = controller.program_context()
        here = context.machine.to_mm(context.start_steps)
        z_mm = max(safe_z(context), facts.high_mm[2]) if context.referenced[2] else here[2]
        (x0, y0, _), (x1, y1, _) = facts.low_mm, facts.high_mm
        corners = [(here[0], here[1]), (x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        controller.drive_points(f"frame {self.name}", [(x, y, z_mm) for x, y in corners])

    def way_from(self, controller: Controller, from_line: int) -> list[str]:
        """What a start at a line would do, in words; nothing moves.

        Raises:
            ProgramError: if there is nothing to run there, or a line before it is refused.
        """
        context = controller.program_context()
        source = ProgramSource(self.path, context)
        said = [f"{self.name} from line {from_line}:"]
        for move in skip_to(source.moves(), from_line, safe_z(context), source):
            said.append("  " + _in_words(move))
            if isinstance(move, canon.Feed) or move.line > from_line:
                break
        state = source.modal_state()
        said.append(
            f"  then the program, with feed {state.feed_mm_min:g} mm/min, tool {state.tool},"
            f" plane G{state.plane}, work offset {state.work_offset}"
        )
        return said


class _Ledger:
    """Which offsets hold where: what was read ahead but not reached does not count.

    Args:
        controller: knows how many blocks were played.
        source: where the offsets come from.
        translation: what lies between.
    """

    def __init__(
        self, controller: Controller, source: ProgramSource, translation: Translation
    ) -> None:
        self._controller = controller
        self._source = source
        self._planner = translation.planner
        # Blocks before a change, and the parameters from there on.
        self._entries = deque([(0, dict(controller.whereabouts.offsets.parameters))])

    def watch(self, moves: Moves) -> Moves:
        """Pass everything on, both ways; note changes."""
        facts: canon.Facts | None = None
        changes = self._source.changes
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                return
            if self._source.changes != changes:
                changes = self._source.changes
                self._note(self._controller.blocks_pushed() + self._planner.pending)
            facts = yield move

    def _note(self, blocks: int) -> None:
        self._forget_passed()
        self._entries.append((blocks, self._source.parameters()))

    def _forget_passed(self) -> None:
        finished = self._controller.blocks_finished()
        while len(self._entries) > 1 and self._entries[1][0] <= finished:
            self._entries.popleft()

    def close(self) -> None:
        """The program was played to its end."""
        self._entries = deque([(0, self._source.parameters())])

    def in_force(self) -> dict[int, float]:
        """The parameters where the machine stands."""
        self._forget_passed()
        return self._entries[0][1]


def _in_words(move: canon.Move) -> str:
    if isinstance(move, canon.Rapid | canon.Feed):
        where = " ".join(f"{name}{value:.3f}" for name, value in zip("XYZ", move.to, strict=True))
        how = f"feed {move.feed_mm_min:g} mm/min" if isinstance(move, canon.Feed) else "rapid"
        return f"{how} to {where} (machine)"
    if isinstance(move, canon.Spindle):
        return f"spindle {'on' if move.direction else 'off'}, {move.rev_min:g} rev/min"
    if isinstance(move, canon.Coolant):
        return f"coolant {'on' if move.mist or move.flood else 'off'}"
    if isinstance(move, canon.Tool):
        return f"tool {move.number}"
    return type(move).__name__.lower()


def _require_reference(context: ProgramContext) -> None:
    if not all(context.referenced) and context.config.run.unreferenced == "forbid":
        raise StateError(
            "The machine is not referenced and run.unreferenced forbids running so:"
            " reference it first; nothing has moved."
        )


def safe_z(context: ProgramContext) -> float:
    """Height for the way to a line: the top, or where it stands if nobody knows the top."""
    if context.referenced[2] or context.config.run.safe_z_mm is not None:
        return context.safe_z_mm()
    return context.machine.to_mm(context.start_steps)[2]


def open_program(path: Path) -> Program:
    """A program that can be read.

    Raises:
        ProgramError: if there is nothing to read.
    """
    require_readable(path)
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
