"""Presses of a jog key become moves.

    press, press, press  ->  [ runs: 1 ] [ waits: 2 ]

Rule 1: one jog runs and at most one waits. Further presses of the same key are added to the one
        that waits, so that none is lost at fine widths; it never becomes longer than a press or
        ``_MERGED_MAX_MM``, so that a held key leaves next to nothing to run off.
Rule 2: a stop drops what waits.
"""

import threading
from dataclasses import dataclass, replace
from typing import Final

from fraese.control.controller import Controller
from fraese.control.worker import Worker

_MERGED_MAX_MM: Final = 0.5
JOG_GROUP: Final = "jog"


@dataclass(frozen=True, slots=True)
class Jog:
    """A bounded move of one axis, in steps or in mm."""

    axis: str
    steps: int = 0
    mm: float = 0.0

    def merged(self, other: "Jog", step_mm: float) -> "Jog | None":
        """Both as one; None if they are not alike, or it would be too long."""
        alike = (
            self.axis == other.axis and self.steps * other.steps >= 0 and self.mm * other.mm >= 0
        )
        both = replace(self, steps=self.steps + other.steps, mm=self.mm + other.mm)
        if not alike or bool(both.steps) == bool(both.mm):
            return None
        length_mm = abs(both.mm) + abs(both.steps) * step_mm
        return both if length_mm <= _MERGED_MAX_MM else None


class Jogger:
    """Hands jogs to the worker. All methods but the moves themselves run in the app's thread.

    Args:
        controller: makes the moves, in the worker's thread.
        worker: its owner.
    """

    def __init__(self, controller: Controller, worker: Worker) -> None:
        self._controller = controller
        self._worker = worker
        self._lock = threading.Lock()
        self._waiting: Jog | None = None
        self._step_mm = {axis.name: axis.step_mm for axis in controller.machine.axes}

    def press(self, jog: Jog) -> bool:
        """One press; False if something other than a jog runs."""
        with self._lock:
            if self._waiting is not None:
                both = self._waiting.merged(jog, self._step_mm[jog.axis])
                self._waiting = both or self._waiting
                return True

            if not self._worker.submit(self._go, JOG_GROUP):
                return False
            self._waiting = jog
            return True

    def forget(self) -> None:
        """After a stop: nothing waits any more."""
        with self._lock:
            self._waiting = None

    def _go(self) -> None:
        with self._lock:
            jog, self._waiting = self._waiting, None
        if jog is None:
            return
        if jog.steps:
            self._controller.jog_steps(jog.axis, jog.steps, clamp=True)
        else:
            self._controller.jog(jog.axis, jog.mm, clamp=True)
