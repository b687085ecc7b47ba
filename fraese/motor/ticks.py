"""The beat: when each tick is due, and what happens when it comes late.

One tick, and what may come between two:

    ---edge-----------fall--------------------edge---
       | leader,       | clock lines low,        |
       | minors,       | then directions and     |
       | readings      | signals for the next    |
       |<---- interval of the plan, or longer -->|

Rule 1: the leader steps on every tick, the others where Bresenham says; every step of every motor
        is made exactly once.
Rule 2: a tick in hand is finished. Stop, contact and brake act before the next one.
Rule 3: times are cycles since ``base_ns``. A tick that comes late moves the base, and so all that
        follows: the interval after it is never shortened to catch up, since the motor could not
        follow. It is counted.
Rule 4: before an edge the clock lines have been low for as long as a pulse, and the directions
        have stood for as long as the card wants. That may make an interval longer, never a pulse.
"""

from fraese.motor.cursor import Cursor
from fraese.motor.governor import Governor
from fraese.motor.requests import Requests
from fraese.motor.seams import Card, Clock
from fraese.motor.track import Track
from fraese.motor.wires import Wires


class Ticks:
    """Plays the ticks of a block.

    Attributes:
        late_ticks: edges that came late by more than a quarter of their interval.
    """

    def __init__(
        self,
        clock: Clock,
        card: Card,
        wires: Wires,
        track: Track,
        governor: Governor,
        requests: Requests,
    ) -> None:
        self._clock = clock
        self._card = card
        self._wires = wires
        self._track = track
        self._governor = governor
        self._requests = requests
        self.late_ticks = 0
        self._base_ns = 0
        self._due_cycles = 0
        self._fall_at_cycles = 0
        self._fell_cycles = 0
        self._not_before_cycles = 0

    def start(self) -> None:
        """Time starts now."""
        self._base_ns = self._clock.now_ns()
        self._not_before_cycles = 0

    def rest(self) -> None:
        """Clock lines low; no time runs."""
        if self._fall_at_cycles:
            self._fall(self._at_ns(self._fall_at_cycles))
        self._due_cycles = self._fell_cycles = 0

    def next_due_ns(self, cursor: Cursor) -> int:
        """When the next tick of the block is due."""
        cycles = self._governor.awaited_cycles or cursor.interval_q8 >> 8
        return self._at_ns(max(self._due_cycles + cycles, self._not_before_cycles))

    def play(self, cursor: Cursor, end_ns: int) -> bool:
        """Play until the block is done (True), or the time is up, or no further tick is wanted."""
        while True:
            if self._fall_at_cycles and not self._fall(end_ns):
                return False
            if not cursor.piece_left:
                if not cursor.next_piece():
                    return True
                if not cursor.done:
                    self._set_up(cursor)
                self._governor.show_ramp(cursor)
            self._play_piece(cursor, end_ns)
            if cursor.piece_left or self._requests.stop_wanted:
                return False

    def _set_up(self, cursor: Cursor) -> None:
        """Direction lines of the block, before its first tick."""
        entries = self._card.begin(cursor.directions, cursor.leader)
        if entries:
            self._wires.write(entries)
            written_cycles = max(self._due_cycles, self._fell_cycles)
            self._not_before_cycles = max(
                self._not_before_cycles, written_cycles + self._card.setup_cycles
            )

    def _play_piece(self, cursor: Cursor, end_ns: int) -> None:
        """The inner loop: ticks of one piece. Leaves early when time is up or none is wanted.

        It is one function, with all it needs in locals, since calls and look-ups are what a tick
        costs.
        """
        track, governor, requests, wires = self._track, self._governor, self._requests, self._wires
        access, tick, wait_until = wires.access, self._card.tick, self._clock.wait_until
        has_fall, pulse_cycles = bool(self._card.fall), self._card.pulse_cycles
        leader_bit, minors, ticks = cursor.leader_bit, cursor.minors, cursor.ticks
        interval_q8, add_q8 = cursor.interval_q8, cursor.add_q8
        done, left = cursor.done, cursor.piece_left
        due, base_ns, not_before = self._due_cycles, self._base_ns, self._not_before_cycles
        outputs = cursor.outputs
        try:
            while left:
                if has_fall and self._fall_at_cycles:
                    if not self._fall(end_ns):
                        break
                    base_ns = self._base_ns
                if requests.calm:
                    cycles = interval_q8 >> 8
                else:
                    cycles = governor.interval(cursor, interval_q8 >> 8)
                    if cycles < 0:
                        break
                next_due = due + cycles
                if next_due < not_before:
                    next_due = not_before
                deadline_ns = base_ns + (next_due * 125 >> 1)
                if deadline_ns > end_ns:
                    if not requests.calm:
                        governor.awaited_cycles = cycles
                    wait_until(end_ns)
                    break
                now_ns = wait_until(deadline_ns)
                if now_ns > deadline_ns:
                    base_ns += self._late(now_ns - deadline_ns, next_due - due)
                    self._base_ns = base_ns
                track.last_cycles = next_due - due
                due = next_due
                moving = leader_bit
                for minor in minors:
                    accumulator = minor[0] + minor[1]
                    if accumulator >= ticks:
                        accumulator -= ticks
                        moving |= minor[2]
                    minor[0] = accumulator
                if outputs:
                    wires.set_outputs(*outputs)
                    outputs = None
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
            cursor.interval_q8, cursor.piece_left, cursor.outputs = interval_q8, left, outputs
            self._due_cycles, self._base_ns, self._not_before_cycles = due, base_ns, not_before

    def _late(self, late_ns: int, cycles: int) -> int:
        """How far to move all that follows: an edge later than a quarter of its interval."""
        if late_ns * 8 <= cycles * 125:
            return 0
        self.late_ticks += 1
        return late_ns

    def _fall(self, end_ns: int) -> bool:
        """Write the falling edge that is due; False if that is not before ``end_ns``."""
        fall_cycles = self._fall_at_cycles
        deadline_ns = self._at_ns(fall_cycles)
        if deadline_ns > end_ns:
            self._clock.wait_until(end_ns)
            return False
        now_ns = self._clock.wait_until(deadline_ns)
        if now_ns > deadline_ns:
            self._base_ns += self._late(now_ns - deadline_ns, self._track.last_cycles >> 1)
        self._fall_at_cycles = 0
        self._fell_cycles = fall_cycles
        self._wires.write(self._card.fall)
        return True

    def _at_ns(self, cycles: int) -> int:
        """A moment of this run, in the clock's time."""
        return self._base_ns + (cycles * 125 >> 1)
