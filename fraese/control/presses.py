"""What was pressed on jog keys and has not begun, in the order in which it will be done.

    X+ X+ X+ Y- X-   -->   [ X: 3 ] [ Y: -1 ] [ X: -1 ]

Rule 1: presses of one axis in a row are one group; what is pressed both ways in it cancels out.
Rule 2: plain data: whoever shares it between threads has the lock.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from fraese.machine import Axis

#: Two ways that differ by less, in parts of a step, are the same.
_SAME_STEPS = 1e-6


@dataclass(frozen=True, slots=True)
class Press:
    """One press of a jog key: an axis, by so many steps or by so many mm (degrees)."""

    motor: int
    steps: int = 0
    mm: float = 0.0

    def way_steps(self, axis: Axis) -> float:
        """Signed, and not rounded."""
        return self.steps + self.mm / axis.step_mm

    def plus(self, other: "Press") -> "Press":
        """Both as one."""
        return replace(self, steps=self.steps + other.steps, mm=self.mm + other.mm)


@dataclass
class Group:
    """Presses of one axis, all in one direction; none: to where the axis is counted."""

    motor: int
    presses: list[Press] = field(default_factory=list)

    def add(self, press: Press, axis: Axis) -> None:
        """One more; the other way round it takes back what was pressed last."""
        while self.presses:
            last = self.presses[-1]
            if last.way_steps(axis) * press.way_steps(axis) > 0:
                break
            self.presses.pop()
            press = last.plus(press)
            way = press.way_steps(axis)
            if abs(way) < _SAME_STEPS:
                return
            if way * last.way_steps(axis) > 0:
                break
        self.presses.append(press)

    def sign(self, axis: Axis) -> int:
        """Which way it goes; 0: nowhere."""
        way = sum(press.way_steps(axis) for press in self.presses)
        return (way > 0) - (way < 0)


class Waiting:
    """Groups that have not begun.

    Args:
        axes: of the machine.
    """

    def __init__(self, axes: Sequence[Axis]) -> None:
        self._axes = axes
        self._groups: deque[Group] = deque()

    def __bool__(self) -> bool:
        return bool(self._groups)

    def add(self, press: Press) -> None:
        """At the end."""
        if not self._groups or self._groups[-1].motor != press.motor:
            self._groups.append(Group(press.motor))
        last = self._groups[-1]
        last.add(press, self._axes[press.motor])
        if not last.presses:
            self._groups.pop()

    def turn(self, motor: int) -> None:
        """The first group is one of this axis from now on, with nothing in it."""
        self._groups.appendleft(Group(motor))

    def add_first(self, press: Press) -> None:
        """To the first group, which is of that axis."""
        self._groups[0].add(press, self._axes[press.motor])

    def take(self) -> Group:
        """The first group; there is one."""
        return self._groups.popleft()

    def put_back(self, group: Group) -> None:
        """What of the first group could not be done with it."""
        if group.presses:
            self._groups.appendleft(group)

    def drop(self, motor: int, sign: int) -> int:
        """Leave out what goes this way on an axis; how many presses that were."""
        gone = [g for g in self._groups if g.motor == motor and g.sign(self._axes[motor]) == sign]
        self._groups = deque(group for group in self._groups if group not in gone)
        return sum(len(group.presses) for group in gone)

    def clear(self) -> None:
        """Leave out everything."""
        self._groups.clear()

    def first_way(self, axis: Axis) -> float:
        """Where the first group leads, in steps; it is one of this axis."""
        return sum(press.way_steps(axis) for press in self._groups[0].presses)

    def counts(self) -> Iterator[tuple[int, int]]:
        """Of each group its axis, and how many presses wait, signed."""
        for group in self._groups:
            if group.presses:
                yield group.motor, group.sign(self._axes[group.motor]) * len(group.presses)

    def of_axis(self, motor: int) -> list[Press]:
        """What waits of one axis."""
        return [press for g in self._groups if g.motor == motor for press in g.presses]
