"""What a feed counts along, for the language and the planner alike.

As in LinuxCNC: along X, Y and Z if any of them moves; else along U, V and W; else along A, B and
C. What moves besides follows, and is done at the same time.

Rule 1: less than ``NO_WAY`` is no move. Sums of decimal words leave such remains behind, and a
        meaning must not hang on them.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Final

_sqrt = math.sqrt

#: Axes that are measured together; the first group that moves counts.
GROUPS: Final = ("xyz", "uvw", "abc")
#: In mm or degrees (LinuxCNC: emccanon, ``tiny``).
NO_WAY: Final = 1e-7

#: Places of axes that are measured together.
Group = tuple[int, ...]


def groups_of(names: Iterable[str]) -> tuple[Group, ...]:
    """Places of the axes that are measured together, in the order of ``GROUPS``.

    Args:
        names: letters, in machine order.
    """
    letters = tuple(names)
    groups = (tuple(at for at, name in enumerate(letters) if name in group) for group in GROUPS)
    return tuple(group for group in groups if group)


def length_of(group: Group, way: Sequence[float]) -> float:
    """Length of a way, as seen by one group."""
    squares = 0.0
    for at in group:
        part = way[at]
        squares += part * part
    return _sqrt(squares)


def counted(groups: Iterable[Group], way: Sequence[float]) -> tuple[Group, float]:
    """The group that counts, and the length that it sees; no group and 0 if nothing moves."""
    for group in groups:
        length = length_of(group, way)
        if length > NO_WAY:
            return group, length
    return (), 0.0
