"""A program that was interrupted: what must be known to go on with it where the motors were.

    then    start -- move 1 -- move 2 -- ... -- move n x          what is kept: the start, n, and
                                                                  what probes found on the way
    now     start ~~ read again, with those answers ~~ move n --> ...

Rule 1: reading again from the same start gives the same moves: loops, calls and all that is modal
        need not be kept. So a place is the number of a move.
Rule 2: what depends on where the machine stood, or on what a probe found, is taken from then.
Rule 3: work offsets that a person has changed since count (a new tool was touched off), unless the
        program sets them itself.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from typing import Any, Final, Protocol

from pydantic import BaseModel, ConfigDict, ValidationError

from fraese.control.jobs import line_of, move_of
from fraese.errors import ProgramError, StateError
from fraese.gcode import canon
from fraese.phrases import phrase
from fraese.program.context import ProgramContext
from fraese.program.mapped import TakenMap

#: A record of the state has no room for what more probes found.
_MOST_ANSWERS: Final = 64


class Answer(BaseModel):
    """What a barrier was answered, as ``canon.Facts``."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    position_mm: tuple[float, ...]
    touched: bool = False
    contact_mm: tuple[float, ...] | None = None
    parameters: dict[int, float] = {}

    def facts(self) -> canon.Facts:
        """For the interpreter."""
        return canon.Facts(self.position_mm, self.touched, self.contact_mm, self.parameters)


class KeptMap(BaseModel):
    """Which height map a program was run with.

    Attributes:
        path: of its file.
        content_hash: of what that held.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    path: str
    content_hash: str

    @classmethod
    def of(cls, taken: TakenMap | None) -> "KeptMap | None":
        """What is kept of one; None: there is none."""
        if taken is None:
            return None
        return cls(path=str(taken.path), content_hash=taken.content.content_hash)


class Interrupted(BaseModel):
    """A job as it was left.

    Attributes:
        name: of the program, for people.
        content_hash: of what the file held.
        start_steps: where the machine stood at its start,
        slack_steps: with so much backlash,
        referenced: and these axes referenced.
        parameters: persistent parameters of the language then.
        changed: those that were others in the end.
        visited: those that a person had changed at the question that was not answered.
        answers: what barriers were answered, by the number of their move; None: too many to keep.
        move: number of the move in hand; 0: none had begun.
        line: its line.
        height_map: to which its moves were bent; None: to none.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    name: str
    content_hash: str
    start_steps: tuple[int, ...]
    slack_steps: tuple[int, ...]
    referenced: tuple[bool, ...]
    parameters: dict[int, float]
    changed: dict[int, float]
    visited: dict[int, float] = {}
    answers: dict[int, Answer] | None
    move: int
    line: int
    height_map: KeptMap | None = None

    @classmethod
    def of(cls, kept: Mapping[str, Any] | None) -> "Interrupted":
        """As it was kept.

        Raises:
            StateError: there is none.
            ProgramError: it is no such thing.
        """
        if kept is None:
            raise StateError(
                phrase("No program was cut short on this machine: there is nothing to go on with.")
            )
        try:
            return cls.model_validate(kept)
        except ValidationError as error:
            raise ProgramError(
                phrase("what was kept of the interrupted job is damaged.")
            ) from error

    def require_same_machine(self, now: ProgramContext) -> None:
        """See that its coordinates are still those of the machine.

        Raises:
            StateError: if they are not known to be.
        """
        names = now.machine.names
        if len(self.start_steps) != len(names):
            raise StateError(phrase("{name} was run on a machine with other axes.", name=self.name))
        if self.answers is None:
            raise StateError(
                phrase(
                    "{name} has probed more than {most_answers} times: run it from a line"
                    " (fraese run --from-line).",
                    name=self.name,
                    most_answers=_MOST_ANSWERS,
                )
            )
        lost = self._axes(now, then=True)
        if lost:
            raise StateError(
                phrase(
                    "{name} was run with {lost} referenced, and now nobody knows the place:"
                    " reference first (fraese home); nothing has moved.",
                    name=self.name,
                    lost=lost,
                )
            )
        moved = self._axes(now, then=False)
        if moved:
            raise StateError(
                phrase(
                    "{name} was run with {moved} not referenced, and the reference since has"
                    " given the place other numbers: run it from a line (fraese run"
                    " --from-line); nothing has moved.",
                    name=self.name,
                    moved=moved,
                )
            )

    def _axes(self, now: ProgramContext, *, then: bool) -> str:
        """Axes that were referenced, or not, and are otherwise now, in words; empty: none."""
        names = [
            name.upper()
            for name, was, is_now in zip(
                now.machine.names, self.referenced, now.referenced, strict=True
            )
            if was is then and is_now is not then
        ]
        return (
            phrase("axes {names}", names=" ".join(names))
            if len(names) > 1
            else phrase("axis {names}", names=names[0])
            if names
            else ""
        )

    def context(self, now: ProgramContext) -> ProgramContext:
        """The machine as the program found it, with what a person has changed since."""
        parameters = {**self.parameters, **self.visited}
        for number in self._touched(now.parameters):
            if number not in self.changed:
                parameters[number] = now.parameters.get(number, 0.0)
        return replace(
            now,
            start_steps=self.start_steps,
            slack_steps=self.slack_steps,
            referenced=self.referenced,
            parameters=parameters,
        )

    def news(self, now: ProgramContext) -> list[str]:
        """What a person should know who goes on with it, sentences."""
        touched = self._touched(now.parameters)
        if any(number in self.changed for number in touched):
            return [
                phrase(
                    "Work offsets were changed since; the program sets them: they are as it says."
                )
            ]
        if touched:
            return [phrase("Work offsets were changed since: they count.")]
        return []

    def _touched(self, now: Mapping[int, float]) -> list[int]:
        """Parameters that are others than when it was interrupted."""
        then = {**self.parameters, **self.changed}
        return [n for n in {*then, *now} if then.get(n, 0.0) != now.get(n, 0.0)]

    def facts(self) -> dict[int, canon.Facts]:
        """What barriers were answered, by the number of their move."""
        return {number: answer.facts() for number, answer in (self.answers or {}).items()}


