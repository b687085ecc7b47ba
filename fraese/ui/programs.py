"""What the app expects of a program; the reader of files is handed in by the composition root."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from fraese.control.controller import Controller
from fraese.errors import FraeseError, ProgramError, StateError
from fraese.phrases import spoken
from fraese.ui.filememory import Forgets, MapMemory, Recent


class Complaint(Protocol):
    """Something wrong, and where."""

    @property
    def line(self) -> int:
        """Where; 0: no line can be told."""

    @property
    def message(self) -> str:
        """What, a sentence."""


class Wants(Protocol):
    """What a program asks for."""

    @property
    def tools(self) -> tuple[int, ...]:
        """Numbers, in the order in which they are first put in."""

    @property
    def spindle_rev_min(self) -> tuple[float, float] | None:
        """Lowest and highest speed; None: it is never switched on."""

    @property
    def stops(self) -> int:
        """So often it waits for a person."""

    @property
    def optional_stops(self) -> int:
        """So often at M1."""

    @property
    def probes(self) -> int:
        """So often it probes."""


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

    @property
    def errors(self) -> Sequence[Complaint]:
        """Why it is refused."""

    @property
    def outside(self) -> Sequence[Complaint]:
        """Where it leaves the travel."""

    @property
    def notes(self) -> Sequence[Complaint]:
        """What is passed over in it."""

    @property
    def wants(self) -> Wants:
        """What it asks of the machine and of whoever stands at it."""

    @property
    def outline(self) -> Any:
        """Where the tool goes, see ``widgets.scene``; None: nobody knows."""


class Stage(Protocol):
    """How far a look-through is."""

    @property
    def lines(self) -> int:
        """Read so far."""

    @property
    def outline(self) -> Any:
        """Of what was read; None: there is none yet."""


class Program(Protocol):
    """A program that has been read."""

    @property
    def name(self) -> str:
        """For people."""

    @property
    def lines(self) -> Sequence[str]:
        """Its text."""

    @property
    def facts(self) -> Facts | None:
        """What the last look-through found, also of a program that was refused."""

    @property
    def stage(self) -> Stage | None:
        """How far one is that goes on; None: none does."""

    @property
    def map_words(self) -> str:
        """The height map that it is bent to; empty: none."""

    def bend_to(self, path: Path | None) -> None:
        """Take another height map, or none; refuses one that cannot be read."""

    def parts(self, line: str) -> Sequence[tuple[str, str]]:
        """A line in parts: of which kind each is, and its text."""

    def news(self) -> str:
        """What became of its file since it was read, a sentence; empty: nothing."""

    def question(self, controller: Controller) -> Any:
        """What ``look`` has to be asked; in the machine's thread.

        None: it was looked through as the machine stands now, and can run.
        """

    def look(self, question: Any) -> Facts:
        """See whether it can run; may take for ever, in a thread of its own.

        Raises:
            FraeseError: if it cannot, or was given up.
        """

    def give_up(self) -> None:
        """End a ``look``, at once; from any thread."""

    def close(self) -> None:
        """It is not needed any more."""

    def start(self, controller: Controller, *, from_line: int = 0) -> None:
        """Hand it to the controller; in the machine's thread.

        Raises:
            FraeseError: if it is refused.
        """

    def drive_frame(self, controller: Controller) -> None:
        """Drive round it above the work; likewise.

        Raises:
            FraeseError: if it is refused.
        """

    def way_lines(self, stands: Any, from_line: int, given_up: Callable[[], bool]) -> Sequence[str]:
        """What a start in the middle would do, in lines; may take long, in a thread of its own.

        Raises:
            FraeseError: if there is nothing to run there, or it was given up.
        """

    def stands(self, controller: Controller) -> Any:
        """The machine as it stands, for ``way_lines``; in the machine's thread."""


OpenProgram = Callable[[Path], Program]


class Way(Protocol):
    """The way to a place in a program."""

    @property
    def line(self) -> int:
        """Where it goes on."""

    @property
    def text(self) -> str:
        """What stands there."""

    @property
    def legs(self) -> Sequence[tuple[str, str, bool]]:
        """What is done on the way; the same in work coordinates, if they are others; it moves."""

    @property
    def height(self) -> str:
        """At which it goes over; empty: nothing lifts the tool."""

    @property
    def in_force(self) -> str:
        """What is in force at the place."""


