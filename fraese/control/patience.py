"""How long the run loop waits for motors that do not get on.

Rule 1: a wait that a person asked for (a hold, a question) may last for ever, and so may a program
        that computes, which a person can end; no other one may.
Rule 2: getting on is any change of place, queue or state, or an edge that is due later: at the
        slowest feeds a step takes minutes.
Rule 3: only time in which the driver was looked after counts: a program that was stopped for a
        while has no reason to complain.
"""

from typing import Final

from fraese import alarms
from fraese.errors import PortError
from fraese.motor.seams import Clock, Report
from fraese.phrases import phrase

#: Motors that do not get on for so long never will.
LIMIT_S: Final = 3.0
#: Two looks that are further apart than this were held up.
_HELD_UP_NS: Final = 250_000_000
_NS_PER_S: Final = 1_000_000_000


class Patience:
    """Sees whether a job gets on.

    Args:
        clock: the driver's.
        slice_s: what a look stands for where the clock does not move by itself.
        limit_s: how long nothing may happen.
    """

    def __init__(self, clock: Clock, slice_s: float, limit_s: float = LIMIT_S) -> None:
        self._clock = clock
        self._slice_ns = round(slice_s * _NS_PER_S)
        self._limit_ns = round(limit_s * _NS_PER_S)
        self._looked_ns = self._waited_ns = 0
        self._seen: tuple[object, ...] = ()

    def begin(self) -> None:
        """A job begins."""
        self._looked_ns, self._waited_ns, self._seen = self._clock.now_ns(), 0, ()

    def is_over(self, report: Report, *, excused: bool) -> bool:
        """Nothing has happened for too long.

        Args:
            report: the driver's last word.
            excused: a person has asked for this wait, or nobody waits for motors.
        """
        now_ns = self._clock.now_ns()
        passed_ns = now_ns - self._looked_ns or self._slice_ns
        self._looked_ns = now_ns
        seen = (
            report.position_steps,
            report.playing,
            report.tick,
            report.finished,
            report.queued,
            report.running,
            report.held,
            report.ended,
        )
        if excused or seen != self._seen or report.due_ns > now_ns:
            self._seen, self._waited_ns = seen, 0
            return False
        self._waited_ns += min(passed_ns, _HELD_UP_NS)
        return self._waited_ns > self._limit_ns


def no_progress(where: str) -> PortError:
    """What is said when patience is over."""
    return PortError(
        phrase(
            "The motors did not get on for {limit_s:g} s at {where}: they were stopped and"
            " switched off.",
            limit_s=LIMIT_S,
            where=where,
        ),
        alarms.NO_PROGRESS,
        waited_s=LIMIT_S,
    )
