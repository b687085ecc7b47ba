"""Centres of arcs, in the two axes of their plane, in mm.

The closing rule is LinuxCNC's, found by bisection on its rs274: the radii at start and end may
differ by 0.02 mm times the root of 2 (in G20: 0.002 inch times the root of 2), beyond that by a
thousandth of the radius, and never by more than a hundred times the first limit. A radius is one
from 0.00005 inch on.
"""

import math
from typing import Final

from fraese.errors import ProgramError
from fraese.phrases import phrase

Flat = tuple[float, float]

# For G21 and G20: the difference that is always accepted, and the one never accepted.
CLOSED_MM: Final = {1.0: 0.02 * math.sqrt(2), 25.4: 25.4 * 0.002 * math.sqrt(2)}
OPEN_FACTOR: Final = 100.0
RELATIVE: Final = 1e-3
# Radii below this are none; a radius may fall short of half the distance by this.
NOTHING_MM: Final = 0.00127
# Points closer than this differ by rounding only.
SAME_MM: Final = 1e-10


def centre_by_radius(start: Flat, end: Flat, radius_mm: float, left: bool) -> Flat:
    """Centre of the arc of this radius; a negative radius takes the longer way round.

    Args:
        start: first point.
        end: last point.
        radius_mm: the R word.
        left: counter-clockwise.

    Raises:
        ProgramError: the points coincide, or are too far apart for the radius.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    half_mm = math.hypot(dx, dy) / 2
    if half_mm < SAME_MM:
        raise ProgramError(
            phrase("an arc with R cannot end where it starts; give the centre by I, J or K instead")
        )
    if half_mm - abs(radius_mm) > NOTHING_MM:
        raise ProgramError(
            phrase(
                "radius {radius_mm:.4f} mm is too small: the end is {half_mm:.4f} mm away",
                radius_mm=abs(radius_mm),
                half_mm=2 * half_mm,
            )
        )
    height_mm = math.sqrt(max(0.0, radius_mm**2 - half_mm**2))
    # The centre of the shorter arc lies to the left of the chord if it turns left.
    side = 1 if left == (radius_mm > 0) else -1
    scale = side * height_mm / (2 * half_mm)
    return (start[0] + end[0]) / 2 - dy * scale, (start[1] + end[1]) / 2 + dx * scale


def check_centre(start: Flat, end: Flat, centre: Flat, unit: float) -> None:
    """See that an arc closes; ``unit`` is one unit of the program in mm.

    Raises:
        ProgramError: the radius is nothing, or differs too much between start and end.
    """
    first_mm = math.dist(start, centre)
    last_mm = math.dist(end, centre)
    if min(first_mm, last_mm) < NOTHING_MM:
        raise ProgramError(phrase("the arc has no radius: its centre lies on its start or its end"))
    error_mm = abs(first_mm - last_mm)
    closed_mm = CLOSED_MM[unit]
    relative = error_mm / max(first_mm, last_mm)
    if error_mm > closed_mm * OPEN_FACTOR or (error_mm > closed_mm and relative > RELATIVE):
        raise ProgramError(
            phrase(
                "the arc does not close: its radius is {first_mm:.4f} mm at the start and"
                " {last_mm:.4f} mm at the end",
                first_mm=first_mm,
                last_mm=last_mm,
            )
        )


def length_mm(start: Flat, end: Flat, centre: Flat, turns: int, rise_mm: float) -> float:
    """Length of the way along an arc or helix, for inverse time feeds."""
    first = math.atan2(start[1] - centre[1], start[0] - centre[0])
    last = math.atan2(end[1] - centre[1], end[0] - centre[0])
    part = (last - first) * (1 if turns > 0 else -1) % (2 * math.pi)
    if part < 1e-12:
        part = 2 * math.pi
    angle = part + (abs(turns) - 1) * 2 * math.pi
    return math.hypot(angle * math.dist(start, centre), rise_mm)
