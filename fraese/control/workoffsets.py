"""Where the work lies for panel and commands: what a program left, or what holds while it runs.

Rule 1: the parameters are those of the language, so that panel and program share one set.
Rule 2: while a program runs the interpreter is ahead of the motors: what is in force where they
        are is asked of whoever follows it (``follow``).
Rule 3: a place that is set while nobody knows where its axis is, is right on the table, and not in
        numbers: the reference run gives the axis other ones, and carries the place along. What was
        set when the axis was referenced is not moved: it is right again.
Rule 4: what others read is replaced whole, so that it may be read from any thread.
"""

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from fraese.workframe import (
    G92_OFFSET,
    TOOL_NUMBER,
    UNSURE,
    Point,
    WorkFrame,
    first_of_system,
    numbers,
    place_name,
    places,
)

#: So many zeros can be undone.
_MOST_UNDONE: Final = 20
#: Persistent parameters and the frame in force with them.
InForce = tuple[Mapping[int, float], WorkFrame]
_Zero = tuple[dict[int, float], dict[int, float], frozenset[int]]


class WorkOffsets:
    """The persistent parameters of the language, and the frame that they make.

    Args:
        axes: letters, in machine order.
        referenced: which of them are, in this order.
    """

    def __init__(self, axes: str, referenced: Callable[[], Sequence[bool]]) -> None:
        self._axes = axes
        self._referenced = referenced
        self._places = places(axes)
        # Numbers of places that are right on the table only.
        self._unsure: frozenset[int] = frozenset()
        self._kept: InForce = {}, WorkFrame.of({}, axes)
        self._followed: Callable[[], InForce] | None = None
        # Before and after each zero that was set, and what was unsure before; the last one is
        # undone first.
        self._zeros: deque[_Zero] = deque(maxlen=_MOST_UNDONE)
        self._put: Callable[[Mapping[int, float]], object] = self.replace

    def replace(self, parameters: Mapping[int, float]) -> None:
        """Take up what a program or a command left."""
        self._mark(parameters)
        self._take(parameters)

    def _take(self, parameters: Mapping[int, float]) -> None:
        self._followed, self._put = None, self.replace
        self._kept = dict(parameters), WorkFrame.of(parameters, self._axes)

    def take_up(self, kept: Mapping[int, float]) -> None:
        """Go on with what was kept."""
        marks = {UNSURE + number: number for number in self._places}
        self._unsure = frozenset(marks[number] for number in kept if number in marks)
        self._take({number: value for number, value in kept.items() if number not in marks})

    def kept(self) -> dict[int, float]:
        """What is to be kept, for ``take_up``."""
        self._mark(self._in_force()[0])
        return {**self.parameters, **dict.fromkeys((UNSURE + n for n in self._unsure), 1.0)}

    def _mark(self, parameters: Mapping[int, float], also: Iterable[int] = ()) -> None:
        """Places that are set now: of an axis that is not referenced they are unsure."""
        before = self._kept[0]
        new = {n for n in self._places if before.get(n) != parameters.get(n)}.union(also)
        if new:
            known = dict(zip(self._axes, self._referenced(), strict=True))
            sure = {number for number in new if known[self._places[number]]}
            self._unsure = self._unsure - sure | (new - sure)

    def carry(self, letter: str, way_mm: float) -> tuple[str, ...]:
        """An axis has got other numbers: places that are unsure stay where they are on the table.

        Args:
            letter: of the axis, which is referenced now.
            way_mm: what was added to its position.

        Returns:
            What was carried along, by name.
        """
        mine = {number for number in self._unsure if self._places[number] == letter}
        self._unsure -= mine
        if not mine:
            return ()
        parameters, frame = self.parameters, self.frame
        axis = self._axes.index(letter)
        shifts = set(numbers(G92_OFFSET, self._axes)) & mine
        for number in mine - shifts:
            parameters[number] += way_mm
        # A shift lies on top of its system: with that it is carried already.
        if shifts and numbers(first_of_system(frame.system), self._axes)[axis] not in mine:
            way = frame.turned(tuple(way_mm * (n == axis) for n in range(len(self._axes))), -1.0)
            for number, more in zip(numbers(G92_OFFSET, self._axes), way, strict=True):
                parameters[number] = parameters.get(number, 0.0) + more
        self._zeros.clear()
        self._take(parameters)
        return tuple(dict.fromkeys(place_name(number) for number in sorted(mine)))

    def follow(
        self,
        in_force: Callable[[], InForce],
        put: Callable[[Mapping[int, float]], object],
    ) -> None:
        """A program runs: ask there, from any thread, until ``replace``.

        Args:
            in_force: what holds where the motors are.
            put: told what a person changes while the program waits for him.
        """
        self._followed, self._put = in_force, put

    def _in_force(self) -> InForce:
        followed = self._followed
        return self._kept if followed is None else followed()

    @property
    def parameters(self) -> dict[int, float]:
        """By number."""
        return dict(self._in_force()[0])

    @property
    def frame(self) -> WorkFrame:
        """Where the work lies."""
        return self._in_force()[1]

    @property
    def tool(self) -> int:
        """Number of the tool in the spindle; 0: none, or not known."""
        return int(self._in_force()[0].get(TOOL_NUMBER, 0.0))

    def set_zero(self, axes: Iterable[str], machine_mm: Point, work_mm: float) -> None:
        """Let a machine position have this work coordinate on some axes, in the active system.

        As G10 L20 has it: of a rotated system both X and Y are stored anew, so that the other one
        still reads as before.
        """
        frame = self.frame
        wanted = [
            work_mm if letter in axes else old
            for letter, old in zip(self._axes, frame.to_work(machine_mm), strict=True)
        ]
        offset = frame.offset_for(machine_mm, tuple(wanted))
        places = numbers(first_of_system(frame.system), self._axes)
        moved = frame.moved_with(axes)
        changes = {
            place: value
            for place, value, letter in zip(places, offset, self._axes, strict=True)
            if letter in moved
        }
        before = self.parameters
        after = {**before, **changes}
        self._zeros.append((before, after, self._unsure))
        self._mark(after, also=changes)
        self._put(after)

    def undo_zero(self) -> bool:
        """As it was before the last zero was set; False: nothing was, or more has changed since."""
        if not self._zeros or self._zeros[-1][1] != self.parameters:
            self._zeros.clear()
            return False
        before, _, unsure = self._zeros.pop()
        self._put(before)
        self._unsure = unsure
        return True
