"""A program whose lines come as somebody sends them: no file, no end, nothing looked through.

    lines --> interpreter --------------> moves --> blocks    one interpreter for all that comes
                '-- none yet: Breath --> TURN                 one job from the first line to a rest

Rule 1: what is in force outlives a rest: modes, parameters and cycles are those of the interpreter,
        and a rest is only where it finds no line. Where the machine stands and which offsets are in
        force it is told anew when it goes on: somebody may have changed both.
Rule 2: look-ahead holds back what later lines may still change for as long as motion lies ready
        (``Controller.spare_s``); only what would be made too late otherwise is let go, and ends at
        rest.
Rule 3: a line that leaves the travel ends the job, as in a program that was not looked through.
"""

from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from pathlib import Path
from typing import Final, Protocol, cast

from fraese.control.about import About
from fraese.control.controller import Controller
from fraese.control.jobs import TURN, Demand, Job
from fraese.control.retract import Retract
from fraese.control.state import Status
from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.gcode.modal import Modal
from fraese.gcode.source import NOT_YET
from fraese.motor.seams import Report
from fraese.program.check import Survey
from fraese.program.context import ProgramContext
from fraese.program.cutjob import noting_cuts
from fraese.program.offsethistory import OffsetHistory
from fraese.program.program import require_reference
from fraese.program.source import ProgramSource
from fraese.program.taken import Taken
from fraese.program.translate import Moves, Translation
from fraese.program.typed import content_of

__all__ = ["NOT_YET", "Lines", "Stream"]

#: With less motion than this in hand, what is held back is let go: three rounds of the run loop.
_SPARE_S: Final = 0.06
#: In messages; its ending says that it is G-code.
_PLACE: Final = Path("sent.ngc")


class Lines(Protocol):
    """Where lines come from; all of it is called in the machine's thread."""

    def next(self) -> str:
        """The next line, or ``NOT_YET``; what was given before has been carried out, or planned."""

    def refused(self, error: ProgramError) -> None:
        """The line in hand is refused; nothing of what is wrong in it is carried out."""

    def leads_to(self, move: canon.Move) -> None:
        """The line in hand leads to this move, which comes next."""

    def saw(self, move: canon.Move, facts: canon.Facts | None) -> None:
        """The planner has taken this move, and it was answered so."""

    def ended(self) -> None:
        """The line in hand ends the program (M2, M30): what comes next begins another one."""

    def is_dry(self) -> bool:
        """There really was no line; else it is the run loop's turn."""

    def is_over(self) -> bool:
        """No more come for now: the job may end, if all was made."""


