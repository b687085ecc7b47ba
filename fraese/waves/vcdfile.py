"""A VCD file, of whatever program and size, read in pieces.

    header: $timescale, $scope, $var ...     read once
    body:   #1200 1! 0" #1500 b101 # ...     read from where it is wanted, a megabyte at a time

Rule 1: words are what counts, not lines: some write a moment and its changes in one line. But a
        moment begins a line.
Rule 2: a stretch is found by halving, since time only grows; what the lines were there is looked
        for backwards, which is soon done where a file now and then says all its levels.
Rule 3: memory is that of a piece, whatever the length of the file.
Rule 4: what is wrong is told with its line. A last word that was cut off is left out: a program
        that writes may be killed.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fraese.errors import TraceError
from fraese.phrases import phrase, reason
from fraese.waves.header import Header, Line, read_header

PIECE_BYTES: Final = 1 << 20
_LOOK_BYTES: Final = 1 << 16
_MOMENT: Final = re.compile(rb"\n#([0-9]+)\s")
_WORD: Final = re.compile(rb"\S+")
_HASH: Final = ord("#")
_DOLLAR: Final = ord("$")
_SCALARS: Final = {
    **{ord(c): float(c) for c in "01"},
    **dict.fromkeys(b"xXzZuUwW-", float("nan")),
    **dict.fromkeys(b"lL", 0.0),
    **dict.fromkeys(b"hH", 1.0),
}
#: Sections of the body whose words are changes like all others.
_DUMPS: Final = frozenset((b"$dumpvars", b"$dumpall", b"$dumpon", b"$dumpoff", b"$end"))


class Changes(NamedTuple):
    """Changes of one line: moments in units of the file, and values; nan where it is not known."""

    at: NDArray[np.int64]
    values: NDArray[np.float64]


Piece = dict[int, Changes]


@dataclass
class _Reading:
    """Where the words of the body have led to so far."""

    levels: list[float | None]
    now: int = 0
    at: list[list[int]] = field(default_factory=list)
    values: list[list[float]] = field(default_factory=list)

    def clear(self) -> None:
        """Begin to gather a piece."""
        self.at = [[] for _ in self.levels]
        self.values = [[] for _ in self.levels]

    def piece(self) -> Piece:
        """What was gathered."""
        return {
            number: Changes(np.array(at, np.int64), np.array(self.values[number], np.float64))
            for number, at in enumerate(self.at)
            if at
        }


class _BadWordError(Exception):
    """Word of this number in the piece at hand, and what is wrong with it."""

    def __init__(self, number: int, why: str) -> None:
        super().__init__(why)
        self.number = number


class VcdFile:
    """A waveform file.

    Args:
        path: of the file.

    Attributes:
        path: as given.
        lines: what it has, in order.
        unit_s: its unit of time, s.
        end: its last moment, in such units.

    Raises:
        TraceError: if it cannot be read, or is none.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            with path.open("rb") as file:
                self._header: Header = read_header(file, str(path))
                self._size = file.seek(0, 2)
                self.begin, self.end = self._ends(file)
        except OSError as error:
            raise TraceError(
                phrase("{path}: cannot be read: {reason}.", path=path, reason=reason(error))
            ) from error
        self.lines: tuple[Line, ...] = self._header.lines
        self.unit_s = self._header.unit_s
        self._known = {
            bytes((sign,)) + line.code: (number, value)
            for number, line in enumerate(self.lines)
            for sign, value in _SCALARS.items()
        }
        self._numbers = {line.code: number for number, line in enumerate(self.lines)}

    def seconds(self, units: int) -> float:
        """Its unit of time as seconds, without the dust of binary fractions."""
        return round(units * self.unit_s, 15)

    def levels(self, at: int) -> list[float]:
        """What every line was just before a moment; nan where it is not known.

        Of the first moment: just after it, for it says only how things were.
        """
        at = max(at, self.begin + 1)
        levels: list[float | None] = [None] * len(self.lines)
        with self.path.open("rb") as file:
            stop = self._offset(file, at)
            self._finish_levels(file, stop, levels, at)
        return [float("nan") if level is None else level for level in levels]

    def pieces(self, start: int, end: int, levels: list[float]) -> Iterator[Piece]:
        """The changes within a stretch, both ends included.

        Args:
            start: first moment.
            end: last moment.
            levels: of all lines just before ``start``.

        Raises:
            TraceError: where the file is wrong, with its line.
        """
        reading = _Reading(list(levels))
        reading.clear()
        start = max(start, self.begin + 1)
        with self.path.open("rb") as file:
            at = self._offset(file, start)
            for position, words, is_last in self._words(file, at):
                try:
                    is_done = self._take(words, reading, start, end)
                except _BadWordError as bad:
                    if not (is_last and bad.number == len(words) - 1):
                        raise TraceError(self._told(file, position, bad)) from bad
                    is_done = True
                yield reading.piece()
                reading.clear()
                if is_done:
                    return

    # --- where -----------------------------------------------------------------------------------

    def _ends(self, file: BinaryIO) -> tuple[int, int]:
        """First and last moment of the body."""
        first = self._moment_after(file, self._header.body_at)
        if first is None:
            raise TraceError(
                phrase(
                    "{path}: nothing was recorded: no moment (#...) stands in it.", path=self.path
                )
            )
        back = _LOOK_BYTES
        while True:
            file.seek(max(self._header.body_at, self._size - back))
            found = [int(number) for number in _MOMENT.findall(file.read() + b"\n")]
            if found:
                # Of the last one digits may be missing.
                return first[0], max(found[-2:])
            back *= 4

    def _moment_after(self, file: BinaryIO, at: int) -> tuple[int, int] | None:
        """The first moment behind an offset, and its own offset; None: there is none."""
        rest = b""
        file.seek(at)
        while piece := file.read(_LOOK_BYTES):
            text = rest + piece
            if found := _MOMENT.search(text):
                return int(found[1]), at + found.start()
            rest = text[-64:]
            at += len(text) - len(rest)
        return None

    def _offset(self, file: BinaryIO, moment: int) -> int:
        """An offset before the changes of a moment, and not far before them."""
        low, high = self._header.body_at, self._size
        while high - low > PIECE_BYTES >> 2:
            middle = (low + high) // 2
            found = self._moment_after(file, middle)
            if found is not None and found[0] < moment:
                low = found[1]
            else:
                high = middle
        return low

    def _finish_levels(
        self, file: BinaryIO, stop: int, levels: list[float | None], before: int
    ) -> None:
        """Levels before a moment: forwards from ``stop``, what is missing backwards from it."""
        reading = _Reading([None] * len(levels))
        reading.clear()
        for _, words, _ in self._words(file, stop):
            if self._passed(words, reading, before):
                break
        levels[:] = reading.levels
        body_at = self._header.body_at
        while stop > body_at and None in levels:
            start = max(body_at, stop - PIECE_BYTES)
            file.seek(start)
            text = file.read(stop - start)
            if not self._names_one(text, levels):
                stop = start
                continue
            if start > body_at:
                # What comes before its first moment belongs to the piece before.
                cut = max(0, text.find(b"\n#"))
                text, start = text[cut:], start + cut
            reading = _Reading([None] * len(levels))
            reading.clear()
            self._passed(text.split(), reading, before)
            levels[:] = [
                earlier if level is None else level
                for level, earlier in zip(levels, reading.levels, strict=True)
            ]
            stop = start

    def _names_one(self, text: bytes, levels: list[float | None]) -> bool:
        """A piece may have a change of a line that is not known yet: looked for without reading."""
        missing = [x.code for x, level in zip(self.lines, levels, strict=True) if level is None]
        return any(code + space in text for code in missing for space in (b"\n", b" ", b"\r"))

    # --- words -----------------------------------------------------------------------------------

    def _words(self, file: BinaryIO, at: int) -> Iterator[tuple[int, list[bytes], bool]]:
        """Pieces of the body: their offset, their words, and whether the last word may be cut."""
        file.seek(at)
        rest = b""
        while piece := file.read(PIECE_BYTES):
            text = rest + piece
            # A moment begins every piece, so that a word and its code are never torn apart.
            cut = text.rfind(b"\n#")
            if cut <= 0:
                rest = text
                continue
            yield at, text[:cut].split(), False
            at += cut
            rest = text[cut:]
        yield at, rest.split(), not rest[-1:].isspace()

    def _passed(self, words: list[bytes], reading: _Reading, before: int) -> bool:
        """Levels only, up to a moment; True: it was reached. What is wrong is passed over."""
        known, levels = self._known, reading.levels
        ahead = iter(words)
        for word in ahead:
            hit = known.get(word)
            if hit is not None:
                levels[hit[0]] = hit[1]
            elif word[0] == _HASH and word[1:].isdigit():
                if int(word[1:]) >= before:
                    return True
            elif word[0] in b"bBrR":
                number = self._numbers.get(next(ahead, b""))
                value = _number(word)
                if number is not None and value is not None:
                    levels[number] = value
            elif word == b"$comment":
                _skip(ahead)
        return False

    def _take(self, words: list[bytes], reading: _Reading, start: int, end: int) -> bool:
        """Changes of a piece; True: the stretch is over.

        One function, with all it needs in locals: a long file has millions of words.
        """
        known, levels, now = self._known, reading.levels, reading.now
        at, values = reading.at, reading.values
        ahead = iter(words)
        for word in ahead:
            hit = known.get(word)
            if hit is None:
                if word[0] == _HASH:
                    later = int(word[1:]) if word[1:].isdigit() else -1
                    if later < now:
                        raise _BadWordError(_behind(words, ahead), _no_moment(later, now))
                    now = later
                    if now > end:
                        return True
                    continue
                hit = self._other(words, word, ahead)
                if hit is None:
                    continue
            number, value = hit
            level = levels[number]
            # Not a number is equal to nothing, not even itself.
            if level != value and now >= start and (value == value or level == level):
                levels[number] = value
                at[number].append(now)
                values[number].append(value)
        reading.now = now
        return False

    def _other(
        self, words: list[bytes], word: bytes, ahead: Iterator[bytes]
    ) -> tuple[int, float] | None:
        """A change of more than one bit, or something that is none."""
        if word in _DUMPS:
            return None
        if word[0] == _DOLLAR:
            _skip(ahead)
            return None
        if word[0] in b"bBrRsS":
            number = self._numbers.get(next(ahead, b""))
            value = float("nan") if word[0] in b"sS" else _number(word)
            if number is not None and value is not None:
                return number, value
        raise _BadWordError(
            _behind(words, ahead), phrase("is no change of a line that the header names")
        )

    def _told(self, file: BinaryIO, position: int, bad: _BadWordError) -> str:
        """A sentence about a bad word, with its line."""
        file.seek(position)
        text = file.read(4 * PIECE_BYTES)
        words = _WORD.finditer(text)
        found = next((word for number, word in enumerate(words) if number == bad.number), None)
        if found is None:
            return phrase("{path}: a word in its body {bad}.", path=self.path, bad=bad)
        file.seek(0)
        line = file.read(position).count(b"\n") + text[: found.start()].count(b"\n") + 1
        shown = found[0][:40].decode("ascii", "replace")
        return phrase(
            '{path}, line {line}: "{shown}" {bad}.', path=self.path, line=line, shown=shown, bad=bad
        )


def _behind(words: list[bytes], ahead: Iterator[bytes]) -> int:
    """Number of the word that was taken last."""
    return len(words) - 1 - sum(1 for _ in ahead)


def _no_moment(later: int, now: int) -> str:
    if later < 0:
        return phrase("is no moment: a number follows #")
    return phrase("is before #{now}: time cannot go back", now=now)


def _number(word: bytes) -> float | None:
    """The value of a vector or real; nan where a bit is not known, None for no number."""
    try:
        return float(int(word[1:], 2)) if word[0] in b"bB" else float(word[1:])
    except ValueError:
        return float("nan") if not word[1:].strip(b"01xXzZuUwW-") and word[1:] else None


def _skip(words: Iterator[bytes]) -> None:
    """Pass over a section."""
    for word in words:
        if word == b"$end":
            return
