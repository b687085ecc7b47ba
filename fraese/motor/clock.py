"""Clocks: who says when a step is due.

MonotonicClock   the machine's own clock: sleep, then spin the last stretch
VirtualClock     jumps: a long job takes seconds and gives the same bytes every time
PacedClock       a virtual clock that keeps step with the wall: for looking at a simulated
                 mill. What is simulated sees exact time, however late the thread is.
"""

import time
from typing import Final

_SPIN_NS: Final = 200_000
_PACE_NS: Final = 4_000_000
_CATCH_UP_NS: Final = 100_000_000


class MonotonicClock:
    """The machine's clock; sleeps until shortly before the deadline, then spins."""

    def now_ns(self) -> int:
        """Nanoseconds of the system's monotonic clock."""
        return time.monotonic_ns()

    def wait_until(self, deadline_ns: int) -> int:
        """Return as close after the deadline as the machine lets us."""
        now = time.monotonic_ns()
        while (ahead := deadline_ns - now) > 0:
            if ahead > _SPIN_NS:
                time.sleep((ahead - _SPIN_NS) * 1e-9)
            now = time.monotonic_ns()
        return now

    def pass_by(self, elapsed_ns: int) -> None:
        """It has moved by itself."""


class VirtualClock:
    """Time that passes only when somebody waits for it."""

    def __init__(self, start_ns: int = 0) -> None:
        self._now_ns = start_ns

    def now_ns(self) -> int:
        """The virtual time."""
        return self._now_ns

    def wait_until(self, deadline_ns: int) -> int:
        """Jump to the deadline."""
        if deadline_ns > self._now_ns:
            self._now_ns = deadline_ns
        return self._now_ns

    def pass_by(self, elapsed_ns: int) -> None:
        """Move on by so much."""
        self.wait_until(self._now_ns + elapsed_ns)


class PacedClock(VirtualClock):
    """A virtual clock that is never ahead of the wall by more than a few milliseconds.

    If the thread was away for long, the missed time is given up, not caught up in a burst.
    """

    def __init__(self) -> None:
        super().__init__()
        self._offset_ns = time.monotonic_ns()
        self._pace_ns = 0

    def wait_until(self, deadline_ns: int) -> int:
        """Jump to the deadline; every few milliseconds let the wall catch up."""
        if deadline_ns > self._now_ns:
            self._now_ns = deadline_ns
            if deadline_ns > self._pace_ns:
                self._pace(deadline_ns)
        return self._now_ns

    def _pace(self, deadline_ns: int) -> None:
        ahead_ns = deadline_ns - (time.monotonic_ns() - self._offset_ns)
        if ahead_ns > 0:
            time.sleep(ahead_ns * 1e-9)
        elif ahead_ns < -_CATCH_UP_NS:
            self._offset_ns -= ahead_ns
        self._pace_ns = deadline_ns + _PACE_NS
