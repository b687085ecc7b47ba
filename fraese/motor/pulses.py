"""Ticks on clock lines: a pause and a pulse each, an edge between them.

    plan        |<------------- interval ------------->|<----------- interval ...
                |<----- pause ----->|<---- pulse ----->|
    clock  _____|___________________|~~~~~~~~~~~~~~~~~~|________________|~~~~~
                ^ directions, ACTIVE,  ^ leader and     ^ the next interval is chosen;
                  BOOST                  minors, reading  directions, BOOST

Rule 1: the pulse is the card's share of the interval, one half unless it says otherwise, and ends
        with it. So pause and pulse of a tick are equal in ramps too, the minors' pulses are as long
        as the leader's, and a ramp down is the mirror image of the ramp up.
Rule 2: neither pulse nor pause is ever shorter than the card's shortest pulse. That may make an
        interval longer.
Rule 3: where a run begins, the first edge comes as soon as the directions have stood for their
        time: there is no interval to keep, unless the last fall was a pause ago or less. Between
        two blocks, directions that turn may make a pause longer.
Rule 4: the directions turn, and BOOST changes, with the fall between two ticks. ACTIVE comes with
        the first directions and goes with the last fall.
Rule 5: an edge that comes late moves what follows by what the pause or pulse after it cannot spare.

Rules 1, 2, 4 and 5 of ``ticks.py`` hold here as well.
"""

from typing import Final

from fraese.blocks import ramps
from fraese.motor.cursor import Cursor
from fraese.motor.governor import Governor
from fraese.motor.requests import Requests
from fraese.motor.seams import HALF_Q16, Card, Clock, Entries
from fraese.motor.ticks import READING_CYCLES, Ticks
from fraese.motor.track import Track
from fraese.motor.wires import Wires

#: Before any run.
_LONG_AGO_NS: Final = 1 << 62


