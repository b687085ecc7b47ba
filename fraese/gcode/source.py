"""Lines of a program with a place in them, kept only as far as something may jump back.

Rule 1  A line is pulled from its iterator when it is asked for, so a program streams.
Rule 2  Lines are kept only while someone holds the place: a loop (back to its head), a
        look ahead for a subroutine (back to the call). Held lines are dropped once the last
        hold is gone and they have been passed again.
Rule 3  Places are line numbers, 1-based.
Rule 4  Where lines come one by one from somebody, ``NOT_YET`` stands for one that is not there yet.
        It is no line; nothing that looks ahead for a label may be among such lines.
"""

from collections.abc import Iterable, Iterator
from typing import Final

#: Instead of a line: there is none yet. Compared by identity, so that no text is taken for it.
NOT_YET: Final = "".join(("not", " ", "yet"))


class Source:
    """An iterator of lines that can go back to held places.

    Attributes:
        first_line: its number.
        is_framed: it began with a percent sign, so that the next one is its end.
    """

    def __init__(self, lines: Iterable[str], file: str, first_line: int = 1) -> None:
        self.file = file
        self.is_framed = False
        self.first_line = first_line
        # number of the line that was returned last
        self.line = first_line - 1
        self._lines: Iterator[str] = iter(lines)
        self._kept: list[str] = []
        # number of the line before the first kept one
        self._base = self.line
        self._holds = 0

    def next(self) -> str | None:
        """The next line, or None at the end."""
        kept = self._kept
        if kept or self._holds:
            return self._next_kept()
        text = next(self._lines, None)
        if text is not None and text is not NOT_YET:
            self.line += 1
        return text

    def _next_kept(self) -> str | None:
        index = self.line - self._base
        if index < len(self._kept):
            self.line += 1
            return self._kept[index]
        if not self._holds:
            self._kept.clear()
            return self.next()
        text = next(self._lines, None)
        if text is not None:
            self._kept.append(text)
            self.line += 1
        return text

    def hold(self) -> int:
        """Keep everything from the next line on; returns the place for ``back``."""
        if not self._kept and not self._holds:
            self._base = self.line
        self._holds += 1
        return self.line

    def release(self) -> None:
        """Give up one hold."""
        self._holds -= 1

    def back(self, place: int) -> None:
        """Return to a held place: the line behind it comes next."""
        self.line = place
