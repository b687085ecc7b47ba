"""A device that was lost, looked for: some milliseconds at a time, an attempt a second.

    look, look, look ... | attempt: open, greet, tell | pause 1 s | attempt ...

Rule 1: a look lasts 20 ms, and one step of the attempt at most: whoever polls is not kept waiting.
Rule 2: until it is found every look says so, with what kept the last attempt from succeeding.
"""

from collections.abc import Callable
from typing import Final

from fraese import alarms
from fraese.errors import PortError
from fraese.motor.bridge.stepwise import Steps, advance
from fraese.motor.seams import Clock
from fraese.phrases import phrase

_PAUSE_NS: Final = 1_000_000_000
_LOOK_NS: Final = 20_000_000


class Search:
    """Looks for one device.

    Args:
        begin: a new attempt, in steps.
        clock: for looks and pauses.
        name: of the line, for sentences.
    """

    def __init__(self, begin: Callable[[], Steps[None]], clock: Clock, name: str) -> None:
        self._begin = begin
        self._clock = clock
        self._name = name
        self._attempt: Steps[None] | None = None
        self._again_ns = 0
        self._reason = ""

    def look(self) -> None:
        """Go on with the attempt, or begin another one.

        Raises:
            PortError: the device has not been found yet.
        """
        now_ns = self._clock.now_ns
        if self._attempt is None and now_ns() >= self._again_ns:
            self._attempt = self._begin()
        until_ns = now_ns() + _LOOK_NS
        try:
            if self._attempt and advance(self._attempt, lambda: now_ns() >= until_ns):
                self._end("")
                return
        except PortError as error:
            self._end(f" {error}")
        raise PortError(
            phrase(
                "The bridge on {name} is lost; it is looked for.{reason}",
                name=self._name,
                reason=self._reason,
            ),
            alarms.BRIDGE_LOST,
        )

    def close(self) -> None:
        """Give up; what an attempt holds is let go."""
        if self._attempt is not None:
            self._attempt.close()
            self._attempt = None

    def _end(self, reason: str) -> None:
        self._attempt, self._reason = None, reason
        self._again_ns = self._clock.now_ns() + _PAUSE_NS