class Pulses(Ticks):
    """Plays the ticks of a block, on a card with clock lines."""

    def __init__(
        self,
        clock: Clock,
        card: Card,
        wires: Wires,
        track: Track,
        governor: Governor,
        requests: Requests,
    ) -> None:
        super().__init__(clock, card, wires, track, governor, requests)
        self._shortest_cycles = card.pulse_cycles
        self._duty_q16 = card.duty_q16
        self._ramps = iter(ramps((), moves=False))
        #: The clock is up until then; 0: it rests.
        self._fall_at_cycles = 0
        #: The last fall came so late.
        self._behind_ns = 0
        #: The next edge keeps rules of its own: it begins a run, or its directions have turned.
        self._is_special = self._from_rest = False
        self._turned_at_cycles = 0
        #: The last fall of the run before; and on the scale of this one.
        self._fell_ns = -_LONG_AGO_NS
        self._fell_cycles = 0

    def start(self) -> None:
        """Time starts now."""
        super().start()
        self._behind_ns = self._turned_at_cycles = 0
        self._from_rest = self._is_special = True
        self._fell_cycles = (self._fell_ns - self._base_ns) * 2 // 125

    def rest(self) -> None:
        """Clock lines low; no time runs."""
        if self._fall_at_cycles:
            self._fall(self._at_ns(self._fall_at_cycles))
        if self._due_cycles:
            self._fell_ns = self._at_ns(self._due_cycles)
        super().rest()

    def next_due_ns(self, cursor: Cursor) -> int:
        """When the clock lines rise next."""
        cycles = self._governor.awaited_cycles or cursor.interval_q8 >> 8
        cycles = max(cycles, 2 * self._shortest_cycles)
        return self._at_ns(self._rise_at(cursor, cycles - self._pulse(cycles)))

    def _finish_tick(self, end_ns: int) -> bool:
        """Its pulse ends."""
        return not self._fall_at_cycles or self._fall(end_ns)

    def _begin_piece(self, cursor: Cursor) -> None:
        """Directions of a block before its first tick, and what the drives are told."""
        if not cursor.done:
            self._ramps = iter(ramps(cursor.block.pieces, moves=bool(cursor.leader_bit)))
            self._wires.stale = cursor.outputs is not None
            entries = self._card.begin(cursor.directions, cursor.leader)
            if entries:
                self._turn(entries)
        cursor.is_ramp = next(self._ramps)
        self._governor.begin_piece(cursor)

    def _play_piece(self, cursor: Cursor, end_ns: int) -> None:
        """The inner loop, as that of its parent."""
        track, governor, requests, wires = self._track, self._governor, self._requests, self._wires
        access, wait_until = wires.access, self._clock.wait_until
        tick, stepped = self._card.tick, self._card.stepped
        interval_q8, add_q8, left = cursor.interval_q8, cursor.add_q8, cursor.piece_left
        shortest, is_half = self._shortest_cycles, self._duty_q16 == HALF_Q16
        least = 2 * shortest
        try:
            while left:
                if self._fall_at_cycles and not self._fall(end_ns):
                    break
                moving = cursor.moving or cursor.settle()
                if requests.calm:
                    cycles = interval_q8 >> 8
                else:
                    cycles = governor.interval(cursor, interval_q8 >> 8)
                    if cycles < 0:
                        break
                    # Should the wait be broken off, this is what was waited for.
                    governor.awaited_cycles = cycles
                if cycles < least:
                    cycles = least
                pulse = cycles >> 1 if is_half else self._pulse(cycles)
                rise_at = self._due_cycles + cycles - pulse
                if is_special := self._is_special:
                    rise_at = self._rise_at(cursor, cycles - pulse)
                elif self._behind_ns:
                    self._make_up(min(cycles >> 4, cycles - pulse - shortest))
                fall_at = rise_at + pulse
                entries = tick(moving)
                deadline_ns = self._base_ns + (rise_at * 125 >> 1)
                if cycles > READING_CYCLES and not self._read_until(
                    self._due_cycles, rise_at, end_ns
                ):
                    break
                if deadline_ns > end_ns:
                    wait_until(end_ns)
                    break
                now_ns = wait_until(deadline_ns)
                # A pause of its own makes no other rate.
                track.last_cycles = cycles
                if wires.stale:
                    entries = self._made_out_anew(cursor, moving)
                for register, value in entries:
                    access[register](value)
                governor.awaited_cycles = 0
                if is_special:
                    self._is_special = self._from_rest = False
                self._fall_at_cycles = self._due_cycles = fall_at
                if now_ns > deadline_ns:
                    spare = min(cycles >> 4, pulse - shortest)
                    self._base_ns += self._late(deadline_ns, now_ns, cycles, spare)
                stepped(moving)
                cursor.made()
                left -= 1
                interval_q8 += add_q8
        finally:
            # Also on the way out of an interrupt: what was played must not be played again.
            cursor.interval_q8, cursor.piece_left = interval_q8, left

    def _pulse(self, cycles: int) -> int:
        """How long the clock is up in a tick of at least two of the shortest pulses."""
        shortest = self._shortest_cycles
        return max(shortest, min(cycles * self._duty_q16 >> 16, cycles - shortest))

    def _rise_at(self, cursor: Cursor, pause_cycles: int) -> int:
        """When the clock lines rise that fell, or stood, at the end of the tick before."""
        setup_cycles = self._card.setup_cycles
        rise_at = self._due_cycles + pause_cycles
        if self._from_rest and cursor.leader_bit:
            ready = self._due_cycles + max(setup_cycles, self._shortest_cycles)
            rise_at = max(ready, self._fell_cycles + pause_cycles)
        return max(rise_at, self._turned_at_cycles + setup_cycles)

    def _turn(self, directions: Entries) -> None:
        """Write direction lines, and note when they stood."""
        self._make_up(0)
        self._wires.write(directions)
        after_ns = self._clock.now_ns() - self._at_ns(self._due_cycles)
        self._turned_at_cycles = self._due_cycles + max(0, after_ns * 2 + 124) // 125
        self._is_special = True

    def _make_up(self, spare_cycles: int) -> None:
        """The last fall was late: all that follows moves by what its pause cannot spare."""
        self._base_ns += max(0, self._behind_ns - (spare_cycles * 125 >> 1))
        self._behind_ns = 0

    @property
    def _is_in_hand(self) -> bool:
        """The clock is up: the pulse will be finished."""
        return self._fall_at_cycles > 0

    def _fall(self, end_ns: int) -> bool:
        """Write the falling edge that is due; False if that is not before ``end_ns``."""
        fall_at, interval = self._fall_at_cycles, self._track.last_cycles
        deadline_ns = self._at_ns(fall_at)
        if interval > READING_CYCLES and not self._read_until(
            fall_at - self._pulse(interval), fall_at, end_ns
        ):
            return False
        if deadline_ns > end_ns:
            self._clock.wait_until(end_ns)
            return False
        now_ns = self._clock.wait_until(deadline_ns)
        self._fall_at_cycles = 0
        self._wires.write(self._card.fall)
        if now_ns > deadline_ns:
            self._behind_ns = self._late(deadline_ns, now_ns, interval >> 1, 0)
        return True
