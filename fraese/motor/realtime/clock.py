"""The clock of a process that does nothing but steps: sleep, do chores, spin.

        now                                              deadline
         |--chore--chore--nap-----------|---- spin --------|
         ^ wishes                       ^ room             the edge is written

Rule 1: a deadline goes before all else. A chore is begun only if there is room for it; a nap ends
        early enough for the kernel to be late.
Rule 2: wishes (brake, stop, override) are looked at in every wait, also in one whose deadline has
        passed: one word is read, and they act within one tick at any rate.
Rule 3: a wait of more than a millisecond is broken off for a wish, where the core may be
        interrupted: at a low rate a tick may be long.
Rule 4: at rates that leave no room ever, a chore is begun all the same when none was for long. It
        costs a late tick, and is counted as one.
"""

import time
from collections.abc import Callable
from typing import Final, Protocol

#: Room for any usual chore, ns: it takes a few microseconds, and more after a nap.
ROOM_NS: Final = 15_000
#: A nap ends this long before the deadline, ns: the kernel wakes late by some 50 us.
SPIN_NS: Final = 80_000
#: The longest nap, ns: so long may a wish have to wait at a low rate.
NAP_NS: Final = 500_000
#: A chore is begun at least so often, ns.
FORCE_NS: Final = 10_000_000
#: Waits longer than this are broken off for a wish, ns.
BREAK_NS: Final = 1_000_000
#: No wait is as long as this, and none as short as that.
NO_BREAK_NS: Final = 1 << 62
ANY_BREAK_NS: Final = -NO_BREAK_NS


class Interrupted(Exception):
    """A wait was broken off; the core plays on where it was when it is polled again."""


class Attendant(Protocol):
    """Who wishes, and what there is to do between two deadlines.

    Attributes:
        room_ns: time that the next chore may need, ``ROOM_NS`` or more.
    """

    room_ns: int

    def has_wish(self) -> bool:
        """Something is wished for that was not taken up yet: one look at a word."""

    def take_wishes(self) -> int:
        """Pass them on.

        Returns:
            A wait that has more than so many ns left is broken off for it.
        """

    def chore(self) -> bool:
        """Do the next small piece of work; False: there is nothing to do just now."""


class Nobody:
    """Nothing to do, nothing to wish for."""

    room_ns = ROOM_NS

    def has_wish(self) -> bool:
        """No."""
        return False

    def take_wishes(self) -> int:
        """None."""
        return NO_BREAK_NS

    def chore(self) -> bool:
        """Nothing."""
        return False


class RealtimeClock:
    """The machine's clock, with something to do in the gaps.

    Args:
        now_ns: where the time comes from.
        sleep_s: how to sleep.

    Attributes:
        deadline_ns: of the wait in hand, or of the last one.
        attendant: who wishes, and has chores.
    """

    def __init__(
        self,
        now_ns: Callable[[], int] = time.monotonic_ns,
        sleep_s: Callable[[float], object] = time.sleep,
    ) -> None:
        # Asked for the time thousands of times a second: the function itself, not one around it.
        self.now_ns = now_ns
        self._sleep_s = sleep_s
        self._force_ns = 0
        self.deadline_ns = 0
        self.attendant: Attendant = Nobody()

    def wait_until(self, deadline_ns: int) -> int:
        """Return as close after the deadline as the machine lets us.

        Raises:
            Interrupted: the wait is long, and a wish has come.
        """
        self.deadline_ns = deadline_ns
        now_ns, attendant = self.now_ns, self.attendant
        now = now_ns()
        if attendant.has_wish():
            self._take_wishes(deadline_ns - now)
            now = now_ns()
        while (ahead := deadline_ns - now) > ROOM_NS:
            if ahead > attendant.room_ns and attendant.chore():
                self._force_ns = now + FORCE_NS
            elif ahead > SPIN_NS:
                self._sleep_s(min(ahead - SPIN_NS, NAP_NS) * 1e-9)
            now = now_ns()
            if attendant.has_wish():
                self._take_wishes(deadline_ns - now)
        if now > self._force_ns:
            attendant.chore()
            self._force_ns = now + FORCE_NS
            now = now_ns()
        while now < deadline_ns:
            now = now_ns()
        return now

    def _take_wishes(self, ahead_ns: int) -> None:
        if ahead_ns > self.attendant.take_wishes():
            raise Interrupted

    def pass_by(self, elapsed_ns: int) -> None:
        """It has moved by itself."""
