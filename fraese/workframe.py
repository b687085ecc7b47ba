"""One frame: from the coordinates of the work to those of the machine, and back.

    machine = turned(work + G92) + offset of the system + tool offset

The turn (G10 L2 R) is about Z, counter-clockwise. Lengths in mm, angles and rotary axes in degrees.

Rule 1: whoever shows, asks for or computes work coordinates does it here; nowhere else are they
        made out.
Rule 2: what outlives a program are numbered parameters of the language (RS-274/NGC); which is
        which stands here too. Of a table of nine, the place is that of the axis in ``LETTERS``.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from operator import add, sub
from typing import Final

Point = tuple[float, ...]

#: All axes of the language, in the order of its tables.
LETTERS: Final = "xyzabcuvw"
#: Names of the systems; the first has number 1.
SYSTEMS: Final = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")

G28_HOME: Final = 5161
G30_HOME: Final = 5181
G92_ACTIVE: Final = 5210
G92_OFFSET: Final = 5211
ACTIVE_SYSTEM: Final = 5220
FIRST_SYSTEM: Final = 5221
SYSTEM_STRIDE: Final = 20
#: Behind the nine offsets of a system.
ROTATION: Final = 9
TOOL_NUMBER: Final = 5400
#: A program finds its tool's offsets of the tool table here; kept is the one in force.
TOOL_OFFSET: Final = 5401
#: Homes, G92, the systems, the tool and its offset.
PERSISTENT: Final = (
    *range(5161, 5170),
    *range(5181, 5190),
    *range(5210, 5391),
    *range(TOOL_NUMBER, TOOL_OFFSET + len(LETTERS)),
)

#: Beyond the numbers of the language: with this added, that of a place which was set while nobody
#: knew where its axis was.
UNSURE: Final = 10_000
#: And from here on, tools as programs have changed them.
TOOLS: Final = 20_000

#: Cosine and sine of 0, 90, 180 and 270 degrees.
_RIGHT_ANGLES: Final = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))

Kept = Mapping[int, float]


def numbers(first: int, axes: str) -> tuple[int, ...]:
    """Where a table that begins at ``first`` keeps these axes."""
    return tuple(first + LETTERS.index(letter) for letter in axes)


def stored(kept: Kept, first: int, axes: str) -> Point:
    """What a table holds for these axes; never set means 0."""
    return tuple(kept.get(number, 0.0) for number in numbers(first, axes))


def first_of_system(system: int) -> int:
    """Where the table of a system begins; 1 is G54."""
    return FIRST_SYSTEM + (system - 1) * SYSTEM_STRIDE


def places(axes: str) -> dict[int, str]:
    """Numbers of all that is a place of the machine along these axes: homes, G92, the systems."""
    systems = (first_of_system(number) for number in range(1, len(SYSTEMS) + 1))
    tables = (G28_HOME, G30_HOME, G92_OFFSET, *systems)
    return {
        number: letter
        for first in tables
        for number, letter in zip(numbers(first, axes), axes, strict=True)
    }


def place_name(number: int) -> str:
    """What such a number belongs to: G54, G92, G28."""
    if number >= FIRST_SYSTEM:
        return SYSTEMS[(number - FIRST_SYSTEM) // SYSTEM_STRIDE]
    return "G92" if number >= G92_OFFSET else "G30" if number >= G30_HOME else "G28"


@dataclass(frozen=True, slots=True)
class WorkFrame:
    """Where the work lies; all points are in the order of ``axes``.

    Attributes:
        axes: letters, in machine order.
        offset: of the system in force.
        g92: shift by G92 and G52.
        tool: offset of the tool.
        rotation_deg: of X and Y about Z.
        system: number of the system in force, 1 is G54.
    """

    axes: str
    offset: Point
    g92: Point
    tool: Point
    rotation_deg: float = 0.0
    system: int = 1
    # The sum of all offsets that are not turned with X and Y.
    _shift: Point = field(init=False, repr=False, compare=False)
    _is_shifted: bool = field(init=False, repr=False, compare=False)
    _add: Callable[[Point, Point], Point] = field(init=False, repr=False, compare=False)
    # Index of X and of Y, cosine and sine; None: nothing is turned.
    _turn: tuple[int, int, float, float] | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        turn = None
        shift = _sum(self.offset, self.tool)
        if self.rotation_deg and "x" in self.axes and "y" in self.axes:
            at = self.axes.index("x"), self.axes.index("y")
            turn = *at, *_cosine_and_sine(self.rotation_deg)
        else:
            shift = _sum(shift, self.g92)
        object.__setattr__(self, "_shift", shift)
        object.__setattr__(self, "_is_shifted", turn is not None or any(shift))
        object.__setattr__(self, "_add", _SUMS.get(len(self.axes), _sum))
        object.__setattr__(self, "_turn", turn)

    @classmethod
    def of(cls, kept: Kept, axes: str, system: int = 0) -> "WorkFrame":
        """What persistent parameters say.

        Args:
            kept: by number.
            axes: letters, in machine order.
            system: 1 to 9; 0: the one in force.
        """
        system = system or min(len(SYSTEMS), max(1, int(kept.get(ACTIVE_SYSTEM, 1))))
        first = first_of_system(system)
        nothing = (0.0,) * len(axes)
        return cls(
            axes=axes,
            offset=stored(kept, first, axes),
            g92=stored(kept, G92_OFFSET, axes) if kept.get(G92_ACTIVE) else nothing,
            tool=stored(kept, TOOL_OFFSET, axes),
            rotation_deg=kept.get(first + ROTATION, 0.0),
            system=system,
        )

    # --- both ways -----------------------------------------------------------------------------

    def to_machine(self, work: Point) -> Point:
        """Work coordinates as machine coordinates."""
        if not self._is_shifted:
            return work
        if self._turn is not None:
            work = self.turned(_sum(work, self.g92))
        return self._add(work, self._shift)

    def to_work(self, machine: Point) -> Point:
        """Machine coordinates as work coordinates."""
        if not self._is_shifted:
            return machine
        work = _difference(machine, self._shift)
        if self._turn is not None:
            work = _difference(self.turned(work, -1.0), self.g92)
        return work

    def turned(self, way: Point, sense: float = 1.0) -> Point:
        """A way along the work's axes as one along the machine's; ``sense`` -1: the other way."""
        if self._turn is None:
            return way
        x, y, cosine, sine = self._turn
        sine *= sense
        result = list(way)
        # A product with an exact 0 may be -0; with +0 added it is not.
        result[x] = way[x] * cosine - way[y] * sine + 0.0
        result[y] = way[x] * sine + way[y] * cosine + 0.0
        return tuple(result)

    # --- facts ---------------------------------------------------------------------------------

    @property
    def origin(self) -> Point:
        """Where the work zero lies, in machine coordinates."""
        return self.to_machine((0.0,) * len(self.axes))

    @property
    def is_rotated(self) -> bool:
        """X and Y of the work are not those of the machine."""
        return self._turn is not None

    def moved_with(self, letters: Iterable[str]) -> frozenset[str]:
        """Machine axes that work coordinates of these letters move: turned, X and Y go together."""
        given = frozenset(letters)
        return given | {"x", "y"} if self.is_rotated and given & {"x", "y"} else given

    def offset_for(self, machine: Point, work: Point) -> Point:
        """The offset of the system with which a machine position reads as this, all else kept."""
        turned = self.turned(_sum(work, self.g92))
        return _difference(_difference(machine, self.tool), turned)


def _sum(a: Point, b: Point) -> Point:
    return tuple(map(add, a, b))


def _cosine_and_sine(angle_deg: float) -> tuple[float, float]:
    """Exact for right angles, which are what work is mostly turned by."""
    quarters = angle_deg / 90
    if quarters.is_integer():
        return _RIGHT_ANGLES[int(quarters) % 4]
    angle = math.radians(angle_deg)
    return math.cos(angle), math.sin(angle)


def _difference(a: Point, b: Point) -> Point:
    return tuple(map(sub, a, b))


def _sum_of_three(a: Point, b: Point) -> Point:
    x, y, z = a
    by_x, by_y, by_z = b
    return x + by_x, y + by_y, z + by_z


#: The same for so many axes; every line of a program is added up once.
_SUMS: Final[dict[int, Callable[[Point, Point], Point]]] = {
    1: lambda a, b: (a[0] + b[0],),
    2: lambda a, b: (a[0] + b[0], a[1] + b[1]),
    3: _sum_of_three,
    4: lambda a, b: (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]),
}
