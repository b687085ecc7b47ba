"""Where subroutines come from: the program itself, or files of their own."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.setup import Setup
from fraese.gcode.source import Source
from fraese.gcode.words import plain
from fraese.phrases import phrase

# A subroutine's body is held in memory; this is far beyond any that a person wrote.
MAX_BODY: Final = 200_000
# One subprogram may run into the next, so that lines are held for each: this many in all.
MAX_NUMBERED: Final = 1_000_000
_FILE_NAME = re.compile(r"[a-z0-9_+-][a-z0-9_.+-]*")


@dataclass(frozen=True, slots=True)
class Sub:
    """A subroutine's lines from behind ``sub`` on, its ``endsub`` included."""

    file: str
    first_line: int
    lines: tuple[str, ...]


# Name and keyword of the O-word on a line, None where there is none.
Label = Callable[[str], tuple[str, str] | None]
# The keyword of an O-word that stands alone on its line, as the name of a program does.
PROGRAM_NUMBER: Final = ""
# What a subroutine or subprogram begins with.
HEADS: Final = ("sub", PROGRAM_NUMBER)


# Reads a body whose head was passed just now.
Body = Callable[[str, Source], Sub]


class Library:
    """All subroutines that are known so far."""

    def __init__(self, program: Source, setup: Setup, label: Label) -> None:
        self._program = program
        self._label = label
        self._folders = setup.folders
        self._file_lines = setup.file_lines
        self._subs: dict[str, Sub] = {}
        self._numbered: dict[str, Sub] = {}
        # What was seen when looking ahead: lines by name and keyword, and the last line of all.
        # Lines that were seen but not yet passed are still with the program.
        self._ahead: dict[tuple[str, str], list[int]] = {}
        self._seen = 0
        self._numbered_lines = 0

    def define(self, name: str, source: Source) -> None:
        """Take in the subroutine whose ``sub`` line was read from the source just now.

        Raises:
            ProgramError: it is defined twice, or has no end.
        """
        if name in self._subs:
            first = self._subs[name].first_line - 1
            raise ProgramError(
                phrase(
                    "o<{name}> sub: the program must not run into a subroutine that is"
                    " already defined (line {first}); end it with M2 before, or define it"
                    " once",
                    name=name,
                    first=first,
                )
            )
        self._subs[name] = self._body(name, source)

    def find(self, name: str) -> Sub:
        """A subroutine by name: known, in a file of its own, or further ahead.

        Raises:
            ProgramError: there is none.
        """
        if name not in self._subs and not self._load(name):
            sub = self._look_ahead(name, "sub", self._body)
            if sub is None:
                where = phrase("the program") + (
                    phrase(" or the subroutine folders") if self._folders else ""
                )
                raise ProgramError(
                    phrase(
                        "o<{name}> call: there is no such subroutine in {where}",
                        name=name,
                        where=where,
                    )
                )
            self._subs[name] = sub
        return self._subs[name]

    def find_numbered(self, name: str) -> Sub:
        """The subprogram behind this number, for M98.

        Raises:
            ProgramError: the program goes on without it.
        """
        if name not in self._numbered:
            sub = self._look_ahead(name, PROGRAM_NUMBER, self._numbered_body)
            if sub is None:
                raise ProgramError(
                    phrase("M98 P{name}: no O{name} follows in the program", name=name)
                )
            self._numbered[name] = sub
        return self._numbered[name]

    def holds(self, line: int) -> bool:
        """Whether this line of the program is in a subroutine that was defined so far."""
        return any(
            sub.first_line - 1 <= line < sub.first_line + len(sub.lines)
            for sub in self._subs.values()
            if sub.file == self._program.file
        )

    def _load(self, name: str) -> bool:
        if _FILE_NAME.fullmatch(name) is None:
            return False
        for folder in self._folders:
            path = folder / f"{name}.ngc"
            lines = self._file_lines(path)
            if lines is not None:
                self._take_all(Source(lines, path.name))
                if name not in self._subs:
                    raise ProgramError(
                        phrase("{name} holds no o<{name_2}> sub", name=path.name, name_2=name),
                        file=str(path),
                    )
                return True
        return False

    def _take_all(self, source: Source) -> None:
        for text in _lines(source):
            label = self._label(text)
            if label is not None and label[1] == "sub":
                self._subs.setdefault(label[0], self._body(label[0], source))

    def _look_ahead(self, name: str, keyword: str, body: Body) -> Sub | None:
        program = self._program
        place = program.hold()
        try:
            if not self._go_to_label((name, keyword), place):
                return None
            return body(name, program)
        finally:
            program.back(place)
            program.release()

    def _go_to_label(self, wanted: tuple[str, str], place: int) -> bool:
        """Whether a label follows the place; if so, the program stands behind it."""
        program = self._program
        for line in self._ahead.get(wanted, ()):
            if line > place:
                program.back(line)
                return True
        program.back(max(place, self._seen))
        for text in _lines(program):
            self._seen = program.line
            label = self._label(text)
            if label is not None and label[1] in HEADS:
                self._ahead.setdefault(label, []).append(program.line)
                if label == wanted:
                    return True
        return False

    def _body(self, name: str, source: Source) -> Sub:
        first = source.line + 1
        lines: list[str] = []
        for text in _lines(source):
            lines.append(text)
            if self._label(text) == (name, "endsub"):
                return Sub(source.file, first, tuple(lines))
            if len(lines) > MAX_BODY:
                raise ProgramError(
                    phrase(
                        "o<{name}> sub is longer than {max_body} lines",
                        name=name,
                        max_body=MAX_BODY,
                    )
                )
        raise ProgramError(
            phrase("o<{name}> sub has no endsub before the end of file", name=name),
            first - 1,
            source.file,
        )

    def _numbered_body(self, name: str, source: Source) -> Sub:
        """All lines from here to an M99 that another head follows; M99 may come before."""
        first = source.line + 1
        lines: list[str] = []
        over = False
        for text in _lines(source):
            if over:
                label = self._label(text)
                if label is not None and label[1] in HEADS:
                    break
            if over or "99" in text:
                code = bare(text)
                over = code.startswith("m99") if code else over
            lines.append(text)
            if self._numbered_lines + len(lines) > MAX_NUMBERED:
                raise ProgramError(
                    phrase("the subprograms from O{name} on are too long without M99", name=name)
                )
        self._numbered_lines += len(lines)
        return Sub(source.file, first, tuple(lines))


def bare(text: str) -> str:
    """What a line says without its comments; nothing where it is malformed."""
    try:
        return plain(text).strip("(")
    except ProgramError:
        return ""


def _lines(source: Source) -> Iterator[str]:
    """The lines that follow, as far as the percent sign that closes what one has opened."""
    begun = source.line > 0
    while (text := source.next()) is not None:
        if text.strip() == "%":
            if source.is_framed:
                return
            source.is_framed = not begun
        begun = begun or bool(text.strip())
        yield text
