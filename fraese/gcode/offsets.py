"""Coordinates: from the program's position to the machine's, and the codes that shift them.

    machine = rotate(program + G92) + work offset + tool offset

All in mm. The rotation (G10 L2 R) turns about Z. The offsets live in the numbered
parameters, as a file may look at them and they outlive the program; what is in force is
copied here, so that a parameter written by hand acts when its system is next selected.
"""

import math
from typing import Final

from fraese.gcode.canon import Point
from fraese.gcode.parameters import Parameters

ORIGIN: Final[Point] = (0.0, 0.0, 0.0)
ACTIVE_SYSTEM: Final = 5220
FIRST_SYSTEM: Final = 5221
SYSTEM_STRIDE: Final = 20
ROTATION: Final = 9
G92_ACTIVE: Final = 5210
G92_OFFSET: Final = 5211
HOME: Final = {280: 5161, 281: 5161, 300: 5181, 301: 5181}


class Coordinates:
    """Offsets in force; ``shift`` is their sum where there is no rotation."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self.system = 1
        self.work: Point = ORIGIN
        self.rotation_deg = 0.0
        self.g92: Point = ORIGIN
        self.tool: Point = ORIGIN
        self.shift: Point = ORIGIN
        if parameters.get(G92_ACTIVE):
            self.g92 = self.read(G92_OFFSET)
        self.select(min(9, max(1, int(parameters.get(ACTIVE_SYSTEM)))))

    def read(self, first: int) -> Point:
        """Three parameters as a point."""
        get = self._parameters.get
        return get(first), get(first + 1), get(first + 2)

    def write(self, first: int, point: Point) -> None:
        """A point into three parameters."""
        for index, value in enumerate(point, start=first):
            self._parameters.set(index, value)

    def first_parameter(self, system: int) -> int:
        """The parameter where a system (1 is G54) keeps its X."""
        return FIRST_SYSTEM + (system - 1) * SYSTEM_STRIDE

    def select(self, system: int) -> None:
        """Put a system into force, 1 to 9."""
        self.system = system
        self._parameters.set(ACTIVE_SYSTEM, float(system))
        first = self.first_parameter(system)
        self.work = self.read(first)
        self.rotation_deg = self._parameters.get(first + ROTATION)
        self.update()

    def update(self) -> None:
        """Sum the offsets up again after one of them was set."""
        self.shift = _sum(self.work, self.tool)
        if not self.rotation_deg:
            self.shift = _sum(self.shift, self.g92)

    def to_machine(self, point: Point) -> Point:
        """Program position to machine position."""
        if self.rotation_deg:
            point = _turn(_sum(point, self.g92), self.rotation_deg)
        x, y, z = point
        dx, dy, dz = self.shift
        return x + dx, y + dy, z + dz

    def to_program(self, point: Point) -> Point:
        """Machine position to program position."""
        point = _difference(point, self.shift)
        if self.rotation_deg:
            point = _difference(_turn(point, -self.rotation_deg), self.g92)
        return point

    def set_g92(self, point: Point, active: bool, keep: bool = False) -> None:
        """Set G92 offsets; ``keep`` leaves the stored numbers alone."""
        self.g92 = point
        if not keep:
            self.write(G92_OFFSET, point)
        self._parameters.set(G92_ACTIVE, float(active))
        self.update()

    def set_system(self, system: int, values: dict[int, float], rotation: float | None) -> None:
        """Store offsets of a system by axis, and its rotation, and use them if it is active."""
        first = self.first_parameter(system)
        for axis, value in values.items():
            self._parameters.set(first + axis, value)
        if rotation is not None:
            self._parameters.set(first + ROTATION, rotation)
        if system == self.system:
            self.select(system)

    def offset_at(
        self, system: int, machine: Point, wanted: Point, given: set[int]
    ) -> dict[int, float]:
        """Work offsets that make a machine position read as ``wanted`` on the given axes.

        With a rotation both X and Y change as soon as one of them is given.
        """
        rotation_deg = self._parameters.get(self.first_parameter(system) + ROTATION)
        if rotation_deg and given & {0, 1}:
            given = given | {0, 1}
        turned = _turn(_sum(wanted, self.g92), rotation_deg)
        offset = _difference(_difference(machine, self.tool), turned)
        return {axis: offset[axis] for axis in given}

    def tool_offset_at(
        self, machine: Point, wanted: dict[int, float], old: Point, fixture: int = 0
    ) -> Point:
        """The tool offset with which a machine position reads as ``wanted``, by axis.

        Measured in the active system with G92, or in that of a fixture without. Axes that are
        not given keep the old offset, as seen in that system.
        """
        work, g92, rotation_deg = self.work, self.g92, self.rotation_deg
        if fixture:
            first = self.first_parameter(fixture)
            work, g92 = self.read(first), ORIGIN
            rotation_deg = self._parameters.get(first + ROTATION)
        here = _difference(_turn(_difference(machine, work), -rotation_deg), g92)
        x, y, z = (
            at - wanted[axis] if axis in wanted else kept
            for axis, (at, kept) in enumerate(zip(here, _turn(old, -rotation_deg), strict=True))
        )
        return _turn((x, y, z), rotation_deg)


def _turn(point: Point, angle_deg: float) -> Point:
    if not angle_deg:
        return point
    angle = math.radians(angle_deg)
    sine, cosine = math.sin(angle), math.cos(angle)
    x, y, z = point
    return x * cosine - y * sine, x * sine + y * cosine, z


def _sum(a: Point, b: Point) -> Point:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _difference(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]
