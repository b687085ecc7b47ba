"""What the app expects of a program; the reader of files is handed in by the composition root."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from fraese.control.controller import Controller
from fraese.errors import FraeseError, ProgramError


class Facts(Protocol):
    """What is known of a program before it runs."""

    @property
    def low_mm(self) -> tuple[float, ...] | None:
        """Lowest machine position of every axis; None: nothing moves."""

    @property
    def high_mm(self) -> tuple[float, ...] | None:
        """Highest machine position of every axis; likewise."""

    @property
    def duration_s(self) -> float:
        """Planned machine time."""

    @property
    def length_mm(self) -> float:
        """Length of the path."""

    @property
    def blocks(self) -> int:
        """Number of blocks."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the operator should know; a sentence each."""


class Program(Protocol):
    """A program that has been read."""

    @property
    def name(self) -> str:
        """For people."""

    @property
    def lines(self) -> Sequence[str]:
        """Its text."""

    def check(self, controller: Controller) -> Facts:
        """See whether it can run from here; in the machine's thread.

        Raises:
            FraeseError: if it cannot.
        """

    def start(self, controller: Controller) -> None:
        """Hand it to the controller; in the machine's thread.

        Raises:
            FraeseError: if it is refused.
        """


OpenProgram = Callable[[Path], Program]


def in_words(facts: Facts) -> str:
    """Length and duration of a program."""
    minutes, seconds = divmod(round(facts.duration_s), 60)
    return f"{facts.blocks} blocks, {facts.length_mm:.1f} mm, {minutes}:{seconds:02d} min"


class ProgramDesk:
    """The program that is loaded, for every view.

    Args:
        open_program: reads a file; may take long.
        path: what is offered to be opened first.

    Attributes:
        path: of what was opened last.
        program: what is loaded.
    """

    def __init__(self, open_program: OpenProgram, path: Path | None = None) -> None:
        self._open_program = open_program
        self.path = path
        self.program: Program | None = None

    @property
    def folder(self) -> Path:
        """Where programs are looked for."""
        here = self.path is not None and self.path.parent.is_dir()
        return self.path.parent if self.path is not None and here else Path.cwd()

    def read(self, path: Path) -> Program:
        """Read a file; from any thread.

        Raises:
            FraeseError: if it cannot be read, or the reader fails.
        """
        try:
            return self._open_program(path)
        except FraeseError:
            raise
        except Exception as error:  # a reader's mistake must not end the control of a machine
            sentence = f"the reader failed, {error!r}; nothing is loaded."
            raise ProgramError(sentence, file=str(path)) from error

    def put(self, path: Path, program: Program) -> None:
        """This one is loaded now."""
        self.path, self.program = path, program
