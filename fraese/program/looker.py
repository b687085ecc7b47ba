"""A program looked through in a process of its own, ``lookthrough.py``: it can be ended.

    asks     file, its bytes ... | question  -->  standard input of the other
    answers  how far it is ... | what was found, files it took   <--  its standard output

Rule 1: it is ended at any moment, and never outlives who asks: a thread of its own hears when
        standard input ends.
Rule 2: the folder in which the user works is not searched for modules.
Rule 3: its memory is bounded; what needs more is refused.
Rule 4: it reads no program file but subroutines', and says which: they are the same for the run.
"""

import pickle
import subprocess
import threading
import weakref
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Final

from fraese.errors import Cancelled, ProgramError
from fraese.phrases import phrase
from fraese.program.check import Facts
from fraese.program.content import Content, Stamp, taken_from
from fraese.program.context import ProgramContext
from fraese.program.taken import Taken
from fraese.program.telling import Stage, Tell
from fraese.spawn import command, environment

_MODULE: Final = "fraese.program.lookthrough"
_MOST_MEMORY_BYTES: Final = 1 << 30
_GIVEN_UP: Final = phrase("The look-through was given up; nothing has moved.")
#: What the wire says when the other side is gone.
_GONE: Final = (OSError, EOFError, ValueError, pickle.UnpicklingError)
#: A file as it is announced: its name in messages, size and stamp; None: there is none.
Announced = tuple[str, int, Stamp | None] | None


class Looker:
    """Looks one program through, as often as it is asked; one question at a time.

    The process stays for the next question until ``close``.

    Args:
        taken: the program; subroutine files that are found are added to it.
    """

    def __init__(self, taken: Taken) -> None:
        self._taken = taken
        self._process: subprocess.Popen[bytes] | None = None
        self._known: set[Path] = set()
        self._lock = threading.Lock()
        self._given_up = False
        weakref.finalize(self, _end, self.__dict__)

    def begin(self) -> None:
        """What was given up before does not count for the next question."""
        self._given_up = False

    def look(self, context: ProgramContext, *, plan: bool = True, tell: Tell) -> Facts:
        """Look it through; from any thread.

        Args:
            context: the machine as it stands.
            plan: plan the motion too.
            tell: told how far it is, in this thread.

        Raises:
            ProgramError: the other process died.
            Cancelled: it was given up.
        """
        process = self._started()
        try:
            facts = self._ask(process, context, plan, tell)
        except _GONE as error:
            self.close()
            if self._given_up:
                raise Cancelled(_GIVEN_UP) from error
            raise ProgramError(
                phrase("looking it through ended unexpectedly; try again."),
                file=self._taken.main.file,
            ) from error
        return facts

    def give_up(self) -> None:
        """End what is being looked through, at once; from any thread."""
        with self._lock:
            self._given_up = True
            if self._process is not None:
                self._process.kill()

    def close(self) -> None:
        """End the process."""
        with self._lock:
            _end(self.__dict__)

    def _started(self) -> "subprocess.Popen[bytes]":
        with self._lock:
            if self._given_up:
                raise Cancelled(_GIVEN_UP)
            if self._process is None:
                self._known.clear()
                self._process = subprocess.Popen(
                    command(_MODULE, str(_MOST_MEMORY_BYTES)),
                    env=environment(),
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    start_new_session=True,
                )
            return self._process

    def _ask(
        self, process: "subprocess.Popen[bytes]", context: ProgramContext, plan: bool, tell: Tell
    ) -> Facts:
        to, back, taken = process.stdin, process.stdout, self._taken
        assert to is not None
        assert back is not None
        for path, content in {taken.path: taken.main, **taken.files}.items():
            if path not in self._known:
                send_file(to, path, content)
                self._known.add(path)
        pickle.dump((context, plan), to)
        to.flush()
        while type(said := pickle.load(back)) is not Facts:
            if isinstance(said, Stage):
                tell(said)
                continue
            path, announced = said
            taken.files[path] = receive_file(back, announced)
            self._known.add(path)
        return said


def _end(looker: dict[str, Any]) -> None:
    """End the process of a looker, which may itself be gone."""
    process, looker["_process"] = looker.get("_process"), None
    if process is not None:
        process.kill()
        with suppress(OSError), process:
            pass  # what it was still to be told goes nowhere


# --- over the wire -------------------------------------------------------------------------------


def send_file(to: IO[bytes], path: Path, content: Content | None) -> None:
    """Announce a file, and send what it holds."""
    announced = None if content is None else (content.file, content.size, content.stamp)
    pickle.dump((path, announced), to)
    if content is not None:
        with content.open() as stream:
            while chunk := stream.read(1 << 16):
                to.write(chunk)


def receive_file(back: IO[bytes], announced: Announced) -> Content | None:
    """What was announced just now.

    Raises:
        EOFError: it does not come.
    """
    if announced is None:
        return None
    file, size, stamp = announced
    content = taken_from(back, file, size, stamp)
    if content.size != size:
        raise EOFError
    return content
