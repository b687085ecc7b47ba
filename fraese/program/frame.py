"""Round what a program cuts, above the work."""

from typing import Final

from fraese.machine import Millimetres
from fraese.program.context import ProgramContext

#: Corners of a frame, low or high, for so many axes.
_ROUND: Final[dict[int, tuple[tuple[int, ...], ...]]] = {
    0: (),
    1: ((0,), (1,), (0,)),
    2: ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0)),
}


def frame_of(
    context: ProgramContext, low_mm: Millimetres, high_mm: Millimetres
) -> list[Millimetres]:
    """Round a box in X and Y at the safe height; all other axes stay where they are.

    Args:
        context: the machine as it stands.
        low_mm: corners of the box, machine coordinates.
        high_mm: likewise.
    """
    names, here = context.machine.names, context.start_mm
    height = context.safe_height()
    if height is not None and context.referenced[height.axis]:
        here = height.at_least(high_mm[height.axis]).at(here)
    flat = [names.index(letter) for letter in "xy" if letter in names]
    points = [here] if flat else []
    for corner in _ROUND[len(flat)]:
        point = list(here)
        for axis, is_high in zip(flat, corner, strict=True):
            point[axis] = (high_mm if is_high else low_mm)[axis]
        points.append(tuple(point))
    return points
