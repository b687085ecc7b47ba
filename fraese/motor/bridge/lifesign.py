"""A program that is busy is not dead: a thread of its own says so, for a while.

    run loop   poll poll poll |------ reads 100,000 comments ------| poll
    thread                         sign  sign  sign  (nothing any more after ``busy_s``)
    device     brakes after ``silence_s`` without a word: the program was killed, or stopped

Rule 1: it speaks only while nobody else does, and only for ``busy_s`` after the last look at the
        line: who looks no more is hung, and the device brakes for it all the same.
Rule 2: it speaks no longer than the lease: then nobody knows on the disk where the motors are.
Rule 3: a sign is a frame out of sequence: good, so that the device hears it, and thrown away.
"""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Final, Protocol

from fraese.anythread import any_thread
from fraese.errors import PortError

#: Between two signs, s: some within the shortest silence that can be configured.
EVERY_S: Final = 0.06


class Looked(Protocol):
    """A driver, from its thread's side."""

    @any_thread
    def unattended_s(self) -> float | None:
        """So long nobody has looked at the line; None: it is closed for good."""

    @any_thread
    def sign_of_life(self) -> None:
        """Say that the program lives."""


class LifeSign:
    """The thread.

    Args:
        driver: for whom it speaks.
        busy_s: so long may the driver not be called.
        now_ns: the driver's time.
    """

    def __init__(
        self, driver: Looked, busy_s: float, now_ns: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self._driver = driver
        self._busy_s = busy_s
        self._now_ns = now_ns
        self._lease_ns = 0

    @any_thread
    def lease(self, until_ns: int) -> None:
        """Motors may play until then, if it is not put off."""
        self._lease_ns = until_ns

    def start(self) -> None:
        """Speak until the driver is closed."""
        threading.Thread(target=self._speak, name="life sign", daemon=True).start()

    def turn(self) -> bool:
        """A sign, if it is wanted; False: the driver is closed."""
        unattended_s = self._driver.unattended_s()
        if unattended_s is None:
            return False
        is_over = 0 < self._lease_ns < self._now_ns()
        if EVERY_S <= unattended_s < self._busy_s and not is_over:
            with suppress(PortError):
                self._driver.sign_of_life()
        return True

    def _speak(self) -> None:
        waiting = threading.Event()
        while self.turn():
            waiting.wait(EVERY_S)
