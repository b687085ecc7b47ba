"""How long a move is: what a feed counts along, and what speeds along the path are measured in.

As in LinuxCNC: a feed is along X, Y and Z if any of them moves; else along U, V and W; else along
A, B and C, in degrees. What moves besides follows, and is done at the same time.

Rule 1: which axes count is seen from the way before it is rounded to steps, so that a slow axis in
        small pieces does not change the meaning of a feed from one piece to the next.
Rule 2: a way is never taken to be shorter than ``LEAST_MM`` for each step of an axis that follows:
        speeds along next to no path, while another axis makes thousands of steps, are no numbers to
        calculate with. Only feeds below ``LEAST_MM`` times the rate of that axis notice.
"""

import math
from collections.abc import Sequence
from typing import Final

from fraese.machine import Machine, Steps

_sqrt = math.sqrt

#: Axes that are measured together, the first group that moves counts.
GROUPS: Final = ("xyz", "uvw", "abc")
#: Less is no move (LinuxCNC: emccanon, ``tiny``).
_NOTHING_MM: Final = 1e-7
LEAST_MM: Final = 1e-4

Way = Sequence[float]


def groups_of(machine: Machine) -> tuple[tuple[int, ...], ...]:
    """Motor numbers of the axes that are measured together, in the order of ``GROUPS``."""
    names = machine.names
    groups = (tuple(m for m, name in enumerate(names) if name in group) for group in GROUPS)
    return tuple(group for group in groups if group)


def length_of(group: Sequence[int], way_mm: Way) -> float:
    """Length of a way, as seen by one group."""
    squares = 0.0
    for motor in group:
        part_mm = way_mm[motor]
        squares += part_mm * part_mm
    return _sqrt(squares)


def path_length_mm(
    groups: Sequence[Sequence[int]], steps: Steps, steps_mm: Way, way_mm: Way | None = None
) -> float:
    """Length of a move of at least one step, along the axes that count.

    Args:
        groups: from ``groups_of``.
        steps: signed, per axis.
        steps_mm: their way.
        way_mm: the same before rounding; None: as the steps say.
    """
    for group in groups:
        wanted_mm = length_of(group, steps_mm if way_mm is None else way_mm)
        if wanted_mm > _NOTHING_MM:
            # Where all axes count, rounding evens out; where others follow, it would not.
            length_mm = length_of(group, steps_mm) if len(groups) == 1 else wanted_mm
            return _not_too_short(length_mm or wanted_mm, group, steps)
    # Less than nothing was wanted, and it made a step all the same.
    return max([length_of(group, steps_mm) for group in groups])


def _not_too_short(length_mm: float, group: Sequence[int], steps: Steps) -> float:
    followers = [abs(n) for motor, n in enumerate(steps) if motor not in group]
    return max(length_mm, LEAST_MM * max(followers, default=0))
