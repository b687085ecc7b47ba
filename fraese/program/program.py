"""Program files: look through, run, run from a line, drive round the frame."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Final

from fraese.control.about import About
from fraese.control.controller import Controller
from fraese.control.jobs import Job, Note
from fraese.control.retract import Retract
from fraese.errors import LimitError, ProgramError, StateError, placed
from fraese.gcode.colours import Part, parts_of
from fraese.log import logged
from fraese.phrases import joined, phrase
from fraese.program.check import Facts, Survey, check_program
from fraese.program.context import ProgramContext
from fraese.program.cutjob import noting_cuts
from fraese.program.frame import frame_of
from fraese.program.interrupted import Interrupted, JobNote, KeptMap
from fraese.program.kept import KeptPrograms
from fraese.program.looker import Looker
from fraese.program.mapped import TakenMap, heights_of, take_map
from fraese.program.offsethistory import OffsetHistory
from fraese.program.runfromline import Beginning, Place
from fraese.program.source import ProgramSource
from fraese.program.taken import Taken, take_program
from fraese.program.telling import Stage
from fraese.program.translate import Translation
from fraese.program.way import way_of

#: Behind what became of a file.
_AS_OPENED: Final = phrase(" What runs is what it held when it was opened.")


class Program:
    """A program that has been opened.

    Args:
        taken: its files, as they were then.
        apart: look it through in a process of its own, so that an app stays awake.
        kept: where a copy of what is run is kept; None: none is.
        drawn: its outline is wanted.

    Attributes:
        path: where it was.
        name: for people.
        facts: what the last look-through found, also of a program that was refused.
        stage: how far one is that goes on; None: none does.
        told: is told so, too, in the thread that looks.
        heights: map to which its moves are bent; None: they are not.
    """

    def __init__(
        self,
        taken: Taken,
        *,
        apart: bool = False,
        kept: KeptPrograms | None = None,
        drawn: bool = True,
    ) -> None:
        self.path = taken.path
        self.name = taken.path.name
        self.taken = taken
        self._kept = kept
        self._drawn = drawn
        self._looker = Looker(taken) if apart else None
        # What was found, and how the machine stood then.
        self._looked: tuple[ProgramContext, Facts] | None = None
        self.facts: Facts | None = None
        self.stage: Stage | None = None
        self.told: Callable[[Stage], object] = lambda stage: None
        self.heights: TakenMap | None = None

    @property
    def map_words(self) -> str:
        """The height map that it is bent to, for people; empty: none."""
        return "" if self.heights is None else self.heights.in_short()

    def bend_to(self, path: Path | None) -> None:
        """Take another height map, or none; from any thread, while it is not looked through.

        Raises:
            ProgramError: it cannot be read; the one of before stays.
        """
        self.heights = None if path is None else take_map(path)

    @property
    def content_hash(self) -> str:
        """SHA-256 of what the file held, in hexadecimal."""
        return self.taken.main.content_hash

    @cached_property
    def lines(self) -> Sequence[str]:
        """Its text, for people; read where it is looked at.

        Raises:
            ProgramError: if it is not text.
        """
        from fraese.program.lineindex import LineIndex

        return LineIndex(self.taken.main)

    @cached_property
    def _is_gcode(self) -> bool:
        return self.taken.kind == "gcode"

    def parts(self, line: str) -> list[tuple[str, str]]:
        """A line in parts: of which kind each is, see ``gcode.colours``, and its text."""
        if not self._is_gcode:
            return [(Part.PLAIN.value, line)]
        return [(part.value, text) for part, text in parts_of(line)]

    def news(self) -> str:
        """What became of its files since they were opened, sentences; empty: nothing."""
        heights = "" if self.heights is None else self.heights.news()
        return joined(" ", filter(None, (self.taken.news(), heights)))

    def question(self, controller: Controller) -> ProgramContext | None:
        """What ``look`` has to be asked; None: it was looked through as the machine stands now."""
        context = self.stands(controller)
        if self._looker is not None:
            self._looker.begin()
        is_known = self._looked is not None and self._looked[0] == context
        return None if is_known else context

    @logged
    def look(self, context: ProgramContext, *, plan: bool = True) -> Facts:
        """Look it through as this machine would run it; from any thread.

        Raises:
            ProgramError: if a line is refused.
            LimitError: if it leaves the travel.
            Cancelled: if it was given up.
        """
        self._looked = None
        self.stage = Stage(0)
        try:
            if self._looker is None:
                facts = check_program(
                    self.taken, context, plan=plan, draw=self._drawn, tell=self._is_at
                )
            else:
                facts = self._looker.look(context, plan=plan, tell=self._is_at)
        finally:
            self.stage = None
        self.facts = facts
        for refused in facts.errors:
            raise ProgramError(refused.message, refused.line, str(self.path))
        for outside in facts.outside:
            raise LimitError(placed(outside.message, outside.line, str(self.path)))
        self._looked = context, facts
        return facts

    def _is_at(self, stage: Stage) -> None:
        """How far the look-through is; an outline stays until there is a newer one."""
        if stage.outline is None and self.stage is not None:
            stage = replace(stage, outline=self.stage.outline)
        self.stage = stage
        self.told(stage)

    def check(self, controller: Controller, *, plan: bool = True) -> Facts:
        """Look it through as this machine would run it now.

        Raises:
            ProgramError: if a line is refused.
            LimitError: if it leaves the travel.
        """
        return self.look(self.question(controller) or self.stands(controller), plan=plan)

    def give_up(self) -> None:
        """End a look-through in a process of its own, at once; from any thread."""
        if self._looker is not None:
            self._looker.give_up()

    def close(self) -> None:
        """Nobody will look it through any more."""
        if self._looker is not None:
            self._looker.close()

    @logged
    def start(
        self,
        controller: Controller,
        facts: Facts | None = None,
        *,
        from_line: int = 0,
        past: Interrupted | None = None,
        back: int = 0,
        lines: int = 0,
    ) -> None:
        """Give it to the controller; its ``run`` works it off.

        Args:
            controller: the machine.
            facts: for the progress; None: from the last ``check``, if there was one.
            from_line: begin there; what lies before is only read.
            past: go on with this instead.
            back: begin so many moves before the one at which that was left.
            lines: how many it has, where there are no facts.

        Raises:
            StateError: if the machine is not ready, may not run unreferenced, or is not the one on
                which it was interrupted any more.
        """
        if facts is None and self._looked is not None:
            facts = self._looked[1]
        context = self.stands(controller)
        require_reference(context)
        controller.check_moves([])
        begun = self.begun(context, from_line, past=past, back=back)
        source, translation = begun.source, Translation(context, controller)
        moves = begun.moves(translation.numbers)
        translation.answers |= begun.answers
        history = OffsetHistory(controller, source, translation)
        told = self.news()
        # Who goes on with it has read that before.
        news = told if past is None else ""

        def job() -> Job:
            controller.position.offsets.follow(history.in_force, history.put)
            translation.planner.tell = controller.aims.begin()
            try:
                guarded = Survey(context, source).guard(history.watch(moves), str(self.path))
                yield from noting_cuts(controller, translation.blocks(guarded))
                history.close()
            finally:
                controller.position.offsets.replace(history.in_force()[0])
            self._own_up(controller, told)

        unkept, retract_mm = self._keep(), context.retract_mm()
        controller.start(
            self.name,
            job(),
            About(
                lines=facts.lines if facts else lines,
                expected_s=facts.duration_s if facts else 0.0,
                plan=facts.timetable if facts else None,
                height_map="" if self.heights is None else self.heights.name,
                detour=Retract(controller.position, retract_mm) if retract_mm else None,
                note=self._note(begun, translation),
            ),
        )
        if said := [text for text in (news and news + _AS_OPENED, unkept) if text]:
            controller.say(joined(" ", said))

    def _note(self, begun: Beginning, translation: Translation) -> Note:
        """Says what must be known to go on with it."""
        heights = KeptMap.of(self.heights)
        return JobNote(self.name, self.content_hash, begun.found, translation, heights).at

    def _keep(self) -> str:
        """Keep a copy for later; why not, a sentence."""
        try:
            if self._kept is not None:
                self._kept.keep(self.taken, None if self.heights is None else self.heights.content)
        except ProgramError as error:
            return str(error)
        return ""

    def _own_up(self, controller: Controller, told: str) -> None:
        """The file became another one while the program ran."""
        news = self.news()
        if news and news != told:
            controller.say(news + _AS_OPENED)

    def drive_frame(self, controller: Controller) -> None:
        """Drive round what is cut, at the safe height; the controller's ``run`` does it.

        Of a program that cuts nothing it is the box of all its moves.

        Raises:
            ProgramError: if the program is refused, or moves nothing.
            LimitError: if it leaves the travel.
            StateError: if the machine is not ready.
        """
        context = self.stands(controller)
        require_reference(context)
        known = self.question(controller) is None and self._looked is not None
        facts = self._looked[1] if known and self._looked else self.check(controller, plan=False)
        if facts.low_mm is None or facts.high_mm is None:
            raise ProgramError(phrase("nothing moves in this program."), file=str(self.path))
        low_mm, high_mm = facts.cut_low_mm or facts.low_mm, facts.cut_high_mm or facts.high_mm
        points = frame_of(context, low_mm, high_mm)
        if not points:
            raise ProgramError(
                phrase("there is no frame: no axis X or Y moves."), file=str(self.path)
            )
        controller.drive_points(phrase("frame {name}", name=self.name), points)

    def begun(
        self,
        now: ProgramContext,
        from_line: int = 0,
        *,
        past: Interrupted | None = None,
        back: int = 0,
    ) -> Beginning:
        """A reading of it that begins where it is to begin. As for ``start``.

        Raises:
            StateError: if it is not the machine on which it was interrupted.
        """
        if past is None and from_line <= 1:
            return Beginning(ProgramSource(self.taken, now), now, now, None)
        if past is None:
            place, past = Place(from_line), self._run_before(now)
            if past is None:
                return Beginning(ProgramSource(self.taken, now), now, now, place)
        else:
            past.require_same_machine(now)
            place = Place(past.line, max(1, past.move - back))
        found = past.context(now)
        return Beginning(ProgramSource(self.taken, found), found, now, place, past.facts())

    def _run_before(self, now: ProgramContext) -> Interrupted | None:
        """The run of this program that was cut short, where its places are still those of now."""
        try:
            past = Interrupted.of(now.left)
            past.require_same_machine(now)
        except (StateError, ProgramError):
            return None
        is_same = past.content_hash == self.content_hash
        return past if is_same and past.height_map == KeptMap.of(self.heights) else None

    def way_from(self, controller: Controller, from_line: int) -> list[str]:
        """What a start in the middle would do; as ``way_lines``."""
        return self.way_lines(self.stands(controller), from_line)

    def stands(self, controller: Controller) -> ProgramContext:
        """The machine as it stands, for ``way_lines``; in the machine's thread."""
        return ProgramContext.of(controller, heights_of(self.heights))

    def way_lines(
        self,
        context: ProgramContext,
        from_line: int,
        given_up: Callable[[], bool] = lambda: False,
    ) -> list[str]:
        """What a start in the middle would do, in words; from any thread, may take long.

        Raises:
            ProgramError: if there is nothing to run there, or a line before it is refused.
            Cancelled: if it was given up.
        """
        return way_of(self.begun(context, from_line), given_up).lines(self.name)


def require_reference(context: ProgramContext) -> None:
    """See that a program may run as the machine is referenced.

    Raises:
        StateError: it may not.
    """
    if not all(context.referenced) and context.config.run.unreferenced == "forbid":
        raise StateError(
            phrase(
                "The machine is not referenced and run.unreferenced forbids running so:"
                " reference it first; nothing has moved."
            )
        )


def open_program(
    path: Path,
    *,
    apart: bool = False,
    kept: KeptPrograms | None = None,
    drawn: bool = True,
) -> Program:
    """A program that can be read.

    Args:
        path: the file.
        apart: see ``Program``.
        kept: likewise.
        drawn: likewise.

    Raises:
        ProgramError: if there is nothing to read.
    """
    return Program(take_program(path), apart=apart, kept=kept, drawn=drawn)