def cut_short(kept: Mapping[str, Any] | None) -> tuple[str, ...]:
    """That there is a program to go on with: a sentence, or none."""
    if kept is None:
        return ()
    try:
        left = Interrupted.of(kept)
    except ProgramError as error:
        return (str(error).capitalize(),)
    return (
        phrase(
            "{name} was cut short in line {line}: fraese resume goes on with it.",
            name=left.name,
            line=left.line,
        ),
    )


class Heard(Protocol):
    """What a running program has been told.

    Attributes:
        answers: what barriers were answered, by the number of their move; goes on growing.
        visited: what a person has changed since the program asked for him last, and
        visited_at: the number of the move that did so.
    """

    answers: dict[int, canon.Facts]
    visited: Callable[[], Mapping[int, float]]
    visited_at: int


class JobNote:
    """What is kept of a job while it runs, to be read as ``Interrupted``.

    Args:
        name: of the program.
        content_hash: of what it holds.
        start: the machine as it finds it.
        heard: what it has been told so far.
        height_map: to which its moves are bent; None: to none.
    """

    def __init__(
        self,
        name: str,
        content_hash: str,
        start: ProgramContext,
        heard: Heard,
        height_map: KeptMap | None = None,
    ) -> None:
        self._heard = heard
        self._before = start.parameters
        self._fixed: dict[str, Any] = {
            "name": name,
            "content_hash": content_hash,
            "start_steps": start.start_steps,
            "slack_steps": start.slack_steps,
            "referenced": start.referenced,
            "parameters": dict(start.parameters),
            **({"height_map": height_map.model_dump()} if height_map else {}),
        }

    def at(self, tag: int, parameters: Mapping[int, float]) -> dict[str, Any]:
        """All of it, plain enough for JSON.

        Args:
            tag: of the block in hand.
            parameters: in force where the motors are.
        """
        before, move = self._before, move_of(tag)
        answers = {
            number: {name: value for name, value in asdict(facts).items() if value}
            for number, facts in dict(self._heard.answers).items()
            if number < move
        }
        return {
            **self._fixed,
            "changed": {n: v for n, v in parameters.items() if before.get(n, 0.0) != v},
            # Later it is among the answers.
            "visited": dict(self._heard.visited()) if self._heard.visited_at >= move else {},
            "answers": answers if len(answers) <= _MOST_ANSWERS else None,
            "move": move,
            "line": line_of(tag),
        }
