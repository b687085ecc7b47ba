"""The beat: when each tick is due, and what happens when it comes late.

    ---edge--------------------------------edge---
       | leader, minors, readings            |
       |<-- interval of the plan, or longer -->|

A long interval is divided into 2, 4 or 8 beats, so that minor axes step more evenly:

    ---edge----beat----beat----beat----beat----beat----beat----beat----edge---
                         | a minor               | another             | leader

Rule 1: the leader steps on every tick, in its last beat, the others where Bresenham says; every
        step of every motor is made exactly once.
Rule 2: a tick in hand is finished. Stop, contact and brake act before the next one.
Rule 3: times are cycles since ``base_ns``. What a tick comes late by more than a sixteenth of its
        interval moves the base, and so all that follows: it is never caught up, since the interval
        after it would be shorter than the motor may follow. From a quarter on it is counted.
Rule 4: what will be written is made out before the wait, and counted after it: at the deadline
        only the writes remain.
Rule 5: in a long wait the inputs are read too, every ``READING_CYCLES``; what they ask for acts
        there and then.

Clock lines have their own ticks: ``pulses.py``.
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
#: From one reading to the next in a long wait, 8 ms,
READING_CYCLES: Final = 1 << 17
#: and from the last one to the end of the wait, at least.
_LAST_CYCLES: Final = 1 << 13


class Ticks:
    """Plays the ticks of a block, on a card without clock lines.

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
        self._beat_at_cycles = 0
        self._wait_from_cycles = self._reading_at_cycles = 0
        self._divided_from_cycles = 2 * card.beat_cycles or _NEVER_CYCLES

    @property
    def in_mid_tick(self) -> bool:
        """A beat of the tick in hand was played, others are to follow."""
        cursor = self._track.cursor
        return cursor is not None and cursor.beats_cycles > 0

    def start(self) -> None:
        """Time starts now."""
        self._base_ns = self._clock.now_ns()
        self._beat_at_cycles = 0
        self._wait_from_cycles = -1

    def rest(self) -> None:
        """No time runs."""
        self._due_cycles = 0

    def next_due_ns(self, cursor: Cursor) -> int:
        """When the next tick of the block is due."""
        cycles = self._governor.awaited_cycles or cursor.interval_q8 >> 8
        return self._at_ns(self._due_cycles + cycles)

    def play(self, cursor: Cursor, end_ns: int) -> bool:
        """Play until the block is done (True), or the time is up, or no further tick is wanted."""
        while self._finish_tick(end_ns):
            if not cursor.piece_left:
                if not cursor.next_piece():
                    return True
                self._begin_piece(cursor)
            self._play_piece(cursor, end_ns)
            if cursor.piece_left or self._requests.stop_wanted:
                return False
        return False

    def _finish_tick(self, end_ns: int) -> bool:
        """What is left to do of the tick before; False: that comes later than ``end_ns``."""
        return True

    def _begin_piece(self, cursor: Cursor) -> None:
        """Before its first tick; the outputs of a block come with that."""
        if not cursor.done:
            self._wires.stale = cursor.outputs is not None
            self._wires.write(self._card.begin(cursor.directions, cursor.leader))

    def _play_piece(self, cursor: Cursor, end_ns: int) -> None:
        """The inner loop: ticks of one piece. Leaves early when time is up or none is wanted.

        One function, with all it needs in locals: calls and look-ups are what a tick costs.
        """
        track, governor, requests, wires = self._track, self._governor, self._requests, self._wires
        access, wait_until = wires.access, self._clock.wait_until
        tick, stepped = self._card.tick, self._card.stepped
        divided_from = self._divided_from_cycles if cursor.minors else _NEVER_CYCLES
        interval_q8, add_q8, left = cursor.interval_q8, cursor.add_q8, cursor.piece_left
        leader_bit = cursor.leader_bit
        due, base_ns = self._due_cycles, self._base_ns
        try:
            while left:
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
                entries = tick(moving)
                deadline_ns = base_ns + (next_due * 125 >> 1)
                if cycles > READING_CYCLES and not self._read_until(
                    max(due, self._beat_at_cycles), next_due, end_ns
                ):
                    break
                if deadline_ns > end_ns:
                    wait_until(end_ns)
                    break
                now_ns = wait_until(deadline_ns)
                governor.awaited_cycles = 0
                track.last_cycles = cycles
                if wires.stale:
                    entries = self._made_out_anew(cursor, moving)
                for register, value in entries:
                    access[register](value)
                if now_ns > deadline_ns:
                    base_ns += self._late(deadline_ns, now_ns, cycles, cycles >> 4)
                    self._base_ns = base_ns
                due = next_due
                stepped(moving)
                cursor.made()
                left -= 1
                interval_q8 += add_q8
        finally:
            # Also on the way out of an interrupt: what was played must not be played again.
            cursor.interval_q8, cursor.piece_left = interval_q8, left
            self._due_cycles, self._base_ns = due, base_ns

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
            at_cycles = due + beat * beat_cycles
            deadline_ns = self._at_ns(at_cycles)
            if cycles > READING_CYCLES and not self._read_until(
                max(due, self._beat_at_cycles), at_cycles, end_ns
            ):
                return False
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
                self._base_ns += self._late(deadline_ns, now_ns, beat_cycles, beat_cycles >> 4)
            card.stepped(moving)
            cursor.moved |= moving
            self._beat_at_cycles = at_cycles
            del cursor.beats[0]
        cursor.moving_now = ~cursor.moved
        return True

    def _read_until(self, from_cycles: int, until_cycles: int, end_ns: int) -> bool:
        """Read the inputs in a long wait.

        Args:
            from_cycles: its begin, the last edge or beat.
            until_cycles: its end.
            end_ns: nothing is done after this.

        Returns:
            False: the time is up, or a reading wants something before the tick is in hand.
        """
        if from_cycles != self._wait_from_cycles:
            self._wait_from_cycles = from_cycles
            self._reading_at_cycles = from_cycles + READING_CYCLES
        while self._reading_at_cycles + _LAST_CYCLES <= until_cycles:
            at_ns = self._at_ns(self._reading_at_cycles)
            if at_ns > end_ns:
                self._clock.wait_until(end_ns)
                return False
            self._clock.wait_until(at_ns)
            self._reading_at_cycles += READING_CYCLES
            self._wires.sample()
            if self._requests.is_pressing and not self._is_in_hand:
                return False
        return True

    @property
    def _is_in_hand(self) -> bool:
        """Something of the present tick was written: it will be finished."""
        return self.in_mid_tick

    def _made_out_anew(self, cursor: Cursor, moving: int) -> Entries:
        """The control register has changed since, or does so now: some entries contain it."""
        if cursor.outputs:
            self._wires.set_outputs(*cursor.outputs)
            cursor.outputs = None
        self._wires.stale = False
        return self._card.tick(moving)

    def _late(self, deadline_ns: int, began_ns: int, cycles: int, spare_cycles: int) -> int:
        """How far to move all that follows, ns, for an edge that came late; after its writes.

        Whoever is interrupted may be so between the look at the clock and the writes too. Those
        take some time by themselves: only what is more than a quarter of the interval counts.

        Args:
            deadline_ns: when it was due.
            began_ns: when its writes began.
            cycles: its interval.
            spare_cycles: so much is made up for by what follows.
        """
        late_ns = began_ns - deadline_ns
        writing_ns = self._clock.now_ns() - began_ns
        if writing_ns * 8 > cycles * 125:
            late_ns += writing_ns
        self.late_ticks += late_ns * 8 > cycles * 125
        return max(0, late_ns - (spare_cycles * 125 >> 1))

    def _at_ns(self, cycles: int) -> int:
        """A moment of this run, in the clock's time."""
        return self._base_ns + (cycles * 125 >> 1)
