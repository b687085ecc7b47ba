"""What commands share that work on a machine.

A command says which options it shares by the type of its parameter ``on``
(``options.with_options``):

    Place          --config --json --state
    OpenPlace      ... and --trace
    StartingPlace  ... and --fresh
    Drive          ... and --real-time --trace
    Answering      ... and --yes --answer
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, cast

import typer

from fraese.assembly import Plant, assemble, state_folder
from fraese.assembly.drivers import ClockName
from fraese.cli import language
from fraese.cli.answers import Answers
from fraese.cli.departure import Departure
from fraese.cli.leaving import leave
from fraese.cli.options import (
    AnswerOption,
    ConfigOption,
    FreshOption,
    JsonOption,
    RealTimeOption,
    StateOption,
    TraceOption,
    YesOption,
)
from fraese.cli.output import note
from fraese.cli.session import More, Session
from fraese.control.controller import Controller
from fraese.errors import Cancelled, FraeseError
from fraese.phrases import phrase

#: What is said of Ctrl-C by a command that moves something without a job.
MOTORS_OFF: Final = phrase("Cancelled; the motors are off.")


@dataclass(frozen=True)
class Place:
    """Options of a command that looks at a machine where it was left."""

    config: ConfigOption = None
    as_json: JsonOption = False
    state: StateOption = None
    # Options of some commands only; here no fields.
    fresh = False
    real_time = False
    trace = cast(Path | None, None)
    yes = False
    answer = cast(list[str] | None, None)

    @property
    def folder(self) -> Path:
        """Where the state is kept."""
        return self.state or state_folder()

    def plant(
        self, clock: ClockName | None = None, *, at_desk: bool = False, trace: Path | None = None
    ) -> Plant:
        """The machine that they name; at a desk nothing is to move, and metal is left alone."""
        return assemble(
            language.load(self.config),
            clock=clock or ("paced" if self.real_time else "virtual"),
            state=self.folder,
            fresh=self.fresh,
            at_desk=at_desk,
            trace=trace or self.trace,
        )

    def do(
        self,
        action: Callable[[Controller], object],
        *,
        at_desk: bool = False,
        more: More = dict,
    ) -> None:
        """One command on that machine; leaves with its exit code. See ``Session.do``."""

        def go() -> int:
            plant = self.plant(at_desk=at_desk)
            departure = Departure()
            try:
                answers = Answers(self.answer or (), yes=self.yes)
                session = Session(plant, as_json=self.as_json, departure=departure, answers=answers)
                return session.do(action, more)
            except BaseException as error:
                plant.close()
                departure.machine_is_closed(_code_of(error))
                if plant.trace is not None and not plant.trace.waveform.is_whole:
                    note(plant.trace.waveform.sentence())
                raise

        leave(go, self.as_json)


@dataclass(frozen=True)
class OpenPlace(Place):
    """Options of a command that opens the port, and moves nothing."""

    trace: TraceOption = None


@dataclass(frozen=True)
class StartingPlace(Place):
    """The same, or as if it were new."""

    fresh: FreshOption = False


@dataclass(frozen=True)
class Drive(StartingPlace):
    """Options of a command that moves a machine."""

    real_time: RealTimeOption = False
    trace: TraceOption = None


@dataclass(frozen=True)
class Answering(Drive):
    """Options of a command whose job may ask something."""

    yes: YesOption = False
    answer: AnswerOption = None


def _code_of(error: BaseException) -> int:
    """The exit code that it will lead to."""
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return Cancelled.exit_code
    return error.exit_code if isinstance(error, FraeseError) else 1
