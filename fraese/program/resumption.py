"""Going on with the program that was cut short: what is shown before, and the start.

    of(controller)      machine's thread    which program, as it was when it was started; refused
                                            where nobody knows its place any more
    way(back)           any thread          reads it as far as the place; may take long
    start(controller)   machine's thread    the same reading, with motion

Rule 1: command line and app go on in this one way.
Rule 2: nothing starts on a machine that stands otherwise than when the way was made.
"""

from collections.abc import Callable
from pathlib import Path

from fraese.control.controller import Controller
from fraese.errors import StateError
from fraese.phrases import phrase
from fraese.program.context import ProgramContext
from fraese.program.interrupted import Interrupted
from fraese.program.kept import KeptPrograms
from fraese.program.program import Program
from fraese.program.way import Way, way_of


class Resumption:
    """How a program that was cut short would be gone on with.

    Args:
        left: as it was left.
        program: as it was when it was started.
        context: the machine as it stands.

    Attributes:
        name: of the program.
        line: where it was cut short.
        moves: so many moves lie before that.
        program: as given.
        path: where it was.
    """

    def __init__(self, left: Interrupted, program: Program, context: ProgramContext) -> None:
        self.name = left.name
        self.line = left.line
        self.moves = max(left.move - 1, 0)
        self.program, self.path = program, program.path
        self._left = left
        self._context = context

    @classmethod
    def of(cls, controller: Controller, kept: KeptPrograms, *, apart: bool = False) -> "Resumption":
        """Of the last program on this machine; in the machine's thread.

        Args:
            controller: the machine.
            kept: where the copies of programs are.
            apart: see ``Program``.

        Raises:
            StateError: there is none, nobody knows its place on the machine any more, or the
                machine is not ready.
            ProgramError: what was kept of it is damaged, or its copy is gone.
        """
        left = Interrupted.of(controller.keep().job)
        program = Program(kept.find(left.content_hash), apart=apart, kept=kept, drawn=apart)
        if left.height_map is not None:
            kept_map = left.height_map
            program.heights = kept.find_map(Path(kept_map.path), kept_map.content_hash)
        context = program.stands(controller)
        left.require_same_machine(context)
        if controller.position.doubt is not None:
            raise StateError(
                phrase(
                    "{doubt_in_words}; nothing has moved.",
                    doubt_in_words=controller.position.doubt_in_words().rstrip("."),
                )
            )
        controller.check_moves([])
        return cls(left, program, context)

    def news(self) -> tuple[str, ...]:
        """What a person should know who goes on with it, sentences."""
        changed = self.program.news()
        as_started = (
            phrase("{changed} What runs is what it held when it was started.", changed=changed),
        )
        return (*self._left.news(self._context), *(as_started if changed else ()))

    def way(self, back: int = 0, given_up: Callable[[], bool] = lambda: False) -> Way:
        """The way to the place, or to one some moves before it; from any thread, may take long.

        Raises:
            ProgramError: if a line before it is refused.
            Cancelled: if it was given up.
        """
        begun = self.program.begun(self._context, past=self._left, back=back)
        return way_of(begun, given_up)

    def words(self, back: int = 0) -> list[str]:
        """All that is to be said before it moves, in lines."""
        way = self.way(back)
        return [*way.lines(self.name), *self.news()]

    def start(self, controller: Controller, back: int = 0) -> None:
        """Give it to the controller; its ``run`` goes on with it. In the machine's thread.

        Raises:
            StateError: if the machine is not ready, or stands otherwise by now.
        """
        if self.program.stands(controller) != self._context:
            raise StateError(
                phrase(
                    "The machine has changed since it was shown how to go on with {name}:"
                    " ask again; nothing has moved.",
                    name=self.name,
                )
            )
        lines = len(self.program.lines)
        self.program.start(controller, past=self._left, back=back, lines=lines)
