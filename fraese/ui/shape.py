"""What the machine has: which axes, in which units, and how its smallest step is called."""

from dataclasses import dataclass

from fraese.control.controller import Controller


@dataclass(frozen=True, slots=True)
class AxisShape:
    """One axis as it is shown.

    Attributes:
        name: lower case.
        unit: "mm", or "°" where it turns.
        step: the smallest step, in its unit.
        has_switches: an end switch at both ends.
    """

    name: str
    unit: str
    step: float
    has_switches: bool = True

    @property
    def letter(self) -> str:
        """For people."""
        return self.name.upper()

    @property
    def turns(self) -> bool:
        """Counts degrees."""
        return self.unit != "mm"

    def with_unit(self, number: str) -> str:
        """A number with its unit: 5 mm, 90°."""
        return f"{number}{self.unit}" if self.turns else f"{number} {self.unit}"


@dataclass(frozen=True, slots=True)
class Shape:
    """The machine as it is shown.

    Attributes:
        axes: in the order of all tuples of the machine's state.
        step_word: what one step is called ("half-step").
    """

    axes: tuple[AxisShape, ...]
    step_word: str

    @property
    def names(self) -> tuple[str, ...]:
        """Of the axes."""
        return tuple(axis.name for axis in self.axes)

    @property
    def names_with_switches(self) -> tuple[str, ...]:
        """Of the axes that can be referenced."""
        return tuple(axis.name for axis in self.axes if axis.has_switches)

    @property
    def ends(self) -> tuple[str, ...]:
        """Names of the end switches: "xmin", "xmax" ..."""
        return tuple(name + end for name in self.names_with_switches for end in ("min", "max"))

    @property
    def units(self) -> tuple[str, ...]:
        """Each unit once, millimetres first."""
        return tuple(sorted({axis.unit for axis in self.axes}, key="mm°".find))


def shape_of(controller: Controller) -> Shape:
    """The shape of a controller's machine."""
    axes = tuple(
        AxisShape(axis.name, axis.unit, axis.step_mm, axis.has_switches)
        for axis in controller.machine.axes
    )
    return Shape(axes, controller.step_word)
