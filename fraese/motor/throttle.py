r"""The throttle: the one mechanism behind brake, hold, resume, a dry queue and a lost host.

The rate played is min(plan, throttle). Path and plan are never changed, only how fast they go:

    rate ^   plan  ________________________
         |        /   \                 __/
         |       /     \   closing     /    opening: rises until it meets the plan
         |      /       \             /
         |  ...............\_______../.....  start/stop rate: below it the motors may stand
         +------------------- held ---------> time

Rule 1: integers only, so that the core, the child and the firmware play the same cycles.
Rule 2: the rate moves in slices: when ``SLICE_CYCLES`` have been played a move is decided, by
        acceleration x time since the last one, and ``LATENCY_CYCLES`` later it counts. So a slow
        processor has a quarter of a millisecond for the division:

            elapsed  0 ------------- slice ---- latency ------------- slice ---- latency --->
                     rate of before  | decided  | counts               | decided  | counts

Rule 3: a closing throttle holds when it, or what was played last, is at or below the block's
        start/stop rate: the next tick is not played. An opening one starts at that rate.
Rule 4: a lowered feed override is a ceiling: closing, but only down to it; it follows the block.
Rule 5: at a junction the throttle's rate is scaled by next.entry / this.exit, both as planned,
        so that the path speed stays what it was. A move that was decided is decided anew, and none
        counts so close to a junction that the scaling could not be ready.
Rule 6: a dwell has no rate: motors stand in it. An opening throttle is open there.
"""

from enum import Enum, auto
from typing import Final

from fraese.blocks import RATE_Q8_CYCLES

SLICE_CYCLES: Final = 16_000
LATENCY_CYCLES: Final = 4_096

#: A ratio of two intervals, in 1/65536, has 32 bits.
_MOST_Q16: Final = 0xFFFF_FFFF


class ThrottleState(Enum):
    """Where the throttle is."""

    OPEN = auto()
    CLOSING = auto()
    HELD = auto()
    OPENING = auto()
    #: A ceiling is below the plan: a feed override was lowered.
    LIMITED = auto()


