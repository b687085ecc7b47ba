"""How long a move is: what speeds along the path are measured in.

Which axes are measured is what a feed counts along, see ``feedway``.

Rule 1: which axes count is seen from the way before it is rounded to steps, so that a slow axis in
        small pieces does not change the meaning of a feed from one piece to the next.
Rule 2: a way is never taken to be shorter than ``LEAST_MM`` for each step of an axis that follows:
        speeds along next to no path, while another axis makes thousands of steps, are no numbers to
        calculate with. Only feeds below ``LEAST_MM`` times the rate of that axis notice.
"""

from collections.abc import Sequence
from typing import Final

from fraese.feedway import Group, counted, length_of
from fraese.machine import Steps

LEAST_MM: Final = 1e-4

Way = Sequence[float]


def path_length_mm(
    groups: Sequence[Group], steps: Steps, steps_mm: Way, way_mm: Way | None = None
) -> float:
    """Length of a move of at least one step, along the axes that count.

    Args:
        groups: from ``feedway.groups_of``.
        steps: signed, per axis.
        steps_mm: their way.
        way_mm: the same before rounding; None: as the steps say.
    """
    group, wanted_mm = counted(groups, steps_mm if way_mm is None else way_mm)
    if group:
        # Where all axes count, rounding evens out; where others follow, it would not.
        length_mm = length_of(group, steps_mm) if len(groups) == 1 else wanted_mm
        return _not_too_short(length_mm or wanted_mm, group, steps)
    # Less than nothing was wanted, and it made a step all the same.
    return max([length_of(group, steps_mm) for group in groups])


def _not_too_short(length_mm: float, group: Group, steps: Steps) -> float:
    followers = [abs(n) for motor, n in enumerate(steps) if motor not in group]
    return max(length_mm, LEAST_MM * max(followers, default=0))
