r"""A straight way over a height map, in the fewest straight pieces that keep to the surface.

    height  |      ,--o--.                cut where the way crosses a line of the grid,
            |   ,-'       '--.            and between, where the surface is a parabola;
            |  o . . . . . . . o . . o    then joined again as long as no cut is further off
            +--|-----|---------|-----|--> part of the way, 0 to 1

Rule 1: half of the tolerance is for the parabolas, half for what is joined: together a piece is
        nowhere further from the surface than the tolerance.
Rule 2: over a plane, however tilted, a way is one piece.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence

from fraese.heightmap.heights import Flat, HeightMap

#: Cuts that are no further apart are one.
_SAME_PART = 1e-9

#: Part of the way that is done, and the height there.
Knot = tuple[float, float]


def knots(heights: HeightMap, start: Flat, end: Flat, tolerance_mm: float) -> list[Knot]:
    """Ends of the pieces; the last one is the end of the way.

    Args:
        heights: the map.
        start: where the way begins, in coordinates of the map.
        end: where it ends.
        tolerance_mm: between them a straight line is no further from the surface than this.
    """
    half_mm = tolerance_mm / 2
    (x, y), (to_x, to_y) = start, end
    way_x, way_y = to_x - x, to_y - y
    first = heights.at(x, y)
    if not way_x and not way_y:
        return [(1.0, first)]
    samples: list[Knot] = [(0.0, first)]
    before, low = 0.0, first
    for cut in (*_cuts(heights, start, end), 1.0):
        high = heights.at(x + way_x * cut, y + way_y * cut)
        middle = (before + cut) / 2
        # The surface is a parabola there: in its middle it is furthest from the chord.
        off_mm = abs(heights.at(x + way_x * middle, y + way_y * middle) - (low + high) / 2)
        count = math.ceil(math.sqrt(off_mm / half_mm)) if off_mm > half_mm else 1
        for n in range(1, count):
            part = before + (cut - before) * n / count
            samples.append((part, heights.at(x + way_x * part, y + way_y * part)))
        samples.append((cut, high))
        before, low = cut, high
    return _joined(samples, half_mm)


def _cuts(heights: HeightMap, start: Flat, end: Flat) -> list[float]:
    """Parts of the way at which it crosses a line of the grid, ascending."""
    found: list[float] = []
    for lines, at, to in (
        (heights.x_mm, start[0], end[0]),
        (heights.y_mm, start[1], end[1]),
    ):
        if at != to:
            found += _crossings(lines, at, to)
    found.sort()
    cuts: list[float] = []
    for part in found:
        if part - (cuts[-1] if cuts else 0.0) > _SAME_PART and part < 1 - _SAME_PART:
            cuts.append(part)
    return cuts


def _crossings(lines: Sequence[float], at: float, to: float) -> Iterator[float]:
    first, last = bisect_right(lines, min(at, to)), bisect_left(lines, max(at, to))
    for line in lines[first:last]:
        yield (line - at) / (to - at)


def _joined(samples: Sequence[Knot], off_mm: float) -> list[Knot]:
    """As few of them as there can be: each piece goes on while the samples are near enough."""
    result: list[Knot] = []
    part, height = samples[0]
    least, most = -math.inf, math.inf
    last = samples[0]
    for sample in samples[1:]:
        slope = (sample[1] - height) / (sample[0] - part)
        if not least <= slope <= most:
            result.append(last)
            part, height = last
            least, most = -math.inf, math.inf
        way = sample[0] - part
        rise = sample[1] - height
        least, most = max(least, (rise - off_mm) / way), min(most, (rise + off_mm) / way)
        last = sample
    result.append(last)
    return result
