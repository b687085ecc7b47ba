"""One motion after the other on a driver; everything that a driver must be told for that.

    start ---> moving ---> still            at the target
                 | '-----> still            stopped, port lost, driver silent
                 '-------> held, flushed    braked

Rule 1: inputs stop nothing. A motion ends at its target, by ``brake`` or by ``stop``.
Rule 2: a long path is fed block by block. A queue that ran dry goes on when it is filled.
Rule 3: what was cut short leaves nothing behind: the queue is dropped and the throttle opened
        before it is said that the axes stand. A brake that comes too late holds nothing.
Rule 4: ``brake`` and ``stop`` may be called from any thread, everything else from one.
"""

import threading
from collections.abc import Iterator
from contextlib import suppress
from typing import Final

from fraese.blocks import Block
from fraese.errors import PortError
from fraese.motor.seams import Ended, Report, StepDriver, SwitchMode

#: So many blocks wait in the driver: of an endless path, minutes at the highest rate.
_AHEAD: Final = 16
#: Time for a stop to act, s.
_LAST_S: Final = 0.1
#: Ends after which nothing more is played, whatever was still to be fed.
_FOR_GOOD: Final = (Ended.STOP, Ended.SILENCE, Ended.SWITCH, Ended.WATCH)


class Motion:
    """Plays paths on a driver.

    Args:
        driver: plays their blocks.

    Attributes:
        report: the driver's last word.
        moving: one or more axes move.
        cut_short: the present or last motion was braked or stopped.
        lost: why the port cannot be reached; None: it can.
    """

    def __init__(self, driver: StepDriver) -> None:
        self._driver = driver
        # A signal's handler may brake while its own thread is at the gate.
        self._gate = threading.RLock()
        self._path: Iterator[Block] = iter(())
        self._next: Block | None = None
        self.moving = False
        self.cut_short = False
        self.lost: PortError | None = None
        driver.set_switch_mode(SwitchMode.IGNORE)
        self.report: Report = driver.poll(0.0)
        self._base = self.report.position_steps

    @property
    def steps(self) -> tuple[int, ...]:
        """Signed steps of every axis since the last start."""
        position = self.report.position_steps
        return tuple(now - then for now, then in zip(position, self._base, strict=True))

    def start(self, path: Iterator[Block]) -> None:
        """Begin a path; the axes stand.

        Raises:
            PortError: if the port cannot be reached; nothing moves.
        """
        if self.lost is not None:
            # Perhaps it is there again.
            self.look(0.0)
        self._base = self.report.position_steps
        self._path, self._next = path, next(path, None)
        self.cut_short = False
        self.moving = True
        self.look(0.0)

    def look(self, budget_s: float) -> None:
        """Let the driver play for at most that long, and see how far it came.

        Raises:
            PortError: if the port was lost; the axes stand then.
        """
        try:
            if self.moving and not self.cut_short:
                self._feed()
            self.report = report = self._driver.poll(budget_s)
            self.lost = None
            if self.moving and not report.running and self._is_over(report):
                self._end()
        except PortError as error:
            self.lost = error
            self._drop()
            raise

    def brake(self) -> bool:
        """Go over into the braking ramp; False: the axes stand. From any thread."""
        with self._gate:
            if self.moving:
                self.cut_short = True
                self._driver.brake()
            return self.moving

    def stop(self) -> bool:
        """Stop without ramp; False: the axes stand. From any thread."""
        with self._gate:
            if self.moving:
                self.cut_short = True
                self._driver.stop()
            return self.moving

    def give_up(self) -> None:
        """Stop; nobody will look any more."""
        self.stop()
        with suppress(Exception):
            self.look(_LAST_S)
        self._drop()

    def _feed(self) -> None:
        queued = self.report.queued
        while self._next is not None and queued < _AHEAD and self._driver.push(self._next):
            self._next = next(self._path, None)
            queued += 1

    def _is_over(self, report: Report) -> bool:
        return self.cut_short or self._next is None or report.ended in _FOR_GOOD

    def _end(self) -> None:
        self._drop()
        if self.cut_short or self.report.held:
            self._driver.flush()

    def _drop(self) -> None:
        with self._gate:
            self.moving = False
        self._path, self._next = iter(()), None
