"""Times as people type and read them: ``1.5ms``, ``250 us``; seconds without a unit."""

import math
import re
from collections.abc import Mapping
from typing import Final

from fraese.errors import UsageError
from fraese.phrases import phrase

UNITS_S: Final[Mapping[str, float]] = {
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "µs": 1e-6,
    "μs": 1e-6,
    "ns": 1e-9,
    "min": 60.0,
    "": 1.0,
}
_TIME: Final = re.compile(r"([0-9]+\.?[0-9]*|\.[0-9]+)\s*([a-zµμ]*)", re.IGNORECASE)
_SHOWN: Final = ("s", "ms", "us", "ns")
#: Ticks of an axis are such multiples of a power of ten apart.
_ROUND: Final = (1, 2, 5, 10)


def seconds(text: str, option: str) -> float:
    """A time, in s.

    Args:
        text: as it was typed.
        option: what it belongs to, for the sentence.

    Raises:
        UsageError: if it is none.
    """
    found = _TIME.fullmatch(text.strip())
    unit = found[2].lower() if found else ""
    if not found or unit not in UNITS_S:
        raise UsageError(
            phrase(
                '{option} "{text}" is no time; it is a number with s, ms, us or ns.',
                option=option,
                text=text,
            )
        )
    return float(found[1]) * UNITS_S[unit]


def unit_of(length_s: float) -> str:
    """The unit in which a length has one to three digits before its point."""
    return next((unit for unit in _SHOWN if abs(length_s) >= 0.9999995 * UNITS_S[unit]), "ns")


def length(length_s: float | None) -> str:
    """A length of time in four digits, for people; None: a dash."""
    if length_s is None:
        return "-"
    if not length_s:
        return "0 s"
    unit = unit_of(length_s)
    return f"{length_s / UNITS_S[unit]:.4g} {unit}"


def moment(at_s: float | None) -> str:
    """A moment to the ns, as ``--around`` takes it; None: a dash."""
    if at_s is None:
        return "-"
    return f"{at_s:.9f}".rstrip("0").rstrip(".") + "s"


def rate(rate_hz: float | None) -> str:
    """A rate in four digits, for people; None: a dash."""
    if rate_hz is None:
        return "-"
    for factor, unit in ((1e6, "MHz"), (1e3, "kHz")):
        if rate_hz >= 0.99995 * factor:
            return f"{rate_hz / factor:.4g} {unit}"
    return f"{rate_hz:.4g} Hz"


def tick_s(span_s: float, most: int) -> float:
    """A round distance of an axis's ticks, so that there are at most so many."""
    least_s = span_s / max(1, most)
    power_s = 10.0 ** math.floor(math.log10(least_s))
    return next(factor * power_s for factor in _ROUND if factor * power_s >= 0.999999 * least_s)


def tick_word(number: int, tick_s: float, end_s: float) -> str:
    """The moment of a tick, in the unit of the axis's end if that takes few decimals."""
    unit = next(
        (unit for unit in _SHOWN if end_s >= UNITS_S[unit] and tick_s >= 0.999e-4 * UNITS_S[unit]),
        "ns",
    )
    return f"{number * tick_s / UNITS_S[unit]:.12g} {unit}"