class Stream:
    """One sender's program.

    Args:
        controller: the machine.
        lines: what is sent.
        name: of the job, for people.
    """

    def __init__(self, controller: Controller, lines: Lines, name: str) -> None:
        self._controller = controller
        self._lines = lines
        self._name = name
        self._source: _SentSource | None = None
        self._translation: Translation | None = None

    # --- facts, from any thread ------------------------------------------------------------------

    @property
    def modal(self) -> Modal:
        """What is in force behind the last line read; replaced or changed by the next."""
        source = self._source
        return _fresh() if source is None else source.modal

    @property
    def system(self) -> int:
        """Number of the work offset in force there, 1 is G54."""
        source, runs = self._source, self._controller.status is Status.RUN
        frame = source.frame if source is not None and runs else self._controller.position.frame
        return frame.system

    @property
    def pending(self) -> int:
        """Moves that are planned and not given to the motors yet."""
        translation = self._translation
        return 0 if translation is None else translation.planner.pending

    # --- in the machine's thread -----------------------------------------------------------------

    @property
    def at_rest(self) -> bool:
        """All that was sent so far has been made."""
        return not self._controller.blocks_left() and not self.pending

    def forget(self) -> None:
        """What follows begins as a program does, but in G0."""
        self._source = self._translation = None

    def start(self) -> None:
        """Carry out lines as they come, to a rest; the controller's ``run`` works it off.

        Raises:
            StateError: if the machine is not ready, or may not run unreferenced.
        """
        context = self._ready()
        source = self._source
        if source is None:
            source = self._source = _SentSource(context, self._lines, _fresh())
        source.stands(context)
        translation = Translation(context, self._controller)
        history = OffsetHistory(self._controller, source, translation)
        guarded = Survey(context, source).guard(
            history.watch(self._from(source, context)), _PLACE.name
        )

        def job() -> Job:
            offsets = self._controller.position.offsets
            offsets.follow(history.in_force, history.put)
            try:
                yield from noting_cuts(self._controller, self._paced(translation, guarded))
                history.close()
            finally:
                offsets.replace(history.in_force()[0])

        self._begin(context, translation, job())

    def look(self) -> None:
        """Read the lines there are and carry nothing out; goes on where it was left.

        Raises:
            LimitError: a move would leave the travel.
        """
        context = ProgramContext.of(self._controller)
        source = self._source
        if source is None:
            source = self._source = _SentSource(context, self._lines, _fresh())
            source.stands(context)
        for move in Survey(context, source).guard(self._from(source, context), _PLACE.name):
            if type(move) is canon.Breath:
                return

    def start_moves(self, name: str, moves: Callable[[ProgramContext], Moves]) -> None:
        """The same with moves that are no lines of a program, such as jogs.

        Args:
            name: of the job.
            moves: yields ``canon.Breath`` where there is none yet, and ends where none come.
        """
        context = self._ready()
        translation = Translation(context, self._controller)
        self._begin(context, translation, self._paced(translation, moves(context)), name)

    def _ready(self) -> ProgramContext:
        context = ProgramContext.of(self._controller)
        require_reference(context)
        self._controller.check_moves([])
        return context

    def _begin(
        self, context: ProgramContext, translation: Translation, job: Job, name: str = ""
    ) -> None:
        retract_mm = context.retract_mm()
        position = self._controller.position
        detour = Retract(position, retract_mm) if retract_mm and not name else None
        self._controller.start(name or self._name, job, About(detour=detour))
        self._translation = translation
        translation.planner.tell = self._controller.aims.begin()

    def _from(self, source: "_SentSource", context: ProgramContext) -> Moves:
        """Moves of the lines, up to a rest or the program's end."""
        yield from _in_force(source.modal, context)
        facts: canon.Facts | None = None
        running = source.running
        while True:
            try:
                move = running.send(facts)
            except StopIteration:
                self._lines.ended()
                self._source = _SentSource(context, self._lines, source.modal)
                return
            if type(move) is canon.Breath and self._lines.is_over() and self.at_rest:
                return
            self._lines.leads_to(move)
            facts = yield move
            self._lines.saw(move, facts)

    def _paced(self, translation: Translation, moves: Moves) -> Job:
        """The job of these moves; where no line comes in time, what is held back is let go."""
        planner, report = translation.planner, cast(Report, None)
        with closing(translation.blocks(moves)) as job:
            demand: Demand = next(job, TURN)
            while True:
                if demand is TURN and planner.pending and self._must_let_go():
                    for block in planner.drain():
                        yield block
                report = yield demand
                try:
                    demand = job.send(report)
                except StopIteration:
                    return

    def _must_let_go(self) -> bool:
        return self._lines.is_dry() and self._controller.spare_s() < _SPARE_S


class _SentSource(ProgramSource):
    """What is sent, as a source of moves."""

    def __init__(self, context: ProgramContext, lines: Lines, modal: Modal) -> None:
        super().__init__(Taken(_PLACE, content_of(""), {}), context)
        now = self._interpreter.modal
        for field in Modal.__slots__:
            setattr(now, field, getattr(modal, field))
        self._lines = lines
        self.running = self._interpreter.run(self._each(), self._refuse)

    def _each(self) -> Iterator[str]:
        while True:
            yield self._lines.next()

    def _refuse(self, error: ProgramError) -> bool:
        self._lines.refused(error)
        return True

    def stands(self, context: ProgramContext) -> None:
        """So the machine stands now."""
        unreferenced = context.setup(self._taken).unreferenced
        self._interpreter.stands(context.start_mm, context.parameters, unreferenced)


def _fresh() -> Modal:
    """As a grbl begins: in G0."""
    return Modal(motion=0)


def _in_force(modal: Modal, context: ProgramContext) -> Generator[canon.Move, object, None]:
    """What a planner that begins anew has to know of what was said before."""
    if (modal.path_mode, modal.tolerance_mm) != (canon.PathMode.BLEND, 0.0):
        yield canon.PathControl(0, modal.path_mode, modal.tolerance_mm)
    if not modal.overrides:
        yield canon.Overrides(0, False)
    if modal.spindle and context.has_laser:
        yield canon.Spindle(0, 1 if modal.spindle > 0 else -1, modal.rev_min, modal.has_speed)
