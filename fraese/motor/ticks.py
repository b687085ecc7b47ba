"""The beat: when each tick is due, and what happens when it comes late.

One tick, and what may come between two:

    ---edge-----------fall--------------------edge---
       | leader,       | clock lines low,        |
       | minors,       | then directions and     |
       | readings      | signals for the next    |
       |<---- interval of the plan, or longer -->|

A long interval is divided into 2, 4 or 8 beats, so that minor axes step more evenly:

    ---edge----beat----beat----beat----beat----beat----beat----beat----edge---
                         | a minor               | another             | leader

Rule 1: the leader steps on every tick, in its last beat, the others where Bresenham says; every
        step of every motor is made exactly once.
Rule 2: a tick in hand is finished. Stop, contact and brake act before the next one.
Rule 3: times are cycles since ``base_ns``. What a tick comes late by more than a sixteenth of its
        interval moves the base, and so all that follows: it is never caught up, since the interval
        after it would be shorter than the motor may follow. From a quarter on it is counted. With
        clock lines there may be less to spare: a pulse is never cut short.
Rule 4: before an edge the clock lines have been low for as long as a pulse, and the directions
        have stood for as long as the card wants. That may make an interval longer, never a pulse.
Rule 5: what will be written is made out before the wait, and counted after it: at the deadline
        only the writes remain.
"""

from typing import Final

from fraese.motor.cursor import Cursor, divisions
from fraese.motor.governor import Governor
from fraese.motor.requests import Requests
from fraese.motor.seams import Card, Clock, Entries
from fraese.motor.track import Track
from fraese.motor.wires import Wires

