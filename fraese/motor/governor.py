"""Which interval comes next: the plan's, or the throttle's where that is longer.

Rule 1: nothing changes path or plan. Brake, hold, resume and a dry queue work the throttle.
Rule 2: it closes on a brake, and at the dry point, from which on what is queued would no longer
        suffice to stop; it opens on resume, and when blocks come that it was closed for want of.
        A feed override that was lowered after a block was planned is a ceiling for that block.
Rule 3: an interval that was waited for, but not to its end, is chosen anew only if the throttle
        closes meanwhile: at a low rate it may be a long one.
Rule 4: where the throttle is open and the queue cannot run dry within the block in hand, it is
        calm: the ticks are played without asking here.
"""

from typing import Final

from fraese.motor.blockqueue import BlockQueue
from fraese.motor.cursor import Cursor
from fraese.motor.requests import Requests
from fraese.motor.seams import Ended
from fraese.motor.throttle import Throttle, ThrottleState
from fraese.motor.track import Track
from fraese.motor.wires import Wires

_OPEN: Final = ThrottleState.OPEN
_CLOSING_OR_HELD: Final = (ThrottleState.CLOSING, ThrottleState.HELD)
_MOVING: Final = (ThrottleState.CLOSING, ThrottleState.OPENING, ThrottleState.LIMITED)

#: Instead of an interval.
NO_TICK: Final = -1


class Governor:
    """The throttle, and when it opens and closes.

    Attributes:
        awaited_cycles: the interval that was begun and not waited to its end; 0: none.
        dry_queues: how often the queue ran dry.
    """

    def __init__(self, requests: Requests, queue: BlockQueue, track: Track, wires: Wires) -> None:
        self._requests = requests
        self._queue = queue
        self._track = track
        self._wires = wires
        self._throttle = Throttle()
        self._dry = False
        self._exit_cycles = 0
        self._top_rate_q8 = 0
        self._owes_signals = True
        self.awaited_cycles = 0
        self.dry_queues = 0

    @property
    def held(self) -> bool:
        """The throttle is closed: no tick is played."""
        return self._throttle.state is ThrottleState.HELD

    def resume(self) -> None:
        """Open the throttle again; not while braking for a watch that ends the run."""
        if not self._requests.drop_when_still:
            self._requests.brake_wanted = False
            self._open()

    def refilled(self) -> None:
        """A block has come."""
        if self._dry:
            self._open()

    def hold_if_wanted(self) -> None:
        """A brake at standstill holds what comes next."""
        if self._requests.brake_wanted:
            self._requests.brake_wanted = self._dry = False
            self._throttle.hold()

    def enter(self, cursor: Cursor) -> None:
        """A block begins: its limits, and the rate scaled to its own."""
        if cursor.leader_bit:
            self._throttle.junction(self._exit_cycles, cursor.entry_cycles)
            self._throttle.block(cursor.block.accel_q, cursor.jump_rate_q8, cursor.jump_cycles)
            from_rest = self._throttle.state is _OPEN and not self._exit_cycles
            if from_rest and cursor.is_above_jump(cursor.entry_cycles):
                # The plan begins at speed, but what came before it was late or dropped.
                self._throttle.hold()
                self._open()
        else:
            self._throttle.dwell()
        self._top_rate_q8 = 0
        if self._queue.may_run_dry or self._is_limited(cursor):
            self._requests.calm = False

    def _is_limited(self, cursor: Cursor) -> bool:
        """The override was lowered since this block was planned."""
        return cursor.block.override_q8 > self._requests.override_q8

    def _ceiling_q8(self, cursor: Cursor) -> int:
        if not self._is_limited(cursor):
            return 0
        if not self._top_rate_q8:
            self._top_rate_q8 = cursor.block.top_rate_q8()
        planned_q8 = cursor.block.override_q8
        return max(1, self._top_rate_q8 * self._requests.override_q8 // planned_q8)

    def leave(self, cursor: Cursor) -> None:
        """A block has ended: the next one's rate is scaled from here."""
        exit_q8 = cursor.interval_q8 - cursor.add_q8
        self._exit_cycles = exit_q8 >> 8 if cursor.leader_bit else 0

    def rest(self) -> None:
        """The motors stand: what comes next comes from standstill."""
        self.awaited_cycles = self._exit_cycles = 0
        self._owes_signals = True

    def finish(self, ended: Ended) -> None:
        """The run is over. A brake that came too late for it holds what comes next."""
        braked = self._throttle.state in _CLOSING_OR_HELD and not self._dry
        if ended is Ended.TARGET and braked:
            self._throttle.hold()
        else:
            self._throttle.reset()
        self._dry = False

    def interval(self, cursor: Cursor, plan_cycles: int) -> int:
        """The interval to the next tick when not all is calm, or ``NO_TICK``."""
        requests, throttle, last_cycles = self._requests, self._throttle, self._track.last_cycles
        if requests.stop_wanted:
            return NO_TICK
        state = throttle.state
        if state in _MOVING and last_cycles and not self.awaited_cycles:
            throttle.advance(last_cycles, cursor.ticks - cursor.done)
        if requests.brake_wanted:
            requests.brake_wanted = self._dry = False
            self._close()
        elif self._runs_dry(cursor, last_cycles):
            self._dry = True
            self.dry_queues += 1
            self._close()
        if self.awaited_cycles:
            cycles, self.awaited_cycles = self.awaited_cycles, 0
            return cycles
        if self._is_limited(cursor) or throttle.ceiling_q8:
            throttle.mind_ceiling(self._ceiling_q8(cursor), last_cycles)
        cycles = plan_cycles
        if throttle.state is not _OPEN:
            cycles = throttle.interval(plan_cycles, last_cycles)
        if (throttle.state is not state or self._owes_signals) and cycles >= 0:
            self._show_ramp(cursor)
        requests.be_calm(throttle.state is _OPEN and not self._queue.may_run_dry)
        return cycles

    def begin_piece(self, cursor: Cursor) -> None:
        """Tell the drives; where it is not calm, with the interval that is chosen next."""
        self._owes_signals = True
        if self._requests.calm:
            self._show_ramp(cursor)

    def _show_ramp(self, cursor: Cursor) -> None:
        """Tell the drives whether the rate changes, by the plan or by the throttle."""
        self._owes_signals = False
        self._wires.signal_ramp(self._throttle.state is not _OPEN or cursor.is_ramp)

    def _runs_dry(self, cursor: Cursor, last_cycles: int) -> bool:
        if not last_cycles or self._throttle.state in _CLOSING_OR_HELD:
            return False
        return self._queue.is_dry(cursor.done)

    def _close(self) -> None:
        self._throttle.close(self._track.last_cycles)
        self.awaited_cycles = 0

    def _open(self) -> None:
        self._dry = False
        self._throttle.open()
        self._requests.calm = False
