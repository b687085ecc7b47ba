r"""The throttle: the one mechanism behind brake, hold, resume, a dry queue and a lost host.

The rate played is min(plan, throttle). Path and plan are never changed, only how fast they go:

    rate ^   plan  ________________________
         |        /   \                 __/
         |       /     \   closing     /    opening: rises until it meets the plan
         |      /       \             /
         |  ...............\_______../.....  start/stop rate: below it the motors may stand
         +------------------- held ---------> time

Rule 1: integers only, so that the core, the child and the firmware play the same cycles.
Rule 2: the rate changes in slices: after at least ``SLICE_CYCLES`` of played time it moves by
        acceleration x that time, and stays until the next slice. So a slow processor has a
        millisecond for the division.
Rule 3: below or at the block's start/stop rate a closing throttle holds: the next tick is not
        played. An opening one starts at that rate.
Rule 4: a lowered feed override is a ceiling: closing, but only down to it; it follows the block.
Rule 5: at a junction the throttle's rate is scaled by next.entry / this.exit, both as planned,
        so that the path speed stays what it was.
Rule 5: a dwell has no rate: motors stand in it. An opening throttle is open there.
"""

from enum import Enum, auto
from math import isqrt
from typing import Final

from fraese.blocks import RATE_Q8_CYCLES

SLICE_CYCLES: Final = 16_000

#: ``isqrt(accel_q * this)`` is the rate_q8 that is reached from rest within half a tick: 2**8 times
#: the square root of the acceleration in ticks/s**2.
_FROM_REST: Final = 62_500

#: Above every rate.
_ANY_RATE_Q8: Final = 1 << 33


class ThrottleState(Enum):
    """Where the throttle is."""

    OPEN = auto()
    CLOSING = auto()
    HELD = auto()
    OPENING = auto()
    #: A ceiling is below the plan: a feed override was lowered.
    LIMITED = auto()


class Throttle:
    """State and integers of the throttle; the driver asks it for every interval unless open.

    Attributes:
        ceiling_q8: rate above which the present block is not to be played; 0: none.
    """

    def __init__(self) -> None:
        self.state = ThrottleState.OPEN
        self.ceiling_q8 = 0
        self._rate_q8 = 0
        self._slice_cycles = 0
        self._accel_q = 1
        self._jump_rate_q8 = 1

    def block(self, accel_q: int, jump_rate_q8: int) -> None:
        """Take the limits of the moving block that plays now.

        A start/stop rate of next to nothing would mean minutes for the first or the last tick; a
        quarter of the rate that is reached within half a tick is as good as standing.
        """
        self._accel_q = accel_q
        self._jump_rate_q8 = max(1, jump_rate_q8, isqrt(accel_q * _FROM_REST) >> 2)

    def dwell(self) -> None:
        """No motor moves in the block that plays now: it can be held and taken up at any rate."""
        self._jump_rate_q8 = _ANY_RATE_Q8
        if self.state in (ThrottleState.OPENING, ThrottleState.LIMITED):
            self.state = ThrottleState.OPEN

    def junction(self, exit_cycles: int, entry_cycles: int) -> None:
        """Scale the rate from the planned exit of one block to the planned entry of the next.

        Args:
            exit_cycles: the last interval in the plan of the one; 0: from standstill.
            entry_cycles: the first interval in the plan of the other.
        """
        if exit_cycles and entry_cycles:
            self._rate_q8 = self._rate_q8 * exit_cycles // entry_cycles

    def close(self, last_interval_cycles: int) -> None:
        """Start closing from the rate last played; 0: from standstill."""
        if self.state in (ThrottleState.CLOSING, ThrottleState.HELD):
            return
        self.state = ThrottleState.CLOSING
        self._rate_q8 = RATE_Q8_CYCLES // last_interval_cycles if last_interval_cycles else 0
        self._slice_cycles = 0

    def open(self) -> None:
        """Start opening, from the start/stop rate after a hold, else from where closing came to."""
        if self.state in (ThrottleState.OPEN, ThrottleState.OPENING):
            return
        self._slice_cycles = 0
        self.state = ThrottleState.OPENING

    def hold(self) -> None:
        """Hold: the motors stand already."""
        self.state = ThrottleState.HELD
        self._rate_q8 = 0

    def reset(self) -> None:
        """Open at once: nothing is playing."""
        self.state = ThrottleState.OPEN

    def interval(self, plan_cycles: int, last_cycles: int) -> int:
        """Cycles to the next tick, -1 for "do not play it: held".

        Args:
            plan_cycles: what the plan wants.
            last_cycles: what the previous tick took; 0 after a standstill.
        """
        self._mind_ceiling(last_cycles)
        self._slice_cycles += last_cycles
        if self._slice_cycles >= SLICE_CYCLES:
            self._move()
        if self.state is ThrottleState.CLOSING and self._rate_q8 <= self._jump_rate_q8:
            self.hold()
        if self.state is ThrottleState.HELD:
            return -1
        if self.state is not ThrottleState.LIMITED:
            self._rate_q8 = max(self._rate_q8, self._jump_rate_q8)
        cycles = RATE_Q8_CYCLES // self._rate_q8
        if cycles > plan_cycles:
            return cycles
        if self.state is ThrottleState.OPENING:
            self.state = ThrottleState.OPEN
        elif cycles < plan_cycles:
            # The plan slows down by itself: what is left to brake starts from there.
            self._rate_q8 = RATE_Q8_CYCLES // plan_cycles
        return plan_cycles

    def _mind_ceiling(self, last_cycles: int) -> None:
        """A ceiling has come, or has gone."""
        if not self.ceiling_q8:
            if self.state is ThrottleState.LIMITED:
                self.state = ThrottleState.OPENING
        elif self.state is ThrottleState.OPEN:
            self.state = ThrottleState.LIMITED
            self._rate_q8 = RATE_Q8_CYCLES // last_cycles if last_cycles else self._jump_rate_q8
            self._slice_cycles = 0
            self._approach_ceiling(0)
        elif self.state is ThrottleState.OPENING and self._rate_q8 >= self.ceiling_q8:
            self.state = ThrottleState.LIMITED

    def _approach_ceiling(self, change: int) -> None:
        """With the acceleration; below the start/stop rate at once."""
        ceiling, jump = self.ceiling_q8, self._jump_rate_q8
        if self._rate_q8 > ceiling:
            lower = max(self._rate_q8 - change, ceiling)
            self._rate_q8 = ceiling if lower <= jump else lower
        else:
            self._rate_q8 = min(ceiling, max(self._rate_q8 + change, jump))
        self._rate_q8 = max(1, self._rate_q8)

    def _move(self) -> None:
        change = self._accel_q * self._slice_cycles >> 16
        self._slice_cycles = 0
        if self.state is ThrottleState.CLOSING:
            self._rate_q8 = max(0, self._rate_q8 - change)
        elif self.state is ThrottleState.OPENING:
            self._rate_q8 += change
        elif self.state is ThrottleState.LIMITED:
            self._approach_ceiling(change)
