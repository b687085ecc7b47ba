"""Where the work lies for panel and commands: what a program left, or what holds while it runs.

Rule 1: the parameters are those of the language, so that panel and program share one set.
Rule 2: while a program runs the interpreter is ahead of the motors: what is in force where they
        are is asked of whoever follows it (``follow``).
Rule 3: what others read is replaced whole, so that it may be read from any thread.
"""

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from typing import Final

from fraese.workframe import (
    TOOL_NUMBER,
    Point,
    WorkFrame,
    first_of_system,
    numbers,
)

#: So many zeros can be undone.
_MOST_UNDONE: Final = 20
#: Persistent parameters and the frame in force with them.
InForce = tuple[Mapping[int, float], WorkFrame]


class WorkOffsets:
    """The persistent parameters of the language, and the frame that they make.

    Args:
        axes: letters, in machine order.
    """

    def __init__(self, axes: str) -> None:
        self._axes = axes
        self._kept: InForce = {}, WorkFrame.of({}, axes)
        self._followed: Callable[[], InForce] | None = None
        # Before and after each zero that was set; the last one is undone first.
        self._zeros: deque[tuple[dict[int, float], dict[int, float]]] = deque(maxlen=_MOST_UNDONE)
        self._put: Callable[[Mapping[int, float]], object] = self.replace

    def replace(self, parameters: Mapping[int, float]) -> None:
        """Take up what a program left, or what was kept."""
        self._followed, self._put = None, self.replace
        self._kept = dict(parameters), WorkFrame.of(parameters, self._axes)

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
        self._zeros.append((before, after))
        self._put(after)

    def undo_zero(self) -> bool:
        """As it was before the last zero was set; False: nothing was, or more has changed since."""
        if not self._zeros or self._zeros[-1][1] != self.parameters:
            self._zeros.clear()
            return False
        self._put(self._zeros.pop()[0])
        return True
