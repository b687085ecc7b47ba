"""A histogram in plain text: bars of block characters, as long as the logarithm of the count.

        0.1 to 0.2 us  ██████████████████████  19843
        0.2 to 0.3 us  █████████                  41
               longer  █                           1

One edge of a hundred thousand must be seen as well as all the others: hence the logarithm.
"""

import math
from collections.abc import Sequence
from typing import Final

from fraese.phrases import spoken

_EIGHTHS: Final = " ▏▎▍▌▋▊▉█"
_FULL: Final = "█"


def bar(count: int, most: int, width: int) -> str:
    """A bar for one count.

    Args:
        count: how many.
        most: the count whose bar is full.
        width: of a full bar, characters.
    """
    if count <= 0:
        return ""
    # One is seen: a bar of nothing is for nothing.
    share = math.log10(count * 10) / math.log10(max(most, 1) * 10)
    eighths = max(1, round(share * width * 8))
    return _FULL * (eighths // 8) + _EIGHTHS[eighths % 8].strip()


def histogram(
    edges: Sequence[float], columns: Sequence[tuple[str, Sequence[int]]], unit: str, width: int
) -> list[str]:
    """Lines of a histogram, one column of bars for each series.

    Args:
        edges: of the bins, one more than counts; the last may be infinite.
        columns: name and counts of each series.
        unit: of the edges.
        width: of a full bar, characters.
    """
    used = [i for i in range(len(edges) - 1) if any(counts[i] for _, counts in columns)]
    if not used:
        return []
    most = max(max(counts) for _, counts in columns)
    digits = len(str(most))
    labels = [_label(edges[i], edges[i + 1], unit) for i in range(used[0], used[-1] + 1)]
    room = max(map(len, labels))
    head = "  ".join(f"{name:<{width + 1 + digits}}" for name, _ in columns)
    lines = [f"{'':{room}}  {head}".rstrip()]
    for label, i in zip(labels, range(used[0], used[-1] + 1), strict=True):
        cells = (
            f"{bar(counts[i], most, width):<{width}} {counts[i] or '':>{digits}}"
            for _, counts in columns
        )
        lines.append(f"{label:>{room}}  {'  '.join(cells)}".rstrip())
    return lines


def _label(low: float, high: float, unit: str) -> str:
    if math.isinf(high):
        return spoken("from {low:g} {unit}", low=low, unit=unit)
    return spoken("{low:g} to {high:g} {unit}", low=low, high=high, unit=unit)
