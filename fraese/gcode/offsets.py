"""The work frame of a program, and the codes' way of changing it.

The offsets live in the numbered parameters, as a file may look at them and they outlive the
program; what is in force is the frame, so that a parameter written by hand acts when its system
is next selected.
"""

from collections.abc import Mapping
from dataclasses import replace

from fraese.gcode.parameters import Parameters
from fraese.workframe import (
    ACTIVE_SYSTEM,
    G28_HOME,
    G30_HOME,
    G92_ACTIVE,
    G92_OFFSET,
    LETTERS,
    ROTATION,
    TOOL_NUMBER,
    TOOL_OFFSET,
    Point,
    WorkFrame,
    first_of_system,
    numbers,
    stored,
)

#: Where the codes find their places.
HOMES = {280: G28_HOME, 281: G28_HOME, 300: G30_HOME, 301: G30_HOME}


class Coordinates:
    """What is in force, and the parameters behind it.

    Attributes:
        axes: letters, in machine order.
        frame: replaced whole at every change.
        nothing: the point at zero.
    """

    def __init__(self, parameters: Parameters, axes: str) -> None:
        self._parameters = parameters
        self.axes = axes
        self.nothing: Point = (0.0,) * len(axes)
        self.frame = WorkFrame.of(parameters.numbered, axes)
        parameters.set(ACTIVE_SYSTEM, float(self.frame.system))

    @property
    def kept(self) -> Mapping[int, float]:
        """All parameters, by number."""
        return self._parameters.numbered

    def keep(self, values: Mapping[int, float]) -> None:
        """What outlives the program, under numbers that are none of the language's."""
        for number, value in values.items():
            if value or number in self.kept:
                self._parameters.keep(number, value)

    def read(self, first: int) -> Point:
        """A table of parameters as a point."""
        return stored(self._parameters.numbered, first, self.axes)

    def write(self, first: int, point: Point) -> None:
        """A point into a table of parameters."""
        for number, value in zip(numbers(first, self.axes), point, strict=True):
            self._parameters.set(number, value)

    def of_system(self, system: int) -> WorkFrame:
        """The frame as it would be with a system as stored; the rest as in force."""
        stored = WorkFrame.of(self._parameters.numbered, self.axes, system)
        return replace(stored, g92=self.frame.g92, tool=self.frame.tool)

    def select(self, system: int) -> None:
        """Put a system into force, 1 to 9."""
        self._parameters.set(ACTIVE_SYSTEM, float(system))
        self.frame = self.of_system(system)

    def take_up(self, changed: Mapping[int, float]) -> None:
        """A person has changed these parameters; they are in force at once."""
        for number, value in changed.items():
            self._parameters.keep(number, value)
        if changed:
            self.select(self.frame.system)

    def read_anew(self) -> None:
        """Let what the parameters say be in force."""
        self.frame = WorkFrame.of(self._parameters.numbered, self.axes)
        self._parameters.set(ACTIVE_SYSTEM, float(self.frame.system))

    def set_g92(self, point: Point, active: bool, keep: bool = False) -> None:
        """Set G92 offsets; ``keep`` leaves the stored numbers alone."""
        if not keep:
            self.write(G92_OFFSET, point)
        self._parameters.set(G92_ACTIVE, float(active))
        self.frame = replace(self.frame, g92=point)

    def set_tool(self, offset: Point) -> None:
        """Put a tool offset into force; it outlives the program."""
        for number, value in zip(numbers(TOOL_OFFSET, self.axes), offset, strict=True):
            self._parameters.keep(number, value)
        self.frame = replace(self.frame, tool=offset)

    def set_tool_number(self, number: int) -> None:
        """Say which tool is in the spindle; it outlives the program."""
        self._parameters.keep(TOOL_NUMBER, float(number))

    def set_system(
        self, system: int, values: Mapping[str, float], rotation_deg: float | None
    ) -> None:
        """Store offsets of a system by axis, and its rotation, and use them if it is active."""
        first = first_of_system(system)
        for letter, value in values.items():
            self._parameters.set(first + LETTERS.index(letter), value)
        if rotation_deg is not None:
            self._parameters.set(first + ROTATION, rotation_deg)
        if system == self.frame.system:
            self.select(system)

    def tool_offset_at(
        self, machine: Point, wanted: Mapping[str, float], old: Point, fixture: int = 0
    ) -> Point:
        """The tool offset with which a machine position reads as ``wanted``, by axis.

        Measured in the active system with G92, or in that of a fixture without. Axes that are
        not given keep the old offset, as seen in that system.
        """
        frame = self.frame
        if fixture:
            frame = replace(self.of_system(fixture), g92=self.nothing)
        here = replace(frame, tool=self.nothing).to_work(machine)
        kept = frame.turned(old, -1.0)
        asked = tuple(
            here[axis] - wanted[letter] if letter in wanted else kept[axis]
            for axis, letter in enumerate(self.axes)
        )
        return frame.turned(asked)