#: No interval is as long as this.
_NEVER_CYCLES: Final = 1 << 62


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
        self._pulse_cycles = card.pulse_cycles
        self._divided_from_cycles = 2 * card.beat_cycles or _NEVER_CYCLES

    @property
    def in_mid_tick(self) -> bool:
        """A beat of the tick in hand was played, others are to follow."""
        cursor = self._track.cursor
        return cursor is not None and cursor.beats_cycles > 0

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
        """Direction lines of the block, before its first tick; its outputs come with that."""
        self._wires.stale = cursor.outputs is not None
        entries = self._card.begin(cursor.directions, cursor.leader)
        if entries:
            self._wires.write(entries)
            written_cycles = max(self._due_cycles, self._fell_cycles)
            self._not_before_cycles = max(
                self._not_before_cycles, written_cycles + self._card.setup_cycles
            )

    def _play_piece(self, cursor: Cursor, end_ns: int) -> None:
        """The inner loop: ticks of one piece. Leaves early when time is up or none is wanted.

        One function, with all it needs in locals: calls and look-ups are what a tick costs.
        """
        track, governor, requests, wires = self._track, self._governor, self._requests, self._wires
        access, wait_until = wires.access, self._clock.wait_until
        tick, stepped = self._card.tick, self._card.stepped
        has_fall, pulse_cycles = bool(self._card.fall), self._card.pulse_cycles
        divided_from = self._divided_from_cycles if cursor.minors else _NEVER_CYCLES
        interval_q8, add_q8, left = cursor.interval_q8, cursor.add_q8, cursor.piece_left
        leader_bit = cursor.leader_bit
        due, base_ns, not_before = self._due_cycles, self._base_ns, self._not_before_cycles
        try:
            while left:
                if has_fall and self._fall_at_cycles:
                    if not self._fall(end_ns):
                        break
                    base_ns = self._base_ns
                moving = cursor.moving or cursor.settle()
                if cursor.beats_cycles:
                    cycles = cursor.beats_cycles
                elif requests.calm:
                    cycles = interval_q8 >> 8
                else:
                    cycles = governor.interval(cursor, interval_q8 >> 8)
                    if cycles < 0:
                        break
                    # Should the wait be broken off, this is what was waited for.
                    governor.awaited_cycles = cycles
                if cycles >= divided_from and moving != leader_bit:
                    if not self._play_beats(cursor, due, cycles, end_ns):
                        break
                    base_ns, moving = self._base_ns, moving & ~cursor.moved
                next_due = due + cycles
                if next_due < not_before:
                    next_due = not_before
                entries = tick(moving)
                deadline_ns = base_ns + (next_due * 125 >> 1)
                if deadline_ns > end_ns:
                    wait_until(end_ns)
                    break
                now_ns = wait_until(deadline_ns)
                governor.awaited_cycles = 0
                track.last_cycles = next_due - due
                if wires.stale:
                    entries = self._made_out_anew(cursor, moving)
                for register, value in entries:
                    access[register](value)
                if now_ns > deadline_ns:
                    base_ns += self._late(deadline_ns, now_ns, next_due - due)
                    self._base_ns = base_ns
                due = next_due
                stepped(moving)
                cursor.made()
                left -= 1
                interval_q8 += add_q8
                if has_fall:
                    # Half the plan's interval: a wait for directions does not lengthen a pulse.
                    self._fall_at_cycles = due + max(pulse_cycles, cycles >> 1)
                    not_before = self._fall_at_cycles + pulse_cycles
        finally:
            # Also on the way out of an interrupt: what was played must not be played again.
            cursor.interval_q8, cursor.piece_left = interval_q8, left
            self._due_cycles, self._base_ns, self._not_before_cycles = due, base_ns, not_before

    def _play_beats(self, cursor: Cursor, due: int, cycles: int, end_ns: int) -> bool:
        """The beats of a tick before its last; False: the time is up."""
        exponent = divisions(cycles, self._card.beat_cycles)
        beat_cycles = cycles >> exponent
        if not cursor.beats_cycles:
            cursor.divide(exponent)
        card, wires = self._card, self._wires
        while cursor.beats:
            beat, moving = cursor.beats[0]
            entries = card.tick(moving)
            deadline_ns = self._at_ns(due + beat * beat_cycles)
            if deadline_ns > end_ns:
                self._clock.wait_until(end_ns)
                return False
            now_ns = self._clock.wait_until(deadline_ns)
            self._governor.awaited_cycles = 0
            if wires.stale:
                entries = self._made_out_anew(cursor, moving)
            cursor.beats_cycles, cursor.moving_now = cycles, moving
            wires.write(entries)
            if now_ns > deadline_ns:
                self._base_ns += self._late(deadline_ns, now_ns, beat_cycles)
            card.stepped(moving)
            cursor.moved |= moving
            del cursor.beats[0]
        cursor.moving_now = ~cursor.moved
        return True

    def _made_out_anew(self, cursor: Cursor, moving: int) -> Entries:
        """The control register has changed since, or does so now: some entries contain it."""
        if cursor.outputs:
            self._wires.set_outputs(*cursor.outputs)
            cursor.outputs = None
        self._wires.stale = False
        return self._card.tick(moving)

    def _late(self, deadline_ns: int, began_ns: int, cycles: int) -> int:
        """How far to move all that follows, ns, for an edge that came late; after its writes.

        Whoever is interrupted may be so between the look at the clock and the writes too. Those
        take some time by themselves: only what is more than a quarter of the interval counts.
        """
        late_ns = began_ns - deadline_ns
        writing_ns = self._clock.now_ns() - began_ns
        if writing_ns * 8 > cycles * 125:
            late_ns += writing_ns
        self.late_ticks += late_ns * 8 > cycles * 125
        spare_cycles = cycles >> 4
        if self._pulse_cycles:
            spare_cycles = min(spare_cycles, max(0, (cycles >> 1) - self._pulse_cycles))
        return max(0, late_ns - (spare_cycles * 125 >> 1))

    def _fall(self, end_ns: int) -> bool:
        """Write the falling edge that is due; False if that is not before ``end_ns``."""
        fall_cycles = self._fall_at_cycles
        deadline_ns = self._at_ns(fall_cycles)
        if deadline_ns > end_ns:
            self._clock.wait_until(end_ns)
            return False
        now_ns = self._clock.wait_until(deadline_ns)
        self._fall_at_cycles = 0
        self._fell_cycles = fall_cycles
        self._wires.write(self._card.fall)
        if now_ns > deadline_ns:
            self._base_ns += self._late(deadline_ns, now_ns, self._track.last_cycles >> 1)
        return True

    def _at_ns(self, cycles: int) -> int:
        """A moment of this run, in the clock's time."""
        return self._base_ns + (cycles * 125 >> 1)
