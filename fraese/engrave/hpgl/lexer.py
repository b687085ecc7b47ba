"""Bytes of a plotter file as commands.

    IN;SP1;PU100,200;PD300 400LBtext<ETX>PA  ->  IN  SP 1  PU 100 200  PD 300 400  LB text  PA

Rule 1: two letters are a command, numbers belong to the one before; nothing need end it.
Rule 2: labels and encoded lines have their own ends.
Rule 3: what is none of it is passed over, as plotters do.
"""

import re
from collections.abc import Iterator
from typing import Final, NamedTuple

_NAME: Final = re.compile(r"[A-Za-z]\s?[A-Za-z]")
_NUMBER: Final = re.compile(r"[\s,]*([+-]?(?:\d+\.?\d*|\.\d+))")
#: Commands of the device itself: ESC . and a letter, with numbers up to a colon; PCL; PJL.
_DEVICE: Final = re.compile(
    r"\x1b\.[ -~](?:[\d;]*:)?|\x1b%-12345X|\x1b[%&*(][^A-Z@]*[A-Z@]|\x1b.|@PJL[^\n]*", re.DOTALL
)
#: Where a label ends, unless DT says otherwise.
_ETX: Final = "\x03"
#: What takes one character, whatever it is.
_ONE: Final = ("DT", "SM")


class Command(NamedTuple):
    """A command of a plotter.

    Attributes:
        name: two capital letters.
        numbers: behind it.
        text: of a label or an encoded line; else empty.
        line: in which line of the file it stands, from 1.
    """

    name: str
    numbers: tuple[float, ...]
    text: str
    line: int


def commands(data: bytes) -> Iterator[Command]:
    """The commands of a file, in their order; never raises."""
    # One character a byte: encoded lines have bytes that are none of a text.
    text = data.decode("latin-1")
    at, line, seen, end_of_label = 0, 1, 0, _ETX
    while at < len(text):
        device = _DEVICE.match(text, at)
        if device is not None:
            at = device.end()
            continue
        found = _NAME.match(text, at)
        if found is None:
            at += 1
            continue
        line, seen = line + text.count("\n", seen, at), at
        name = (found[0][0] + found[0][-1]).upper()
        at = found.end()
        words = ""
        numbers: tuple[float, ...] = ()
        if name == "LB":
            words, at = _until(text, at, end_of_label)
        elif name == "PE":
            words, at = _until(text, at, ";")
        elif name in _ONE:
            words = text[at : at + 1]
            at += len(words)
            if name == "DT":
                end_of_label, at, words = _end_of_label(words, text, at)
        else:
            numbers, at = _numbers(text, at)
        yield Command(name, numbers, words, line)


def _until(text: str, at: int, end: str) -> tuple[str, int]:
    found = text.find(end, at)
    if found < 0:
        return text[at:], len(text)
    return text[at:found], found + len(end)


def _end_of_label(word: str, text: str, at: int) -> tuple[str, int, str]:
    """Of DT: a character; without one the usual one. Behind it may stand whether it is printed."""
    if word in ("", ";"):
        return _ETX, at, ""
    behind = re.compile(r",[01]").match(text, at)
    return word, behind.end() if behind else at, word


def _numbers(text: str, at: int) -> tuple[tuple[float, ...], int]:
    numbers = []
    while (found := _NUMBER.match(text, at)) is not None:
        numbers.append(float(found[1]))
        at = found.end()
    return tuple(numbers), at
