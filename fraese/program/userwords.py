"""What M100 to M199 mean on this machine: rows, packages of their own, programs in a folder.

    M110 P0.2  -->  row "M110" of peers.py: WORDS, or of an installed package
               -->  the file M110 in run.m_code_folder, with P and Q as its arguments

Rule 1: a program is carried out as it is, with two arguments, and never by a shell. A check carries
        none out, and nobody does who has named no folder.
Rule 2: it is over when it has ended: the job waits at a standstill, and is looked after meanwhile.
        What is cancelled meanwhile ends it, with all that it has started.
Rule 3: ended with anything but 0, it fails the job, and its last line says why.
"""

import os
import signal
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import IO, Final

from fraese.config import Config
from fraese.control.jobs import TURN, Turn
from fraese.errors import ProgramError
from fraese.gcode.canon import Command, Move
from fraese.gcode.userwords import Call, Word
from fraese.peers import WORDS
from fraese.phrases import phrase, reason
from fraese.plaintext import plain

#: What is passed where a program says no P or Q.
_NOT_GIVEN: Final = -1.0
#: From one look at the program to the next; the run loop has its turn between them.
_LOOK_S: Final = 0.02
#: After it was asked to end.
_GRACE_S: Final = 0.5
_SHOWN_CHARACTERS: Final = 200


def user_word(config: Config, code: int) -> Word | None:
    """What a code means on this machine; None: nothing.

    Raises:
        ConfigError: a package that offers it cannot be used.
        ProgramError: its file may not be executed.
    """
    name = f"M{code}"
    if WORDS.has(name):
        found = WORDS.record(name)
        assert isinstance(found, Word)
        return found
    folder = config.run.programs
    if folder is None or not (folder / name).exists():
        return None
    path = folder / name
    if not (path.is_file() and os.access(path, os.X_OK)):
        raise ProgramError(
            phrase("{name}: {path} may not be executed: chmod +x lets it", name=name, path=path)
        )
    return Word(partial(_carried_out, path))


def _carried_out(path: Path, call: Call) -> Iterable[Move]:
    p, q = (_NOT_GIVEN if value is None else value for value in (call.p, call.q))
    return (Command(call.line, call.code, (str(path), f"{p:f}", f"{q:f}")),)


def execute(command: Command) -> Iterator[Turn]:
    """Carry a program out, with a turn for the run loop now and then.

    Raises:
        ProgramError: it cannot be started, or fails.
    """
    name = f"M{command.code}"
    with tempfile.TemporaryFile() as said:
        try:
            process = subprocess.Popen(
                command.words,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=subprocess.STDOUT,
                cwd=Path(command.words[0]).parent,
                start_new_session=True,
            )
        except OSError as error:
            raise ProgramError(
                phrase(
                    "{name}: {path} cannot be started: {reason}",
                    name=name,
                    path=command.words[0],
                    reason=reason(error),
                ),
                line=command.line,
            ) from error
        try:
            while not _is_over(process):
                yield TURN
        finally:
            _end(process)
        if process.returncode:
            raise ProgramError(
                phrase(
                    "{name} has ended with {code}: {said}",
                    name=name,
                    code=process.returncode,
                    said=_last_line(said) or phrase("it has said nothing"),
                ),
                line=command.line,
            )


def _is_over(process: "subprocess.Popen[bytes]") -> bool:
    try:
        process.wait(_LOOK_S)
    except subprocess.TimeoutExpired:
        return False
    return True


def _end(process: "subprocess.Popen[bytes]") -> None:
    """Ask what still runs to end, then end it."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        if process.poll() is not None:
            return
        with suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with suppress(subprocess.TimeoutExpired):
            process.wait(_GRACE_S)


def _last_line(said: IO[bytes]) -> str:
    said.seek(max(0, said.seek(0, os.SEEK_END) - 4096))
    lines = said.read().decode("utf-8", "replace").split("\n")
    found = next((line.strip() for line in reversed(lines) if line.strip()), "")
    return plain(found[:_SHOWN_CHARACTERS])
