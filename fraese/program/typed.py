"""Lines that somebody types, run like a program: the same language, the same checks.

Rule 1: what is typed begins as a program does (G90, G21, no feed) and ends as one (G54); offsets
        and tool stay. A work offset alone is chosen, and stays.
"""

import io
import re
from pathlib import Path
from typing import Final

from fraese.control.controller import Controller
from fraese.control.workcommands import select_system
from fraese.errors import ProgramError
from fraese.phrases import phrase
from fraese.program.content import Content, taken_from
from fraese.program.program import Program
from fraese.program.taken import Taken, take_program

#: A work offset, and nothing else.
_SYSTEM: Final = re.compile(r"\s*[gG]\s*(5[4-9](?:\.[1-3])?)\s*")
#: It is looked through in the machine's thread, while somebody waits.
_MOST_BYTES: Final = 100_000
#: In messages; its ending says that it is G-code.
_PLACE: Final = Path("typed.ngc")


_TYPED_LINE: Final = phrase("typed line")


class _Typed(Taken):
    """It has no file that could change."""

    def news(self) -> str:
        """Nothing."""
        return ""


def content_of(text: str) -> Content:
    """A text that stands in no file, as what a file held."""
    data = text.encode()
    return taken_from(io.BytesIO(data), phrase("what was typed"), len(data))


def run_text(
    controller: Controller, text: str, name: str = _TYPED_LINE, place: Path = _PLACE
) -> None:
    """Look it through and start it; the controller's ``run`` works it off.

    Args:
        controller: the machine.
        text: lines of G-code.
        name: for people.
        place: in messages; its ending says that it is G-code.

    Raises:
        ProgramError: if a line is refused.
        LimitError: if it leaves the travel.
        StateError: if the machine is not ready.
    """
    chosen = _SYSTEM.fullmatch(text)
    if chosen is not None:
        # A program would go back to G54 at its end.
        select_system(controller, f"G{chosen[1]}")
        return
    program = typed_program(text, name, place)
    facts = program.check(controller)
    program.start(controller, facts)


def typed_program(text: str, name: str = _TYPED_LINE, place: Path = _PLACE) -> Program:
    """Lines of G-code as a program that has no file. As for ``run_text``."""
    program = Program(_Typed(place, content_of(text), {}))
    program.name = name
    return program


def run_file(controller: Controller, path: Path, name: str) -> None:
    """The same with what a file holds now; a long one is a program, and is opened as such.

    Args:
        controller: the machine.
        path: of the file.
        name: for people.

    Raises:
        ProgramError: if it cannot be read, is too long, or a line is refused.
        LimitError: if it leaves the travel.
        StateError: if the machine is not ready.
    """
    taken = take_program(path)
    if taken.main.size > _MOST_BYTES:
        raise ProgramError(phrase("is too long for a macro: open it instead."), file=str(path))
    program = Program(taken)
    program.name = name
    program.start(controller, program.check(controller))
