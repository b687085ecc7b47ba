"""The header of a VCD file: unit of time, and lines."""

import re
from collections import Counter
from dataclasses import dataclass
from typing import BinaryIO, Final, NamedTuple

from fraese.errors import TraceError
from fraese.phrases import phrase

#: No header is as long.
_MOST_BYTES: Final = 1 << 22
_END: Final = re.compile(rb"\$enddefinitions\s+\$end(?=\s|$)")
_UNITS_S: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "ps": 1e-12, "fs": 1e-15}
_TIMESCALE: Final = re.compile(r"(1|10|100)\s*([munpf]?s)")
_LEAST_WORDS: Final = 4
_NUMERIC: Final = frozenset(("real", "realtime", "shortreal"))


class Line(NamedTuple):
    """A line, or a quantity.

    Attributes:
        name: as people call it, and no other line of the file.
        code: that stands for it in the body.
        is_bit: it is high or low; else it is a number.
    """

    name: str
    code: bytes
    is_bit: bool


@dataclass(frozen=True)
class Header:
    """What stands in front of the body.

    Attributes:
        lines: in order.
        unit_s: unit of time, s.
        body_at: offset of the body.
    """

    lines: tuple[Line, ...]
    unit_s: float
    body_at: int


def read_header(file: BinaryIO, name: str) -> Header:
    """Read it.

    Raises:
        TraceError: if it is none, with its line.
    """
    head = file.read(_MOST_BYTES)
    found = _END.search(head)
    if not head.strip():
        raise TraceError(
            phrase(
                "{name}: the file is empty; a VCD file begins with $timescale and $var.", name=name
            )
        )
    # sigrok-cli may say something of its own in front of it.
    if (b"$var" not in head and b"$timescale" not in head) or found is None:
        raise TraceError(
            phrase(
                "{name}, line 1: this is no VCD file; it begins with a header that ends with"
                " $enddefinitions $end.",
                name=name,
            )
        )
    return _Parts(head[: found.start()], name).header(found.end())


class _Parts:
    """Sections of a header, ``$word ... $end``."""

    def __init__(self, head: bytes, name: str) -> None:
        self._name = name
        self._head = head
        self._unit_s = 1e-9
        self._scopes: list[str] = []
        self._found: list[tuple[str, str, bytes, bool]] = []

    def header(self, body_at: int) -> Header:
        for section in re.finditer(rb"\$(\w+)\s(.*?)\$end(?=\s|$)", self._head, re.DOTALL):
            words = section[2].decode("utf-8", "replace").split()
            if section[1] == b"timescale":
                self._unit_s = self._timescale(words, section.start())
            elif section[1] == b"scope":
                self._scopes.append(words[-1] if words else "")
            elif section[1] == b"upscope" and self._scopes:
                self._scopes.pop()
            elif section[1] == b"var":
                self._var(words, section.start())
        if not self._found:
            raise TraceError(phrase("{name}: the header names no line ($var).", name=self._name))
        return Header(self._lines(), self._unit_s, body_at)

    def _timescale(self, words: list[str], at: int) -> float:
        found = _TIMESCALE.fullmatch("".join(words))
        if not found:
            raise TraceError(
                phrase(
                    "{place}: $timescale {words} is none; it is as in 1 ns.",
                    place=self._place(at),
                    words=" ".join(words),
                )
            )
        return int(found[1]) * _UNITS_S[found[2]]

    def _var(self, words: list[str], at: int) -> None:
        if len(words) < _LEAST_WORDS or not words[1].isdigit():
            raise TraceError(
                phrase(
                    "{place}: $var {words} is none; it is as in $var wire 1 ! clock $end.",
                    place=self._place(at),
                    words=" ".join(words),
                )
            )
        kind, size, code, *name = words
        is_bit = size == "1" and kind not in _NUMERIC
        self._found.append((".".join(self._scopes), "".join(name), code.encode(), is_bit))

    def _place(self, at: int) -> str:
        return f"{self._name}, line {self._head.count(b'%c' % 10, 0, at) + 1}"

    def _lines(self) -> tuple[Line, ...]:
        """One for each code: what is named twice is one line all the same."""
        by_code: dict[bytes, tuple[str, str, bool]] = {}
        for scope, name, code, bit in self._found:
            by_code.setdefault(code, (scope, name, bit))
        often = Counter(name for _, name, _ in by_code.values())
        seen: Counter[str] = Counter()
        lines = []
        for code, (scope, name, bit) in by_code.items():
            full = f"{scope}.{name}" if often[name] > 1 and scope else name
            seen[full] += 1
            lines.append(Line(full if seen[full] == 1 else f"{full}~{seen[full]}", code, bit))
        return tuple(lines)
