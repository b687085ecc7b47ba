"""Text that is no G-code: what was seen, and what is wanted.

Looked at only when a line was refused, so none of this costs a good line anything. The line is
seen as it was written, with its blanks: they tell ``X1e-05`` from ``X1 E-05``.
"""

import re
from collections.abc import Callable
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode import expressions
from fraese.phrases import phrase

_REMARKS: Final = re.compile(r"\([^()]*\)?|;.*")
_BRACKETS: Final = re.compile(r"\[.*\]|(?<=[#oO])<[^<>]*>")
#: Nobody means a number of this size, mm.
_NO_PLACE: Final = 1e9
_EXPONENT: Final = re.compile(
    r"(?<![0-9.])(?:[0-9]+\.?[0-9]*|\.[0-9]+)e[-+]?[0-9]+(?![0-9.])", re.IGNORECASE
)
_EXTRUDER: Final = re.compile(r"(?<![a-z])e\s*[-+]?[0-9.]", re.IGNORECASE)
_COMMA: Final = re.compile(r"[0-9],[0-9]")
_REMARK: Final = re.compile(r"//|#\s*(?![0-9#<\[\s])|--\s|#\s")
_LIST: Final = re.compile(r"[-+]?[0-9.]+(?:[\s,;]+[-+]?[0-9.]+)+\s*")
# How other controls branch, and what only a sender says to its controller.
_BRANCH: Final = re.compile(r"(?:if|while|goto|end)(?![a-z])", re.IGNORECASE)
_GRBL: Final = re.compile(r"\$(?!\s*[-+0-9.#\[])")
_RUN: Final = re.compile(r"[^\W\d_]{2,}")
#: Letters that may stand together: functions, and what is said of O-words and conditions.
_KNOWN: Final = frozenset(expressions.FUNCTIONS) | {"atan", "exists", "mod"}
_FIRST: Final = frozenset("#@^$/%([")
_SHOWN: Final = 24


def explained(line: str, error: ProgramError) -> ProgramError:
    """The refusal of a line, in better words where the line is no G-code at all.

    Args:
        line: as it was written.
        error: what the reader made of it.
    """
    if "is refused:" in error.message:
        # A code with a reason of its own; what else stands on its line is its words.
        return error
    text = _BRACKETS.sub("0", _REMARKS.sub(" ", line)).strip()
    for look in _LOOKS:
        said = look(text)
        if said:
            return ProgramError(said, error.line, error.file)
    return error


def _other_controls(text: str) -> str:
    if _BRANCH.match(text):
        return phrase("IF, WHILE, GOTO and END are not known without O: o<name> if [...]")
    if _GRBL.match(text):
        return phrase("'$' without a number is a command to grbl, not a line of a program")
    if text.startswith("%"):
        return phrase("'%' stands alone on its line, before the program and behind it")
    return ""


def _exponent(text: str) -> str:
    found = _EXPONENT.search(text)
    if found is None:
        return ""
    value = float(found.group())
    if abs(value) >= _NO_PLACE:
        return phrase(
            "{group} is a number with an exponent, which the language has not, and larger than any"
            " place",
            group=repr(found.group()),
        )
    written = f"{value:.6f}".rstrip("0").rstrip(".")
    return phrase(
        "{group} is a number with an exponent, which the language has not; write it out: {written}",
        group=repr(found.group()),
        written=written,
    )


def _extruder(text: str) -> str:
    if not _EXTRUDER.search(text):
        return ""
    return phrase("E is the extruder of a 3D printer; a program for a mill has no E word")


def _comma(text: str) -> str:
    found = _COMMA.search(text)
    return (
        "" if found is None else phrase("there is a comma in a number; write a point, as in X0.5")
    )


def _remark(text: str) -> str:
    if not _REMARK.search(text):
        return ""
    return phrase("a remark stands in brackets, (like this), or behind a semicolon")


def _list(text: str) -> str:
    if not _LIST.fullmatch(text):
        return ""
    return phrase(
        "there are numbers without letters; a list of points is a file whose name ends"
        " in .csv, .tsv, .xyz or .pts"
    )


def _prose(text: str) -> str:
    strange = [run for run in _RUN.finditer(text) if not _is_code(run.group())]
    first = text[:1]
    is_letter = first.isascii() and (first.isalnum() or first in _FIRST)
    if first and (not is_letter or (strange and strange[0].start() == 0)):
        return phrase(
            "{short} is no G-code; a line is words such as G1 X10 F200, and a remark"
            " stands in brackets or behind a semicolon",
            short=repr(_short(text)),
        )
    if strange:
        return phrase(
            "{short} is no word of G-code; a word is one letter and a number, as X10",
            short=repr(_short(strange[0].group())),
        )
    return ""


def _is_code(run: str) -> bool:
    """A function, perhaps behind the letter of its word."""
    run = run.lower()
    return run in _KNOWN or run[1:] in _KNOWN


def _short(text: str) -> str:
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "..."


_LOOKS: Final[tuple[Callable[[str], str], ...]] = (
    _other_controls, _exponent, _list, _remark, _comma, _prose, _extruder,
)  # fmt: skip
