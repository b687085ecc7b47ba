"""What is typed into "Go to": words such as ``X10 Y5 Z-1 F300``."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from fraese.errors import UsageError

_WORD: Final = re.compile(r"\s*([A-Za-z])\s*([+-]?(?:\d+\.?\d*|\.\d+))(?![\d.,])")


@dataclass(frozen=True, slots=True)
class Target:
    """Where to go, in mm by axis name, and how fast; None: as fast as the axes can."""

    targets_mm: dict[str, float]
    feed_mm_min: float | None


def parse_target(text: str, axes: Sequence[str]) -> Target:
    """Read a target.

    Raises:
        UsageError: one sentence that says which word is wrong and what would be right.
    """
    targets_mm: dict[str, float] = {}
    feed_mm_min: float | None = None
    at = 0
    while text[at:].strip():
        match = _WORD.match(text, at)
        if match is None:
            raise UsageError(_not_a_word(text[at:].split()[0]))
        letter, number = match[1].lower(), float(match[2])
        at = match.end()
        if letter in targets_mm or (letter == "f" and feed_mm_min is not None):
            raise UsageError(f"{letter.upper()} is given twice: give each letter once.")
        if letter == "f":
            feed_mm_min = _feed(number)
        elif letter in axes:
            targets_mm[letter] = number
        else:
            known = ", ".join(axis.upper() for axis in axes)
            raise UsageError(f"There is no axis {letter.upper()}: give {known} and F.")
    if not targets_mm:
        raise UsageError("Give at least one axis with its position, such as X10 Y5.")
    return Target(targets_mm, feed_mm_min)


def _feed(number: float) -> float:
    if number <= 0:
        raise UsageError(f"F is the feed in mm/min and must be above 0, not {number:g}.")
    return number


def _not_a_word(word: str) -> str:
    hint = " with a decimal point" if "," in word else ""
    return f'"{word}" is not a letter with a number{hint}, such as X10.5.'
