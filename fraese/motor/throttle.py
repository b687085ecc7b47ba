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
Rule 4: at a junction the throttle's rate is scaled by next.entry / this.exit, so that the path
        speed stays what it was.
"""

from enum import Enum, auto
from typing import Final

from fraese.blocks import RATE_Q8_CYCLES

SLICE_CYCLES: Final = 16_000


class ThrottleState(Enum):
    """Where the throttle is."""

    OPEN = auto()
    CLOSING = auto()
    HELD = auto()
    OPENING = auto()


class Throttle:
    """State and integers of the throttle; the driver asks it for every interval unless open."""

    def __init__(self) -> None:
        self.state = ThrottleState.OPEN
        self._rate_q8 = 0
        self._slice_cycles = 0
        self._accel_q = 1
        self._jump_rate_q8 = 0

    def block(self, accel_q: int, jump_rate_q8: int) -> None:
        """Take the limits of the block that plays now."""
        self._accel_q = accel_q
        self._jump_rate_q8 = jump_rate_q8

    def junction(self, exit_cycles: int, entry_cycles: int) -> None:
        """Scale the rate from the last interval of one block to the first of the next."""
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
        self._rate_q8 = max(1, self._rate_q8, self._jump_rate_q8)
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
        self._slice_cycles += last_cycles
        if self._slice_cycles >= SLICE_CYCLES:
            self._move()
        if self.state is ThrottleState.CLOSING and self._rate_q8 <= self._jump_rate_q8:
            self.state = ThrottleState.HELD
        if self.state is ThrottleState.HELD:
            return -1
        cycles = RATE_Q8_CYCLES // self._rate_q8
        if cycles > plan_cycles:
            return cycles
        if self.state is ThrottleState.OPENING:
            self.state = ThrottleState.OPEN
        elif cycles < plan_cycles:
            # The plan slows down by itself: what is left to brake starts from there.
            self._rate_q8 = RATE_Q8_CYCLES // plan_cycles
        return plan_cycles

    def _move(self) -> None:
        change = self._accel_q * self._slice_cycles >> 16
        self._slice_cycles = 0
        if self.state is ThrottleState.CLOSING:
            self._rate_q8 = max(0, self._rate_q8 - change)
        elif self.state is ThrottleState.OPENING:
            self._rate_q8 += change
