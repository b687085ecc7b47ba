"""The polled motor core (SMCMOT): plays blocks on any card, any port, by any clock.

Rule 1: the leader steps on every tick, the others where Bresenham says; every step of every motor
        is made exactly once.
Rule 2: a tick in hand is finished. Stop, contact and brake act before the next one.
Rule 3: nothing changes path or plan. Brake, hold, resume and a dry queue work the throttle.
Rule 4: positions are not counted but follow from the block and the ticks done, so that a tick
        costs little and a count cannot drift.
Rule 5: a tick that comes late moves everything after it: the interval that follows is never
        shortened to catch up, since the motor could not follow. It is counted.

One tick, and what may come between two:

    ---edge-----------fall--------------------edge---
       | leader,       | clock lines low,        |
       | minors,       | then directions and     |
       | readings      | signals for the next    |
       |<---- interval of the plan, or longer -->|
"""

from collections import deque
from collections.abc import Callable
from typing import Final

from fraese.blocks import CYCLES_PER_S, Q8, RATE_Q8_CYCLES, Block, Outputs, WatchAction
from fraese.errors import StateError
from fraese.motor.cursor import Cursor
from fraese.motor.seams import (
    Card,
    Clock,
    Ended,
    Entries,
    IdleLevel,
    Port,
    Report,
    SwitchMode,
)
from fraese.motor.switches import InputWatcher, SwitchInput
from fraese.motor.throttle import SLICE_CYCLES, Throttle, ThrottleState

_NS_PER_S: Final = 1_000_000_000
#: The motor argument of a reading that belongs to no tick.
_BETWEEN_TICKS: Final = -2
#: Squared rate, in (tick/s)**2 / 65536, that one tick of braking sheds per unit of ``accel_q``.
_SHED_PER_TICK: Final = 2 * CYCLES_PER_S // 256


def _shed(block: Block, ticks: int) -> int:
    """Path energy that braking can shed within so many ticks of a block."""
    return block.weight * (block.accel_q * _SHED_PER_TICK >> 16) * ticks


def _require_sound(block: Block, motors: int) -> None:
    """Refuse what would make more or fewer steps than it says, or in no time at all.

    Raises:
        ValueError: with what is wrong.
    """
    if len(block.steps) != motors:
        raise ValueError(f"a block for {len(block.steps)} motors on a card for {motors}")
    longest = max(abs(n) for n in block.steps)
    if longest and block.ticks() != longest:
        raise ValueError(f"a block of {longest} steps with a time law of {block.ticks()} ticks")
    shortest_q8 = Q8 if longest else 0
    if any(min(p.interval_q8, p.last_interval_q8()) < shortest_q8 for p in block.pieces if p.ticks):
        raise ValueError("a time law with an interval of nothing")


