"""Axis words as people type them, on the command line and in the app: X10, y-2,5, Z 3 F300.

Rule 1: which letters there are is the machine's affair. A decimal comma means the same as a point.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from fraese.errors import UsageError
from fraese.phrases import phrase

_WORD: Final = re.compile(
    r"([a-z])\s*=?\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+))(?![.,]*\d)\s*", re.IGNORECASE
)
_FEED: Final = "f"
#: A remark, or a comma between digits.
_COMMA: Final = re.compile(r"(\([^)]*\)?|;.*)|(?<=\d),(?=\d)")


@dataclass(frozen=True, slots=True)
class Target:
    """Where to go, by axis name, in mm or degrees, and how fast; None: as the caller thinks."""

    targets_mm: dict[str, float]
    feed_mm_min: float | None = None


def target(text: str, axes: Sequence[str]) -> Target:
    """Read axis words, and F with the feed.

    Args:
        text: letters with numbers; a letter may stand apart from its number.
        axes: names that there are.

    Raises:
        UsageError: naming the word, and what would be right.
    """
    values = _values(text.strip(), axes, feed=True)
    feed_mm_min = values.pop(_FEED, None)
    if feed_mm_min is not None and not feed_mm_min > 0:
        raise UsageError(
            phrase(
                "F is the feed and must be above 0, not {feed_mm_min:g}.", feed_mm_min=feed_mm_min
            )
        )
    if not values:
        raise UsageError(
            phrase(
                "Give at least one axis with its position, such as {example}.",
                example=_example(axes),
            )
        )
    return Target(values, feed_mm_min)


def axis_words(text: str, axes: Sequence[str]) -> dict[str, float]:
    """The same without a feed: values by axis name.

    Raises:
        UsageError: naming the word, and what would be right.
    """
    values = _values(text.strip(), axes, feed=False)
    if not values:
        raise UsageError(
            phrase(
                "Give at least one axis with its number, such as {example}.", example=_example(axes)
            )
        )
    return values


def axes_named(words: Sequence[str], axes: Sequence[str]) -> list[str]:
    """Axis names from words such as ["Z", "xy"], each once.

    Raises:
        UsageError: naming what is not an axis.
    """
    names: list[str] = []
    for letter in "".join(words).lower():
        if letter not in axes:
            raise UsageError(no_axis(letter, axes))
        if letter not in names:
            names.append(letter)
    return names


def no_axis(name: str, axes: Sequence[str]) -> str:
    """The sentence for a letter that names no axis."""
    return phrase(
        "There is no axis {name}; this machine has {listed}.",
        name=name.upper(),
        listed=listed(axes),
    )


def listed(axes: Sequence[str]) -> str:
    """Axis names in words: X, Y and Z."""
    *others, last = (name.upper() for name in axes)
    return phrase("{others} and {last}", others=", ".join(others), last=last) if others else last


def with_points(line: str) -> str:
    """A typed line of G-code with its decimal commas made points; remarks stay as they are."""
    return _COMMA.sub(lambda found: found[1] or ".", line)


def _values(text: str, axes: Sequence[str], *, feed: bool) -> dict[str, float]:
    values: dict[str, float] = {}
    at = 0
    while at < len(text):
        match = _WORD.match(text, at)
        if match is None:
            raise UsageError(
                phrase(
                    '"{text}" is not a letter with a number, such as {example}.',
                    text=text[at:].split()[0],
                    example=_example(axes),
                )
            )
        name, number, at = match[1].lower(), float(match[2].replace(",", ".")), match.end()
        if name not in axes and not (feed and name == _FEED):
            raise UsageError(no_axis(name, axes))
        if name in values:
            raise UsageError(
                phrase("{name} is given twice: give each letter once.", name=name.upper())
            )
        if not math.isfinite(number):
            raise UsageError(phrase('"{match}": the number is too large.', match=match[0].strip()))
        values[name] = number
    return values


def _example(axes: Sequence[str]) -> str:
    return " ".join(
        f"{name.upper()}{number}" for name, number in zip(axes, (10, -2.5), strict=False)
    )