class Resumption(Protocol):
    """How a program that was cut short would be gone on with."""

    @property
    def name(self) -> str:
        """Of the program."""

    @property
    def path(self) -> Path:
        """Where it was."""

    @property
    def program(self) -> Program:
        """As it was when it was started."""

    @property
    def moves(self) -> int:
        """So many moves lie before the place."""

    def news(self) -> Sequence[str]:
        """What a person should know, sentences."""

    def way(self, back: int, given_up: Callable[[], bool]) -> Way:
        """The way to so many moves before the place; may take long, in a thread of its own.

        Raises:
            FraeseError: if there is none, or it was given up.
        """

    def start(self, controller: Controller, back: int) -> None:
        """Hand it to the controller; in the machine's thread.

        Raises:
            FraeseError: if it is refused.
        """


Resume = Callable[[Controller], Resumption]


def nothing_is_kept(_controller: Controller) -> Resumption:
    """Of an app that keeps no programs."""
    raise StateError(spoken("No copies of programs are kept here: there is nothing to go on with."))


def in_words(facts: Facts) -> str:
    """Length and duration of a program."""
    minutes, seconds = divmod(round(facts.duration_s), 60)
    return spoken(
        "{blocks} blocks, {length_mm:.1f} mm, {minutes}:{seconds:02d} min",
        blocks=facts.blocks,
        length_mm=facts.length_mm,
        minutes=minutes,
        seconds=seconds,
    )


class Look:
    """A file that is being read, or a program that is being looked through.

    Attributes:
        given_up: whatever comes out of it counts no more.
        busy: it has begun.
    """

    def __init__(self) -> None:
        self.given_up = False
        self.busy = False


class ProgramDesk:
    """The program that is loaded, for every view; all in the app's thread but ``read``.

    Args:
        open_program: reads a file; may take long.
        path: what is offered to be opened first.
        resume: how the program that was cut short is gone on with; refuses in the machine's thread.
        recent: which were opened last.

    Attributes:
        resume: likewise.
        recent: likewise.
        maps: which file is bent to which height map.
        path: of what was opened last.
        program: what is loaded.
        look: what goes on just now beside everything else.
    """

    def __init__(
        self,
        open_program: OpenProgram,
        path: Path | None,
        resume: Resume,
        recent: Recent | None = None,
    ) -> None:
        self._open_program = open_program
        self.resume = resume
        self.recent = recent or Forgets()
        self.maps = MapMemory()
        self.path = path
        self.program: Program | None = None
        self.look: Look | None = None
        #: Where programs were looked for the last time.
        self.last_folder: Path | None = None

    @property
    def folder(self) -> Path:
        """Where programs are looked for."""
        with suppress(OSError):
            for folder in (self.path and self.path.parent, self.last_folder):
                if folder is not None and folder.is_dir():
                    return folder
            return Path.cwd()
        return Path.home()

    def begin(self) -> Look:
        """Something is read or looked through from now on; what was before is given up."""
        self.give_up()
        self.look = Look()
        return self.look

    def ended(self, look: Look) -> bool:
        """It is done, or failed; whether it still counts."""
        if self.look is look:
            self.look = None
        return not look.given_up

    def give_up(self) -> bool:
        """End what is being read or looked through; False: nothing was."""
        look, self.look = self.look, None
        if look is None:
            return False
        look.given_up = True
        if self.program is not None:
            self.program.give_up()
        return True

    def close(self) -> None:
        """Nothing goes on any more."""
        self.give_up()
        if self.program is not None:
            self.program.close()

    def read(self, path: Path) -> Program:
        """Read a file; from any thread.

        Raises:
            FraeseError: if it cannot be read, or the reader fails.
        """
        loaded = self.program
        if loaded is not None and path == self.path and not loaded.news():
            # It is still what was read.
            return loaded
        try:
            program = self._open_program(path)
            # Read here, where nobody waits.
            _ = program.lines
            return program
        except FraeseError:
            raise
        except Exception as error:  # a reader's mistake must not end the control of a machine
            sentence = spoken("the reader failed, {error}; nothing is loaded.", error=repr(error))
            raise ProgramError(sentence, file=str(path)) from error

    def put(self, path: Path, program: Program) -> None:
        """This one is loaded now."""
        if self.program is not None and self.program is not program:
            self.program.close()
        self.path, self.program = path, program