class MotorCore:
    """The peer behind the StepDriver seam that drives a port itself.

    Args:
        port: registers to write; closed with the core.
        card: what they mean.
        clock: when.
        switch: the shared end-switch input.
        settle_s: wait after energising, before the first step.
        capacity: blocks that the queue takes.
        safe_outputs: free outputs that are off whenever the motors stand (a laser).
    """

    def __init__(
        self,
        port: Port,
        card: Card,
        clock: Clock,
        switch: SwitchInput = SwitchInput(),  # noqa: B008 (immutable)
        settle_s: float = 0.02,
        capacity: int = 256,
        safe_outputs: int = 0,
    ) -> None:
        self._port = port
        self._card = card
        self._clock = clock
        self._settle_ns = round(settle_s * _NS_PER_S)
        self._access: tuple[Callable[[int], object], ...] = (
            port.write_data,
            self._sample,
            port.write_control,
        )
        self._closed = False
        self._energised = False
        self._safe_outputs = safe_outputs
        self._outputs = 0

        self._queue: deque[Block] = deque()
        self._queued_shed = 0
        self._capacity = capacity
        self._resting_blocks = 0
        self._cursor: Cursor | None = None
        self._previous: Cursor | None = None
        self._serial = 0
        self._tag = 0
        self._base_steps = (0,) * card.motors
        self._travelled_steps = (0,) * card.motors

        self._standing = True
        self._base_ns = 0
        self._due_cycles = 0
        self._last_cycles = 0
        self._coming_cycles = 0
        self._fall_at_cycles = 0
        self._fell_cycles = 0
        self._not_before_cycles = 0
        self._exit_cycles = 0
        self._first_outputs: Outputs | None = None

        self._throttle = Throttle()
        self._calm = True
        self._brake_wanted = False
        self._stop_wanted = False
        self._stop_reason = Ended.STOP
        self._drop_when_still = False
        self._dry = False
        self._ended = Ended.NOT
        self._torn: frozenset[int] = frozenset()
        self._late_ticks = 0
        self._dry_queues = 0

        self._mode = SwitchMode.STOP
        self._inputs = InputWatcher(card.motors, switch)
        self._readings = switch.readings

        self._write(card.idle(IdleLevel.OFF))

    # --- commands ------------------------------------------------------------------------------

    def push(self, block: Block) -> bool:
        """Take a final block; False: the queue is full and nothing was taken.

        Raises:
            ValueError: if the block cannot be played as it says; nothing was taken.
        """
        _require_sound(block, self._card.motors)
        if len(self._queue) >= self._capacity:
            return False
        self._queue.append(block)
        self._queued_shed += _shed(block, block.ticks())
        self._resting_blocks += block.ends_at_rest
        if self._dry:
            self._open_throttle()
        return True

    def brake(self) -> None:
        """Close the throttle; the queue stays. From any thread."""
        self._brake_wanted = True
        self._calm = False

    def stop(self) -> None:
        """Finish the tick in hand, drop the rest. From any thread."""
        self._stop_wanted = True
        self._calm = False

    def resume(self) -> None:
        """Open the throttle again; not while braking for a watch that ends the run."""
        if not self._drop_when_still:
            self._brake_wanted = False
            self._open_throttle()

    def flush(self) -> None:
        """Drop the queue at standstill, and open the throttle for what comes next.

        Raises:
            StateError: while steps are being made.
        """
        self._require_standstill("the queue can only be dropped")
        self._finish(Ended.FLUSH)

    def idle(self, level: IdleLevel) -> None:
        """Set the standstill current.

        Raises:
            StateError: while steps are being made.
        """
        self._require_standstill("the motors can only be switched off")
        self._write(self._card.idle(level))
        self._energised = False

    def set_outputs(self, mask: int, value: int) -> None:
        """Change free outputs now; those that must be safe at standstill, at the next start."""
        now = mask & ~self._safe_outputs if self._standing else mask
        self._keep_outputs(mask, value)
        self._write(self._card.set_outputs(now, value))

    def set_switch_mode(self, mode: SwitchMode) -> None:
        """Choose what an end switch does to blocks that do not watch it."""
        self._mode = mode

    def close(self) -> None:
        """Motors and outputs off, port given back (MotEnd). Safe to call twice."""
        if self._closed:
            return
        self._closed = True
        try:
            self._finish(Ended.STOP)
        finally:
            self._switch_off()

    def poll(self, budget_s: float) -> Report:
        """Play for at most that long, in the core's clock, and say where things stand."""
        if self._brake_wanted and self._standing:
            self._brake_wanted = self._dry = False
            self._throttle.hold()
        if self._stop_wanted:
            self._finish(self._stop_reason)
        elif self._may_play():
            self._play(self._clock.now_ns() + round(budget_s * _NS_PER_S))
        else:
            self._sample(_BETWEEN_TICKS)
        return self._report()

    # --- playing -------------------------------------------------------------------------------

    def _may_play(self) -> bool:
        if self._throttle.state is ThrottleState.HELD:
            return False
        return self._cursor is not None or bool(self._queue)

    def _play(self, end_ns: int) -> None:
        if self._standing:
            self._start()
        while (cursor := self._cursor or self._next_block()) is not None:
            if not self._play_block(cursor, end_ns):
                return
            self._end_block(cursor)

    def _start(self) -> None:
        """From standstill: current on, the input known, and time starts now."""
        if not self._energised:
            self._write(self._card.energise())
            self._energised = True
            self._clock.wait_until(self._clock.now_ns() + self._settle_ns)
        for _ in range(self._readings):
            self._sample(_BETWEEN_TICKS)
        self._write(self._card.set_outputs(self._safe_outputs, self._outputs))
        self._write(self._card.signals(True, True))
        self._standing = False
        self._base_ns = self._clock.now_ns()
        self._not_before_cycles = 0
        self._ended = Ended.NOT
        self._torn = frozenset()

    def _next_block(self) -> Cursor | None:
        if not self._queue:
            self._finish(Ended.WATCH if self._drop_when_still else Ended.TARGET)
            return None
        block = self._queue.popleft()
        cursor = self._cursor = Cursor(block)
        self._serial += 1
        self._queued_shed -= _shed(block, cursor.ticks)
        self._tag = block.tag
        if cursor.leader_bit:
            self._throttle.junction(self._exit_cycles, block.pieces[0].interval_q8 >> 8)
            self._throttle.block(block.accel_q, block.jump_rate_q8)
            self._open_from_rest(block)
        else:
            self._throttle.dwell()
        self._inputs.begin(block)
        self._act_on_switch()
        self._first_outputs = block.outputs
        if not self._resting_blocks:
            self._calm = False
        return cursor

    def _open_from_rest(self, block: Block) -> None:
        """A plan that begins at speed, but what came before it was late or dropped."""
        entry_cycles = block.pieces[0].interval_q8 >> 8
        opened = self._throttle.state is ThrottleState.OPEN
        if opened and not self._exit_cycles and _is_above(block.jump_rate_q8, entry_cycles):
            self._throttle.hold()
            self._open_throttle()

    def _set_up(self, cursor: Cursor) -> None:
        """Direction lines of the block, before its first tick."""
        entries = self._card.begin(cursor.directions, cursor.leader)
        if entries:
            self._write(entries)
            written_cycles = max(self._due_cycles, self._fell_cycles)
            self._not_before_cycles = max(
                self._not_before_cycles, written_cycles + self._card.setup_cycles
            )

    def _play_block(self, cursor: Cursor, end_ns: int) -> bool:
        """Play until the block is done (True), or the time is up, or something ended the run."""
        while True:
            if self._fall_at_cycles and not self._fall(end_ns):
                return False
            if not cursor.piece_left:
                if not cursor.next_piece():
                    return True
                if not cursor.done:
                    self._set_up(cursor)
                self._show_ramp(cursor)
            self._play_piece(cursor, end_ns)
            if self._stop_wanted:
                self._finish(self._stop_reason)
                return False
            if self._throttle.state is ThrottleState.HELD:
                self._stand_held()
                return False
            if cursor.piece_left:
                return False

    def _show_ramp(self, cursor: Cursor) -> None:
        """Tell the drives whether the rate changes, by the plan or by the throttle."""
        throttled = self._throttle.state is not ThrottleState.OPEN
        self._write(self._card.signals(True, throttled or bool(cursor.add_q8)))

    def _play_piece(self, cursor: Cursor, end_ns: int) -> None:
        """The inner loop: ticks of one piece. Leaves early when time is up or the rate is nil."""
        access, tick, wait_until = self._access, self._card.tick, self._clock.wait_until
        has_fall, pulse_cycles = bool(self._card.fall), self._card.pulse_cycles
        leader_bit, minors, ticks = cursor.leader_bit, cursor.minors, cursor.ticks
        interval_q8, add_q8 = cursor.interval_q8, cursor.add_q8
        done, left = cursor.done, cursor.piece_left
        due, base_ns = self._due_cycles, self._base_ns
        not_before, first_outputs = self._not_before_cycles, self._first_outputs
        try:
            while left:
                if has_fall and self._fall_at_cycles:
                    if not self._fall(end_ns):
                        break
                    base_ns = self._base_ns
                if self._calm:
                    cycles = interval_q8 >> 8
                else:
                    cycles = self._governed(cursor, interval_q8 >> 8)
                    if cycles < 0:
                        break
                next_due = due + cycles
                if next_due < not_before:
                    next_due = not_before
                deadline_ns = base_ns + (next_due * 125 >> 1)
                if deadline_ns > end_ns:
                    if not self._calm:
                        self._coming_cycles = cycles
                    wait_until(end_ns)
                    break
                now_ns = wait_until(deadline_ns)
                if now_ns > deadline_ns:
                    base_ns += self._late(now_ns - deadline_ns, next_due - due)
                    self._base_ns = base_ns
                self._last_cycles = next_due - due
                due = next_due
                moving = leader_bit
                for minor in minors:
                    accumulator = minor[0] + minor[1]
                    if accumulator >= ticks:
                        accumulator -= ticks
                        moving |= minor[2]
                    minor[0] = accumulator
                if first_outputs:
                    self._change_outputs(first_outputs)
                    first_outputs = None
                for register, value in tick(moving):
                    access[register](value)
                done += 1
                cursor.done = done
                left -= 1
                interval_q8 += add_q8
                if has_fall:
                    # Half the plan's interval: a wait for directions does not lengthen a pulse.
                    self._fall_at_cycles = due + max(pulse_cycles, cycles >> 1)
                    not_before = self._fall_at_cycles + pulse_cycles
        finally:
            # Also on the way out of an interrupt: what was played must not be played again.
            cursor.interval_q8, cursor.piece_left = interval_q8, left
            self._due_cycles, self._base_ns = due, base_ns
            self._not_before_cycles, self._first_outputs = not_before, first_outputs

    def _governed(self, cursor: Cursor, plan_cycles: int) -> int:
        """The interval when not all is calm; negative: no tick now."""
        if self._stop_wanted:
            return -1
        throttle = self._throttle
        state = throttle.state
        if self._brake_wanted:
            self._brake_wanted = self._dry = False
            self._close_throttle()
        elif self._running_dry(cursor):
            self._dry = True
            self._dry_queues += 1
            self._close_throttle()
        if self._coming_cycles:
            cycles, self._coming_cycles = self._coming_cycles, 0
            return cycles
        cycles = plan_cycles
        if throttle.state is not ThrottleState.OPEN:
            cycles = throttle.interval(plan_cycles, self._last_cycles)
        if throttle.state is not state and cycles >= 0:
            self._show_ramp(cursor)
        self._be_calm(throttle.state is ThrottleState.OPEN and self._resting_blocks > 0)
        return cycles

    def _be_calm(self, calm: bool) -> None:
        """Whether ticks may be played without a look at the throttle.

        The flags are read after the change: a brake from another thread may come in between.
        """
        self._calm = calm
        if self._stop_wanted or self._brake_wanted:
            self._calm = False

    def _close_throttle(self) -> None:
        self._throttle.close(self._last_cycles)
        # The interval that was waited for is chosen anew: at a low rate it may be a long one.
        self._coming_cycles = 0

    def _open_throttle(self) -> None:
        self._dry = False
        self._throttle.open()
        self._calm = False

    def _running_dry(self, cursor: Cursor) -> bool:
        """What is queued no longer suffices to stop from the present rate."""
        if self._resting_blocks or not self._last_cycles:
            return False
        if self._throttle.state in (ThrottleState.CLOSING, ThrottleState.HELD):
            return False
        block = cursor.block
        rate_hz = CYCLES_PER_S // self._last_cycles
        jump_hz = block.jump_rate_q8 >> 8
        reserve = SLICE_CYCLES // self._last_cycles + 2
        left = max(0, cursor.ticks - cursor.done - reserve)
        return block.weight * (rate_hz**2 - jump_hz**2) > _shed(block, left) + self._queued_shed

    def _late(self, late_ns: int, cycles: int) -> int:
        """How far to move all that follows: an edge later than a quarter of its interval."""
        if late_ns * 8 <= cycles * 125:
            return 0
        self._late_ticks += 1
        return late_ns

    def _fall(self, end_ns: int) -> bool:
        """Write the falling edge that is due; False if that is not before ``end_ns``."""
        fall_cycles = self._fall_at_cycles
        deadline_ns = self._base_ns + (fall_cycles * 125 >> 1)
        if deadline_ns > end_ns:
            self._clock.wait_until(end_ns)
            return False
        now_ns = self._clock.wait_until(deadline_ns)
        if now_ns > deadline_ns:
            self._base_ns += self._late(now_ns - deadline_ns, self._last_cycles >> 1)
        self._fall_at_cycles = 0
        self._fell_cycles = fall_cycles
        self._write(self._card.fall)
        return True

    # --- coming to rest ------------------------------------------------------------------------

    def _above_jump(self, cursor: Cursor) -> bool:
        """The rate last played is one that the motors cannot stop from without a ramp."""
        if not self._last_cycles or not cursor.leader_bit:
            return False
        return _is_above(cursor.block.jump_rate_q8, self._last_cycles)

    def _end_block(self, cursor: Cursor) -> None:
        if self._first_outputs and cursor.done == cursor.ticks:
            # A block without any tick.
            self._change_outputs(self._first_outputs)
        self._first_outputs = None
        moved = cursor.steps_at(cursor.done)
        self._base_steps = tuple(a + b for a, b in zip(self._base_steps, moved, strict=True))
        self._travelled_steps = tuple(
            a + abs(b) for a, b in zip(self._travelled_steps, moved, strict=True)
        )
        self._inputs.end(self._clock.now_ns())
        exit_q8 = cursor.interval_q8 - cursor.add_q8
        self._exit_cycles = exit_q8 >> 8 if cursor.leader_bit else 0
        self._resting_blocks -= cursor.block.ends_at_rest
        self._cursor = None
        # Stopped before its first tick: it is the block before that still moved.
        moved_last = cursor if cursor.done else self._previous
        if not self._queue and moved_last and self._above_jump(moved_last):
            self._torn = self._torn | _motors_of(moved_last)
        self._previous = moved_last

    def _finish(self, ended: Ended) -> None:
        """The run is over: drop what is left, tell the card, say why."""
        self._drop_queue()
        if self._cursor is not None:
            self._end_block(self._cursor)
        self._resting_blocks = 0
        if ended is not Ended.TARGET:
            # What ended before its end must not switch a laser on again at the next start.
            self._outputs &= ~self._safe_outputs
        self._rest_lines()
        braked = self._throttle.state in (ThrottleState.CLOSING, ThrottleState.HELD)
        if ended is Ended.TARGET and braked and not self._dry:
            self._throttle.hold()
        else:
            self._throttle.reset()
        if ended is not Ended.TARGET:
            self._brake_wanted = False
        self._ended = ended
        self._stop_wanted = self._drop_when_still = self._dry = False
        self._stop_reason = Ended.STOP
        self._be_calm(True)

    def _drop_queue(self) -> None:
        self._serial += len(self._queue)
        self._queue.clear()
        self._queued_shed = 0

    def _stand_held(self) -> None:
        """The throttle has closed: motors stand, the queue waits."""
        if self._drop_when_still:
            self._finish(Ended.WATCH)
        else:
            self._rest_lines()

    def _switch_off(self) -> None:
        """The last writes, whatever went wrong before them."""
        try:
            self._write(self._card.set_outputs(~0, 0))
            self._write(self._card.idle(IdleLevel.OFF))
            self._energised = False
        finally:
            self._port.close()

    def _rest_lines(self) -> None:
        """Clock lines low, ACTIVE and BOOST low, outputs that must be safe off; no time runs."""
        if self._fall_at_cycles:
            self._fall(self._base_ns + (self._fall_at_cycles * 125 >> 1))
        self._write(self._card.signals(False, False))
        self._write(self._card.set_outputs(self._safe_outputs, 0))
        self._standing = True
        self._last_cycles = self._due_cycles = self._coming_cycles = 0
        self._fell_cycles = self._exit_cycles = 0
        self._previous = None

    def _keep_outputs(self, mask: int, value: int) -> None:
        self._outputs = self._outputs & ~mask | value & mask

    def _change_outputs(self, outputs: Outputs) -> None:
        self._keep_outputs(*outputs)
        self._write(self._card.set_outputs(*outputs))

    def _require_standstill(self, what: str) -> None:
        if not self._standing:
            raise StateError(f"The motors run: {what} at standstill; brake or stop first.")

    # --- inputs --------------------------------------------------------------------------------

    def _sample(self, motor: int) -> None:
        """Read the status register after ``motor`` has made its step."""
        status = self._port.read_status()
        if status != self._inputs.quiet_status:
            self._examine(status, motor)

    def _examine(self, status: int, motor: int) -> None:
        fulfilled = self._inputs.take(status, lambda: self._steps_now(motor), self._clock.now_ns())
        if fulfilled:
            self._act_on_watch()
        self._act_on_switch()

    def _act_on_watch(self) -> None:
        cursor = self._cursor
        if cursor is None or cursor.block.watch is None:
            return
        action = cursor.block.watch.action
        if action is WatchAction.IGNORE:
            return
        if action is WatchAction.STOP:
            self._drop_when_still = True
            if not self._above_jump(cursor):
                self._stop_reason = Ended.WATCH
                self.stop()
                return
        self.brake()

    def _act_on_switch(self) -> None:
        """A contact stops the block in hand, in stop mode and unless the block watches for it."""
        if self._drop_when_still:
            return  # a watch has seen it already, and the motors are on their way to rest
        if self._mode is SwitchMode.STOP and self._cursor and self._inputs.switch_acts:
            self._stop_reason = Ended.SWITCH
            self.stop()

    # --- facts ---------------------------------------------------------------------------------

    def _steps_now(self, motor: int = _BETWEEN_TICKS) -> tuple[int, ...]:
        cursor = self._cursor
        if cursor is None:
            return self._base_steps
        moved = (
            cursor.steps_at(cursor.done)
            if motor == _BETWEEN_TICKS
            else cursor.steps_within_tick(motor)
        )
        return tuple(a + b for a, b in zip(self._base_steps, moved, strict=True))

    def _next_due_ns(self, cursor: Cursor) -> int:
        cycles = self._coming_cycles or cursor.interval_q8 >> 8
        next_cycles = max(self._due_cycles + cycles, self._not_before_cycles)
        return self._base_ns + (next_cycles * 125 >> 1)

    def _report(self) -> Report:
        cursor, inputs = self._cursor, self._inputs
        moved = cursor.steps_at(cursor.done) if cursor else (0,) * self._card.motors
        moving_cycles = self._last_cycles if cursor and cursor.leader_bit else 0
        return Report(
            position_steps=tuple(a + b for a, b in zip(self._base_steps, moved, strict=True)),
            travelled_steps=tuple(
                a + abs(b) for a, b in zip(self._travelled_steps, moved, strict=True)
            ),
            playing=self._serial,
            tag=self._tag,
            tick=cursor.done if cursor else 0,
            free=self._capacity - len(self._queue),
            queued=len(self._queue) + (cursor is not None),
            due_ns=self._next_due_ns(cursor) if cursor and not self._standing else 0,
            rate_hz=CYCLES_PER_S / moving_cycles if moving_cycles else 0.0,
            running=self._may_play(),
            held=self._throttle.state is ThrottleState.HELD,
            energised=self._energised,
            inputs=inputs.status,
            switch_closed=inputs.switch_closed,
            candidates=inputs.candidates,
            latched_steps=inputs.latched_steps,
            ended=self._ended,
            torn=self._torn,
            late_ticks=self._late_ticks,
            dry_queues=self._dry_queues,
            phases=self._card.phases(),
        )

    def _write(self, entries: Entries) -> None:
        access = self._access
        for register, value in entries:
            access[register](value)


def _is_above(jump_rate_q8: int, cycles: int) -> bool:
    """An interval is shorter than that of a start/stop rate, or nothing.

    Intervals are cut to whole cycles: a sixteenth covers that.
    """
    return not cycles or RATE_Q8_CYCLES // cycles > jump_rate_q8 + (jump_rate_q8 >> 4)


def _motors_of(cursor: Cursor) -> frozenset[int]:
    return frozenset(motor for motor, n in enumerate(cursor.block.steps) if n)
