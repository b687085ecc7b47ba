"""Axis words as people type them: X10, y-2.5, Z 3."""

import math
import re
from collections.abc import Sequence
from typing import Final

from fraese.config.axes import AXIS_NAMES
from fraese.errors import UsageError

_WORD: Final = re.compile(r"([a-z])\s*=?\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+))", re.IGNORECASE)


def axis_words(words: Sequence[str]) -> dict[str, float]:
    """Values in mm by axis name.

    Args:
        words: each an axis letter and a number; a letter may stand apart from its number.

    Raises:
        UsageError: naming the word, and what would be right.
    """
    text = " ".join(words).strip()
    values: dict[str, float] = {}
    at = 0
    while at < len(text):
        match = _WORD.match(text, at)
        if match is None:
            raise UsageError(f'"{text[at:]}": expected an axis and a number, as in X10 or Y-2.5.')
        name = match[1].lower()
        if name not in AXIS_NAMES:
            raise UsageError(f'"{match[0]}": there is no axis {match[1].upper()}; it is X, Y or Z.')
        if name in values:
            raise UsageError(f"{name.upper()} is given twice.")
        values[name] = float(match[2].replace(",", "."))
        if not math.isfinite(values[name]):
            raise UsageError(f'"{match[0]}": the number is too large.')
        at = match.end()
        while at < len(text) and text[at].isspace():
            at += 1
    if not values:
        raise UsageError("Say where to: an axis and a number, as in X10 or Y-2.5.")
    return values


def axes_named(words: Sequence[str]) -> list[str]:
    """Axis names from words such as ["Z", "xy"].

    Raises:
        UsageError: naming what is not an axis.
    """
    names: list[str] = []
    for letter in "".join(words).lower():
        if letter not in AXIS_NAMES:
            raise UsageError(f'"{letter}": there is no such axis; it is X, Y or Z.')
        if letter not in names:
            names.append(letter)
    return names
