"""A program of many short moves, as CAM programs write them: a curve that closes."""

import math
from pathlib import Path
from typing import Final

LINES: Final = 5_000
#: Where it ends, work coordinates.
END_MM: Final = (60.0, 30.0, 0.0)
_FEED_MM_MIN: Final = 900
_HEAD: Final = ("G21 G90 G17", "G0 X60 Y30", f"G1 Z0 F{_FEED_MM_MIN}")


def lines(count: int = LINES) -> list[str]:
    """So many lines of G-code."""
    moves = count - len(_HEAD)
    said = list(_HEAD)
    for n in range(1, moves + 1):
        turn = 2 * math.pi * n / moves
        x = 30 + 30 * math.cos(4 * turn)
        y = 30 + 20 * math.sin(6 * turn)
        said.append(f"G1 X{x:.3f} Y{y:.3f}")
    return said


def write(path: Path, count: int = LINES) -> Path:
    """The same as a file."""
    path.write_text("\n".join(lines(count)) + "\n", "ascii")
    return path
