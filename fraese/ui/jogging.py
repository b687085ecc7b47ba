"""Presses of jog keys, handed to the machine's thread.

    press --> jogs [ what waits ] <-- a job in the machine's thread, submitted when there is none

Rule 1: while a jog runs, a press is added to it (``control/jogging.py``); else a job is begun for
        it, unless something else runs.
Rule 2: a stop drops what waits.
"""

import threading
from collections.abc import Callable
from typing import Final

from fraese.control.controller import Controller
from fraese.control.heldjog import Hold
from fraese.control.jogging import Jogs
from fraese.control.worker import Worker

JOG_GROUP: Final = "jog"


class Jogger:
    """Hands jogs to the worker. All methods run in the app's thread.

    Args:
        controller: makes the moves, in the worker's thread.
        worker: its owner.
        tell: told what a person should know, in the worker's thread,
        refuse: and what was not done, likewise.

    Attributes:
        rate: how fast jogs go.
    """

    def __init__(
        self,
        controller: Controller,
        worker: Worker,
        tell: Callable[[str], object],
        refuse: Callable[[str], object],
    ) -> None:
        self._jogs = Jogs(controller, tell, refuse)
        self.rate = self._jogs.rate
        self._worker = worker
        self._lock = threading.Lock()
        # A job for what waits is on its way to the worker.
        self._is_coming = False

    def press(self, axis: str, *, steps: int = 0, mm: float = 0.0, held: bool = False) -> bool:
        """One press; False if something other than a jog runs."""
        with self._lock:
            return self._begun(self._jogs.press(axis, steps=steps, mm=mm, held=held))

    def hold(self, axis: str, sign: int, hold: Hold) -> bool:
        """Run for as long as it is held; False if something other than a jog runs."""
        with self._lock:
            return self._begun(self._jogs.hold(axis, sign, hold))

    def _begun(self, has_a_job: bool) -> bool:
        if has_a_job or self._is_coming:
            return True
        self._is_coming = self._worker.submit(self._go, JOG_GROUP)
        if not self._is_coming:
            self._jogs.forget()
        return self._is_coming

    def let_go(self) -> None:
        """A key that was held was let go."""
        self._jogs.let_go()

    def forget(self) -> None:
        """After a stop: nothing waits any more."""
        with self._lock:
            self._is_coming = False
            self._jogs.forget()

    @property
    def waiting(self) -> tuple[tuple[str, int], ...]:
        """Names of axes, and how many presses of each wait, signed."""
        return self._jogs.waiting

    def _go(self) -> None:
        with self._lock:
            self._is_coming = False
        self._jogs.start()
