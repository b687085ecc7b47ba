"""Encoded lines (PE): moves in few characters.

value   a number, its sign in the lowest bit, in digits from the lowest on; the last one differs
8 bits  base 64: 63 to 126, the last 191 to 254        7 bits  base 32: 63 to 94, 95 to 126
flags   :n pen   < next move without drawing   >n bits behind the point   = next place absolute   7
"""

from collections.abc import Iterator
from typing import Final, NamedTuple

_FIRST: Final = 63
#: First code of a last digit, by base.
_LAST: Final = {64: 191, 32: 95}
_MOST_BITS: Final = 60


class Move(NamedTuple):
    """A move of the pen.

    Attributes:
        x: in the unit of the plotter,
        y: likewise.
        draws: with the pen down.
        absolute: a place, not a way.
    """

    x: float
    y: float
    draws: bool
    absolute: bool


def moves(text: str) -> Iterator[Move]:
    """The moves of an encoded line; never raises, and ends where it makes no sense."""
    values = _Values(text)
    draws, absolute = True, False
    while (flag := values.flag()) is not None:
        if flag == "<":
            draws = False
        elif flag == "=":
            absolute = True
        elif flag == "7":
            values.base = 32
        elif flag in (":", ">"):
            number = values.value()
            if number is None:
                return
            if flag == ">":
                values.point = min(max(int(number), -_MOST_BITS), _MOST_BITS)
        else:
            x, y = values.value(scaled=True), values.value(scaled=True)
            if x is None or y is None:
                return
            yield Move(x, y, draws, absolute)
            draws, absolute = True, False


class _Values:
    """The characters of a line, one after the other."""

    def __init__(self, text: str) -> None:
        self._codes = [ord(each) for each in text if not each.isspace()]
        self._at = 0
        self.base = 64
        self.point = 0

    def flag(self) -> str | None:
        """The flag that stands here, and is passed; empty: a value does; None: nothing."""
        if self._at >= len(self._codes):
            return None
        each = chr(self._codes[self._at])
        if each in "<=7:>":
            self._at += 1
            return each
        return ""

    def value(self, *, scaled: bool = False) -> float | None:
        """The number that stands here; None: there is no whole one."""
        total, weight = 0, 1
        last = _LAST[self.base]
        while self._at < len(self._codes):
            code = self._codes[self._at]
            self._at += 1
            if last <= code < last + self.base:
                total += (code - last) * weight
                number = -(total >> 1) if total & 1 else total >> 1
                return number / 2.0**self.point if scaled else float(number)
            if not _FIRST <= code < _FIRST + self.base or weight > 1 << _MOST_BITS:
                continue
            total += (code - _FIRST) * weight
            weight *= self.base
        return None
