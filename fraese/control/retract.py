"""A held job steps aside, and comes back to the very step.

    ON_PATH --held: the queue is taken back--> AWAY --resume--> COMING_BACK --there--> ON_PATH
                                                                     the queue is given back

Rule 1: what was queued is taken back from the driver, the block in hand without what was played of
        it, and given back unchanged: the path is the one without the hold.
Rule 2: it is given back behind a closed throttle: what was planned at speed starts from the
        start/stop rate.
"""

from collections import deque
from collections.abc import Sequence
from enum import Enum, auto
from typing import Protocol

from fraese.blocks import Block
from fraese.control.lines import line_blocks, slack_after
from fraese.control.motionqueue import MotionQueue
from fraese.control.position import Position
from fraese.motor.seams import StepDriver
from fraese.planner.lines import plan_line


class Detour(Protocol):
    """A way aside while a job is held, and back again to the very step."""

    def away(self) -> Sequence[Block]:
        """From where the hold came to rest; nothing: stay there."""

    def back(self) -> Sequence[Block]:
        """From there, with the backlash as it was."""


class _Place(Enum):
    """Where a held job is."""

    ON_PATH = auto()
    AWAY = auto()
    COMING_BACK = auto()


class Aside:
    """The way aside of one job.

    Args:
        driver: its throttle is opened and closed.
        queue: its queue is emptied and filled again.
        detour: the way.
    """

    def __init__(self, driver: StepDriver, queue: MotionQueue, detour: Detour) -> None:
        self._driver = driver
        self._queue = queue
        self._detour = detour
        self._place = _Place.ON_PATH
        self._kept: deque[Block] = deque()

    def step(self, *, go_on: bool) -> bool:
        """One round while the job is held; True: back on the path, the hold may end.

        Args:
            go_on: the operator wants to go on.
        """
        report = self._queue.report
        if self._place is _Place.ON_PATH:
            if report.held:
                self._go_away()
        elif not go_on:
            pass
        elif report.queued:
            if report.held:
                # Held once more, on the way.
                self._driver.resume()
        elif self._place is _Place.AWAY:
            self._queue.push_aside(self._detour.back())
            self._place = _Place.COMING_BACK
        else:
            self._rejoin()
            return True
        return False

    @property
    def is_away(self) -> bool:
        """The motors stand off the path."""
        return self._place is _Place.AWAY and not self._queue.report.queued

    @property
    def is_owed(self) -> bool:
        """Something that was taken back is still to be given back."""
        return bool(self._kept)

    def give_back(self) -> bool:
        """Give back what there is room for; True when all of it is in the queue."""
        while self._kept:
            if self._queue.push(self._kept[0]) is None:
                return False
            self._kept.popleft()
        return True

    def _go_away(self) -> None:
        self._kept.extendleft(reversed(self._queue.take_back()))
        self._queue.push_aside(self._detour.away())
        self._place = _Place.AWAY

    def _rejoin(self) -> None:
        self._driver.brake()
        self._queue.poll()
        self.give_back()
        self._place = _Place.ON_PATH


class Retract:
    """Up by a distance, as far as the travel allows, and back down to the very step.

    A machine without a vertical axis stays where it is.

    Args:
        position: of the axes.
        height_mm: how far.
    """

    def __init__(self, position: Position, height_mm: float) -> None:
        self._position = position
        self._height_mm = height_mm
        self._height_steps = 0
        self._slack_steps: tuple[int, ...] = ()

    def away(self) -> Sequence[Block]:
        """Up, from where the hold came to rest."""
        where = self._position
        vertical = where.machine.vertical
        self._slack_steps = where.slack_steps
        if vertical is None:
            return []
        axis = where.machine.axes[vertical]
        height = axis.to_steps(self._height_mm)
        if where.referenced[vertical]:
            room = axis.high_steps - where.position_steps[vertical]
            height = min(height, max(0, room))
        self._height_steps = height
        return list(line_blocks(where, self._lift(height)))

    def back(self) -> Sequence[Block]:
        """Down again, with the backlash on the side on which it was."""
        where, down = self._position, self._lift(-self._height_steps)
        turned = tuple(
            after - before
            for after, before in zip(slack_after(where, down), self._slack_steps, strict=True)
        )
        restore = plan_line(where.machine, turned)
        return [*line_blocks(where, down), *([] if restore is None else [restore])]

    def _lift(self, height_steps: int) -> tuple[int, ...]:
        machine = self._position.machine
        return tuple(height_steps if n == machine.vertical else 0 for n in range(len(machine.axes)))
