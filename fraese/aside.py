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

from fraese.ahead import Ahead
from fraese.blocks import Block
from fraese.motor.seams import StepDriver


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
        ahead: its queue is emptied and filled again.
        detour: the way.
    """

    def __init__(self, driver: StepDriver, ahead: Ahead, detour: Detour) -> None:
        self._driver = driver
        self._ahead = ahead
        self._detour = detour
        self._place = _Place.ON_PATH
        self._kept: deque[Block] = deque()

    def step(self, *, go_on: bool) -> bool:
        """One round while the job is held; True: back on the path, the hold may end.

        Args:
            go_on: the operator wants to go on.
        """
        report = self._ahead.report
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
            self._ahead.push_all(self._detour.back())
            self._place = _Place.COMING_BACK
        else:
            self._rejoin()
            return True
        return False

    @property
    def is_away(self) -> bool:
        """The motors stand off the path."""
        return self._place is _Place.AWAY and not self._ahead.report.queued

    @property
    def is_owed(self) -> bool:
        """Something that was taken back is still to be given back."""
        return bool(self._kept)

    def give_back(self) -> bool:
        """Give back what there is room for; True when all of it is in the queue."""
        while self._kept:
            if self._ahead.push(self._kept[0]) is None:
                return False
            self._kept.popleft()
        return True

    def _go_away(self) -> None:
        self._kept.extendleft(reversed(self._ahead.take_back()))
        self._ahead.push_all(self._detour.away())
        self._place = _Place.AWAY

    def _rejoin(self) -> None:
        self._driver.brake()
        self._ahead.poll()
        self._ahead.recount()
        self.give_back()
        self._place = _Place.ON_PATH