def _q16(a: int, b: int) -> int:
    return min((a << 16) // b, _MOST_Q16)


class Throttle:
    """State and integers of the throttle; the driver asks it for every interval unless open.

    Attributes:
        state: where it is.
        ceiling_q8: rate above which the block in hand is not to be played; 0: none.
    """

    def __init__(self) -> None:
        self.state = ThrottleState.OPEN
        self._rate_q8 = 0
        self._cycles = 0
        self._elapsed_cycles = 0
        #: When the move that waits was decided, on the scale of ``_elapsed_cycles``; 0: none.
        self._mark_cycles = 0
        self._accel_q = 1
        self._jump_rate_q8 = 1
        self._jump_cycles = RATE_Q8_CYCLES
        self.ceiling_q8 = 0

    def block(self, accel_q: int, jump_rate_q8: int, jump_cycles: int) -> None:
        """Take the limits of the moving block that plays now."""
        self._accel_q = accel_q
        self._jump_rate_q8 = jump_rate_q8
        self._jump_cycles = jump_cycles

    def dwell(self) -> None:
        """No motor moves in the block that plays now: it can be held and taken up at any rate."""
        self._jump_cycles = 0
        if self.state in (ThrottleState.OPENING, ThrottleState.LIMITED):
            self.state = ThrottleState.OPEN

    def junction(self, exit_cycles: int, entry_cycles: int) -> None:
        """Scale the rate from the planned exit of one block to the planned entry of the next.

        Args:
            exit_cycles: the last interval in the plan of the one; 0: from standstill.
            entry_cycles: the first interval in the plan of the other.
        """
        if exit_cycles and entry_cycles:
            self._cycles = self._cycles * _q16(entry_cycles, exit_cycles) >> 16
            self._rate_q8 = self._rate_q8 * _q16(exit_cycles, entry_cycles) >> 16
            self._mark_cycles = 0

    def close(self, last_cycles: int) -> None:
        """Start closing from the rate last played; 0: from standstill."""
        if self.state in (ThrottleState.CLOSING, ThrottleState.HELD):
            return
        self._begin(ThrottleState.CLOSING)
        self._rate_q8 = RATE_Q8_CYCLES // last_cycles if last_cycles else 0
        self._cycles = last_cycles

    def open(self) -> None:
        """Start opening, from the start/stop rate after a hold, else from where it came to."""
        if self.state in (ThrottleState.OPEN, ThrottleState.OPENING):
            return
        if self.state is ThrottleState.HELD:
            self._rate_q8 = self._cycles = 0
        self._begin(ThrottleState.OPENING)

    def hold(self) -> None:
        """Hold: the motors stand already."""
        self.state = ThrottleState.HELD

    def reset(self) -> None:
        """Open at once: nothing is playing."""
        self.state = ThrottleState.OPEN

    def mind_ceiling(self, ceiling_q8: int, last_cycles: int) -> None:
        """A ceiling for the block in hand has come, or (0) is gone.

        Args:
            ceiling_q8: rate above which the block is not to be played; 0: none.
            last_cycles: what the previous tick took; 0 after a standstill.
        """
        self.ceiling_q8 = ceiling_q8
        if not ceiling_q8:
            if self.state is ThrottleState.LIMITED:
                self._begin(ThrottleState.OPENING)
        elif self.state is ThrottleState.OPEN:
            self._begin(ThrottleState.LIMITED)
            if last_cycles:
                self._rate_q8, self._cycles = RATE_Q8_CYCLES // last_cycles, last_cycles
            else:
                self._rate_q8 = min(self._jump_rate_q8, ceiling_q8)
                self._cycles = max(self._jump_cycles, RATE_Q8_CYCLES // ceiling_q8)

    def advance(self, last_cycles: int, ticks_left: int) -> None:
        """Time has passed: a tick was played while the throttle was neither open nor held.

        Args:
            last_cycles: what it took.
            ticks_left: ticks of the block in hand that are still to be played.
        """
        elapsed = self._elapsed_cycles + last_cycles
        mark = self._mark_cycles
        if mark and elapsed - mark >= LATENCY_CYCLES and self._is_far_from_junction(ticks_left):
            self._move(mark)
            elapsed -= mark
            mark = 0
        if not mark and elapsed >= SLICE_CYCLES:
            mark = elapsed
        self._elapsed_cycles, self._mark_cycles = elapsed, mark

    def interval(self, plan_cycles: int, last_cycles: int) -> int:
        """Cycles to the next tick, -1 for "do not play it: held".

        Args:
            plan_cycles: what the plan wants.
            last_cycles: what the previous tick took; 0 after a standstill.
        """
        state = self.state
        if state is ThrottleState.OPENING:
            if self._rate_q8 < self._jump_rate_q8:
                self._rate_q8, self._cycles = self._jump_rate_q8, self._jump_cycles
        elif state is ThrottleState.CLOSING:
            slowest = max(last_cycles, self._cycles)
            if not last_cycles or slowest >= self._jump_cycles:
                self.state = state = ThrottleState.HELD
        if state is ThrottleState.HELD:
            return -1
        if self._cycles > plan_cycles:
            return self._cycles
        if state is ThrottleState.OPENING:
            self.state = ThrottleState.OPEN
        return plan_cycles

    def _begin(self, state: ThrottleState) -> None:
        self.state = state
        self._elapsed_cycles = self._mark_cycles = 0

    def _is_far_from_junction(self, ticks_left: int) -> bool:
        return ticks_left * (self._cycles >> 8) >= LATENCY_CYCLES >> 8

    def _move(self, elapsed_cycles: int) -> None:
        change = self._accel_q * elapsed_cycles >> 16
        meets_ceiling = 0 < self.ceiling_q8 <= self._rate_q8 + change
        if meets_ceiling and self.state is ThrottleState.OPENING:
            self.state = ThrottleState.LIMITED
        if self.state is ThrottleState.CLOSING:
            self._rate_q8 = max(0, self._rate_q8 - change)
            if self._rate_q8 <= self._jump_rate_q8:
                self._cycles = self._jump_cycles
                return
        elif self.state is ThrottleState.LIMITED:
            self._approach_ceiling(change)
        else:
            self._rate_q8 += change
        self._rate_q8 = max(1, self._rate_q8)
        self._cycles = RATE_Q8_CYCLES // self._rate_q8

    def _approach_ceiling(self, change: int) -> None:
        """With the acceleration; below the start/stop rate at once."""
        ceiling, jump = self.ceiling_q8, self._jump_rate_q8
        if self._rate_q8 > ceiling:
            lower = max(self._rate_q8 - change, ceiling)
            self._rate_q8 = ceiling if lower <= jump else lower
        else:
            self._rate_q8 = min(ceiling, max(self._rate_q8 + change, jump))
