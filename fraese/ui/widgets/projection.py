"""From millimetres in space to dots on the screen: from where it is looked at, and how near."""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_COS: Final = math.cos(math.radians(30))
_SIN: Final = math.sin(math.radians(30))


@dataclass(frozen=True)
class Side:
    """From where it is looked at.

    Attributes:
        name: for people.
        across: what X, Y and Z add to the right,
        up: and upwards.
    """

    name: str
    across: tuple[float, float, float]
    up: tuple[float, float, float]


XY: Final = Side("XY", (1, 0, 0), (0, 1, 0))
XZ: Final = Side("XZ", (1, 0, 0), (0, 0, 1))
YZ: Final = Side("YZ", (0, 1, 0), (0, 0, 1))
ISO: Final = Side("XYZ", (_COS, -_COS, 0), (_SIN, _SIN, 1))
#: In the order in which they follow each other.
SIDES: Final = (XY, ISO, XZ, YZ)
#: A zoom further in or out shows nothing.
_ZOOMS: Final = (0.2, 500.0)


@dataclass(frozen=True)
class Projection:
    """How space lies on a field of dots.

    Attributes:
        side: from where it is looked at.
        columns: dots of the field,
        rows: likewise.
        centre: what lies in its middle, mm to the right and upwards.
        per_mm: dots, when all is seen.
        zoom: so much nearer.
    """

    side: Side
    columns: int
    rows: int
    centre: tuple[float, float] = (0.0, 0.0)
    per_mm: float = 1.0
    zoom: float = 1.0

    @property
    def dots_per_mm(self) -> float:
        """As it is seen."""
        return self.per_mm * self.zoom

    def flat(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3) points in mm, as (n, 2) mm to the right and upwards."""
        basis = np.array((self.side.across, self.side.up), np.float64)
        flat: NDArray[np.float64] = np.asarray(points, np.float64).reshape(-1, 3) @ basis.T
        return flat

    def dots(self, points: ArrayLike) -> NDArray[np.float64]:
        """(n, 3) points in mm, as (n, 2) columns and rows of dots."""
        moved = (self.flat(points) - self.centre) * (self.dots_per_mm, -self.dots_per_mm)
        dots: NDArray[np.float64] = np.add(moved, (self.columns / 2, self.rows / 2))
        return dots

    def fitted(self, points: ArrayLike) -> "Projection":
        """All of these points are seen, with a little room round them."""
        flat = self.flat(points)
        if not len(flat):
            return self
        low, high = flat.min(axis=0), flat.max(axis=0)
        wide, tall = np.maximum(high - low, 1e-3)
        per_mm = float(min((self.columns - 4) / wide, (self.rows - 4) / tall))
        middle = (low + high) / 2
        centre = (float(middle[0]), float(middle[1]))
        return replace(self, centre=centre, per_mm=min(max(per_mm, 1e-4), 100.0), zoom=1.0)

    def panned(self, columns: float, rows: float) -> "Projection":
        """Moved by so many dots to the right and downwards."""
        x, y = self.centre
        scale = self.dots_per_mm
        return replace(self, centre=(x + columns / scale, y - rows / scale))

    def zoomed(
        self, factor: float, column: float | None = None, row: float | None = None
    ) -> "Projection":
        """Nearer or further away; what lies at a dot stays there, else the middle does."""
        low, high = _ZOOMS
        zoom = min(max(self.zoom * factor, low), high)
        if column is None or row is None:
            return replace(self, zoom=zoom)
        right, down = column - self.columns / 2, row - self.rows / 2
        there = self.panned(right, down)
        return replace(there, zoom=zoom).panned(-right, -down)


def box_edges(low: tuple[float, ...], high: tuple[float, ...]) -> NDArray[np.float64]:
    """The twelve edges of a box, (12, 2, 3)."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    bounds = (low, high)
    edges = [
        (a, b)
        for i, a in enumerate(corners)
        for b in corners[i + 1 :]
        if sum(p != q for p, q in zip(a, b, strict=True)) == 1
    ]
    return np.array(
        [[[bounds[c][axis] for axis, c in enumerate(corner)] for corner in edge] for edge in edges],
        np.float64,
    )


def round_length_mm(per_mm: float, most: float) -> float:
    """The longest of 1, 2 and 5 with zeros that takes at most so many dots."""
    length = most / per_mm
    power = 10.0 ** math.floor(math.log10(length))
    return max(n * power for n in (1.0, 2.0, 5.0) if n * power <= length)
