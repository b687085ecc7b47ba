"""The lines of a program for people: found once, read when they are looked at.

Rule 1: memory is four bytes a line and a few pages, however long the file is. Of a file in UTF-16
        there is as much as it has letters: its lines begin nowhere that could be found again.
Rule 2: a line is what ``gcode.text`` takes for one, with the same refusals.
"""

from array import array
from collections.abc import Iterator, Sequence
from contextlib import closing
from itertools import pairwise
from typing import Final, overload

import numpy as np
from numpy.typing import NDArray

from fraese.errors import ProgramError
from fraese.gcode.text import MAX_LINE, WIDE_MARKS, decoded
from fraese.phrases import phrase
from fraese.program.content import Content

_CHUNK_BYTES: Final = 1 << 20
_PAGE: Final = 128
_MOST_PAGES: Final = 16
_LF: Final = 10
_CR: Final = 13


class LineIndex(Sequence[str]):
    """Lines without their ends, by number from 0.

    Args:
        content: what the file held.

    Raises:
        ProgramError: it is binary, or has a line that is too long.
    """

    def __init__(self, content: Content) -> None:
        self._content = content
        self._pages: dict[int, list[str]] = {}
        # A file in UTF-16, as it would be in UTF-8.
        self._narrow: bytearray | None = None
        if content.starts_with(WIDE_MARKS):
            self._narrow = bytearray()
            self._starts = self._narrowed(self._narrow)
        else:
            self._starts = self._found()

    def __len__(self) -> int:
        return len(self._starts) - 1

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> list[str]: ...
    def __getitem__(self, index: int | slice) -> str | list[str]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if index < 0:
            index += len(self)
        if not 0 <= index < len(self):
            raise IndexError(index)
        return self._page(index // _PAGE)[index % _PAGE]

    def __iter__(self) -> Iterator[str]:
        return (self[i] for i in range(len(self)))

    def _page(self, number: int) -> list[str]:
        page = self._pages.get(number)
        if page is None:
            if len(self._pages) >= _MOST_PAGES:
                self._pages.pop(next(iter(self._pages)))
            starts = self._starts[number * _PAGE : (number + 1) * _PAGE + 1].tolist()
            held = self._bytes(starts[0], starts[-1])
            cuts = [at - starts[0] for at in starts]
            page = [decoded(held[a:b]) for a, b in pairwise(cuts)]
            if not number and page:
                page[0] = page[0].removeprefix("\ufeff")
            self._pages[number] = page
        return page

    def _narrowed(self, narrow: bytearray) -> NDArray[np.uint32]:
        """Put all lines there; where each begins, and the end of the last one."""
        starts = array("I", [0])
        with closing(self._content.lines()) as lines:
            for line in lines:
                narrow += f"{line}\n".encode(errors="surrogatepass")
                starts.append(len(narrow))
        return np.array(starts, np.uint32)

    def _bytes(self, start: int, end: int) -> bytes:
        if self._narrow is not None:
            return bytes(self._narrow[start:end])
        held = bytearray(end - start)
        count = self._content.read_at(start, memoryview(held))
        return bytes(held[:count])

    def _found(self) -> NDArray[np.uint32]:
        """Where each line begins, and the end of the last one."""
        size = self._content.size
        parts = [np.zeros(1, np.int64)]
        lines = 0
        for at in range(0, size, _CHUNK_BYTES):
            # One more, to see what stands behind a carriage return.
            held = np.frombuffer(self._bytes(at, min(size, at + _CHUNK_BYTES + 1)), np.uint8)
            chunk = held[:_CHUNK_BYTES]
            ends = chunk == _LF
            returns = np.flatnonzero(chunk == _CR)
            if len(returns):
                behind = np.append(held, 0)[returns + 1]
                ends[returns[behind != _LF]] = True
            starts = np.flatnonzero(ends).astype(np.int64) + (at + 1)
            nothing = np.flatnonzero(chunk == 0)
            if len(nothing):
                line = lines + int(np.searchsorted(starts, at + int(nothing[0]), "right")) + 1
                raise ProgramError(
                    phrase("this is a binary file (a NUL byte), not a program"),
                    line,
                    self._content.file,
                )
            lines += len(starts)
            parts.append(starts)
        found = np.concatenate(parts)
        if found[-1] != size:
            found = np.append(found, size)
        self._require_short(found)
        return found.astype(np.uint32)

    def _require_short(self, starts: NDArray[np.int64]) -> None:
        """Bytes are not characters: only long ones are counted."""
        for index in np.flatnonzero(np.diff(starts) > MAX_LINE).tolist():
            start, end = int(starts[index]), int(starts[index + 1])
            # Four bytes make a character at most.
            if len(decoded(self._bytes(start, min(end, start + 4 * MAX_LINE + 4)))) > MAX_LINE:
                raise ProgramError(
                    phrase("the line is longer than {max_line} characters", max_line=MAX_LINE),
                    index + 1,
                    self._content.file,
                )
