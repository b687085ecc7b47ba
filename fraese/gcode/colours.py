"""What the parts of a line are, for whoever colours it: the language's own view of a text.

Rule 1: comments and words are cut as ``words.py`` cuts them; only that blanks stay where they are.
Rule 2: nothing is refused. What the language would not know as a word is ``wrong``.
"""

import re
from enum import Enum
from typing import Final

from fraese.gcode.axes import ALL
from fraese.gcode.words import LETTERS


class Part(Enum):
    """What a part of a line is."""

    PLAIN = "plain"
    COMMENT = "comment"
    #: G, and the motions that it commands.
    CODE = "code"
    #: M.
    SWITCH = "switch"
    AXIS = "axis"
    #: F, S, T and the other letters with a number.
    WORD = "word"
    #: N and O words, block delete.
    FLOW = "flow"
    #: Parameters and expressions.
    VALUE = "value"
    WRONG = "wrong"


_PIECE: Final = re.compile(
    r"""
    (?P<comment>\([^)]*\)?|;.*)
    |(?P<flow>^\s*/|^\s*%\s*$|[nN]\s*\d+(?:\.\d*)?
        |[oO]\s*(?:<[^>]*>|\d+|\#\S+)(?:\s*[a-zA-Z]+)?
        |^\s*[mM]\s*9[89](?!\d))
    |(?P<word>[a-zA-Z@^$]\s*(?:[-+]?\s*[\d.][\d.\s]*(?<!\s))?)
    |(?P<value>\#[\#\s]*(?:<[^>]*>|\d+)?|[\[\]=*/+\-,]|[\d.]+)
    |(?P<blank>\s+)
    |(?P<wrong>.)
    """,
    re.VERBOSE,
)
_FUNCTION: Final = re.compile(r"[a-zA-Z]{2,6}(?=\s*\[)|(?<=[\s\]])[a-zA-Z]{2,3}(?=[\s\[#])")
_OTHER: Final = LETTERS | frozenset("nos")


def parts_of(text: str) -> list[tuple[Part, str]]:
    """The parts of a line in order; joined they are the line."""
    found: list[tuple[Part, str]] = []
    at, depth = 0, 0
    while at < len(text):
        function = _FUNCTION.match(text, at)
        if function is not None and depth:
            found.append((Part.VALUE, function[0]))
            at = function.end()
            continue
        match = _PIECE.match(text, at)
        assert match is not None
        piece, kind = match[0], match.lastgroup
        depth += piece.count("[") - piece.count("]") if kind == "value" else 0
        found.append((_part(kind or "", piece), piece))
        at = match.end()
    return found


def _part(kind: str, piece: str) -> Part:
    if kind == "word":
        letter = piece[0].lower()
        if letter in "gm":
            return Part.CODE if letter == "g" else Part.SWITCH
        if letter in ALL:
            return Part.AXIS
        return Part.WORD if letter in _OTHER else Part.WRONG
    return {
        "comment": Part.COMMENT,
        "flow": Part.FLOW,
        "value": Part.VALUE,
        "wrong": Part.WRONG,
    }.get(kind, Part.PLAIN)
