"""A program as it was when it was opened: its file, and the files of subroutines that it calls.

Rule 1: what was looked through is what runs: whoever reads the program reads this, and nobody
        reads the disk a second time.
Rule 2: a subroutine's file is taken when it is first asked for; one that was not there then stays
        missing.
"""

from collections.abc import Iterator
from pathlib import Path

from fraese.errors import ProgramError
from fraese.gcode.reader import Kind, kind_of
from fraese.gcode.text import require_inside
from fraese.phrases import phrase
from fraese.program.content import Content, is_still, take


class Taken:
    """A program's files.

    Args:
        path: where the program was.
        main: what it holds.
        files: what was taken besides.

    Attributes:
        files: subroutine files by path; None: there was none.
    """

    def __init__(self, path: Path, main: Content, files: dict[Path, Content | None]) -> None:
        self.path = path
        self.main = main
        self.files = files

    @property
    def kind(self) -> Kind:
        """What the program is written in."""
        return kind_of(self.path, self.main.lines)

    def lines(self, path: Path) -> Iterator[str] | None:
        """The lines of a subroutine's file; None: there is none.

        Raises:
            ProgramError: it cannot be read.
        """
        if path not in self.files:
            require_inside(path)
            self.files[path] = take(path)
        content = self.files[path]
        return None if content is None else content.lines()

    def news(self) -> str:
        """What became of the file since, a sentence; empty: it holds what it did."""
        still = is_still(self.path, self.main)
        if still is None:
            return phrase("{name} is gone from where it was opened.", name=self.path.name)
        return (
            ""
            if still
            else phrase("{name} has changed on disk since it was opened.", name=self.path.name)
        )


def take_program(path: Path) -> Taken:
    """Read a program file, once.

    Raises:
        ProgramError: naming it, if there is nothing to read.
    """
    main = take(path)
    if main is None:
        raise ProgramError(phrase("there is no such file."), file=str(path))
    if main.is_blank:
        raise ProgramError(phrase("is empty: there is nothing to run."), file=str(path))
    return Taken(path, main, {})
