r"""What was sent, and what the device's few numbers mean in steps.

    pushed     7     8     9     10    11         numbers, from 1, of all blocks ever
    serial     4     5     6     7     8          the device's, modulo 65536
               |-----|--x--|-----|-----|
    start    (0,0) (9,0) (9,3) ...                counts before each block
                        ^ Place(serial 5, done 40, moved 0b1) = start of 8 + 40 ticks of it

Rule 1: the device never counts steps; every count here follows from (serial, done, moved).
Rule 2: a queue is dropped as a whole, which shows as a new epoch: what lies after the place then
        never was, and blocks that were pushed in ignorance of it neither.
Rule 3: what a contact or a watch tells is worked out when it is first told, while the blocks that
        it speaks of are remembered.
"""

from collections import deque
from typing import Final, NamedTuple

from fraese.blocks import OVERRIDES, Q8, RATE_Q8_CYCLES, Block, steps_done
from fraese.motor.bridge.codec import Place, Status
from fraese.motor.bridge.constants import ENDED_NAMES, More, State
from fraese.motor.bridge.ledger import Ledger, StepCounts
from fraese.motor.seams import End

#: Blocks that are remembered after they were played: more than can end within the lag of a contact.
_REMEMBERED: Final = 512
_SERIALS: Final = 0x10000
_NOBODY: Final = Ledger()


class Counts(NamedTuple):
    """Signed counts of every motor, and both directions added."""

    position: StepCounts
    travelled: StepCounts

    def after(self, steps: StepCounts) -> "Counts":
        """The same after a movement."""
        return Counts(
            tuple(a + b for a, b in zip(self.position, steps, strict=True)),
            tuple(a + abs(b) for a, b in zip(self.travelled, steps, strict=True)),
        )


class _Sent(NamedTuple):
    """A block and where it begins."""

    number: int
    serial: int
    block: Block
    ticks: int
    start: Counts

    def counts(self, done: int, moved: int) -> Counts:
        """After so many of its ticks, and the step of some motors more."""
        return self.start.after(steps_in(self.block.steps, self.ticks, done, moved))

    def has(self, place: Place) -> bool:
        """It may be there: nothing of it is more than was sent."""
        if place.done > self.ticks:
            return False
        made = steps_in(self.block.steps, self.ticks, place.done, place.moved)
        return all(abs(part) <= abs(n) for part, n in zip(made, self.block.steps, strict=True))


def steps_in(steps: StepCounts, ticks: int, done: int, moved: int) -> StepCounts:
    """What a part of a block comes to, per motor.

    Args:
        steps: all of the block's,
        ticks: and how many ticks it has.
        done: of them were played.
        moved: motors, a bit each, that have moved already in the next one.
    """
    return tuple(
        (1 if n > 0 else -1) * (steps_done(abs(n), ticks, done) + (moved >> motor & 1)) if n else 0
        for motor, n in enumerate(steps)
    )


def torn_serial(status: Status) -> int | None:
    """The block in which motors stopped without ramp above their start/stop rate; None: none."""
    if not status.state & State.TORN:
        return None
    back = (status.place.serial - status.torn_serial) & 0xFF
    return (status.place.serial - back) % _SERIALS


class Account:
    """All blocks of one session.

    Args:
        motors: of the card.
        pushed: blocks that were pushed before this session,
        counts: and the counts that they came to,
        finished: and how many of them were played to their end.
        ledger: is told of every block before it is sent.

    Attributes:
        pushed: number of the last block that was pushed.
        counts: as of the last STATUS.
        finished: blocks that were played to their last tick.
        candidates: ends that the present contact may be.
        latched_steps: counts at the contact that fulfilled the last watch.
        torn: motors that stopped without ramp above their start/stop rate.
    """

    def __init__(
        self,
        motors: int,
        pushed: int = 0,
        counts: Counts | None = None,
        finished: int = 0,
        ledger: Ledger = _NOBODY,
    ) -> None:
        nothing = Counts((0,) * motors, (0,) * motors)
        self.pushed = pushed
        self._ledger = ledger
        self.finished = self._settled_finished = finished
        self.counts = counts or nothing
        self.candidates: frozenset[End] = frozenset()
        self.latched_steps: StepCounts | None = None
        self.torn: frozenset[int] = frozenset()
        self._every = frozenset(End(motor, sign) for motor in range(motors) for sign in (-1, 1))
        self._sent: deque[_Sent] = deque()
        self._by_serial: dict[int, _Sent] = {}
        self._next_serial = 1
        self._settled = pushed
        self._settled_counts = self._end_counts = self.counts
        self._in_hand: _Sent | None = None
        self._playing = pushed
        self._tick = 0
        self._contact: tuple[int, int] | None = None
        self._latch: Place | None = None
        self._place = Place(0, 0, 0)

    # --- blocks ----------------------------------------------------------------------------------

    def push(self, block: Block) -> int:
        """A block is sent, or will be; its number."""
        self.pushed += 1
        sent = _Sent(self.pushed, self._next_serial, block, block.ticks(), self._end_counts)
        self._ledger.note(sent.serial, block.steps, sent.ticks, sent.start.position)
        self._next_serial = (self._next_serial + 1) % _SERIALS
        self._sent.append(sent)
        self._by_serial[sent.serial] = sent
        self._end_counts = self._end_counts.after(block.steps)
        return self.pushed

    @property
    def playing(self) -> int:
        """Number of the block in hand, or of the last one that was played or dropped."""
        return self._playing

    @property
    def tick(self) -> int:
        """Ticks done of the block in hand."""
        return self._tick

    @property
    def tag(self) -> int:
        """Of the block in hand, or of the last one that is remembered."""
        found = self._in_hand or self._find(self._playing)
        return found.block.tag if found else 0

    @property
    def moves(self) -> bool:
        """The block in hand moves a motor."""
        return self._in_hand is not None and any(self._in_hand.block.steps)

    @property
    def longest_cycles(self) -> int:
        """No tick of the block in hand takes longer, at the lowest override; 0: there is none."""
        block = self._in_hand and self._in_hand.block
        if not block:
            return 0
        ends_q8 = [
            q8 for each in block.pieces for q8 in (each.interval_q8, each.last_interval_q8())
        ]
        slowest = [max(ends_q8, default=0) // Q8]
        if block.jump_rate_q8:
            slowest.append(RATE_Q8_CYCLES // block.jump_rate_q8)
        return round(max(slowest) / OVERRIDES[0])

    @property
    def queued(self) -> int:
        """Blocks that wait, or are in hand."""
        return self.pushed - self._playing + (self._in_hand is not None)

    def bounds(self) -> tuple[tuple[int, int], ...]:
        """Where each motor can be at the end: between here and all that was pushed."""
        reached = [self.counts.position]
        reached += [s.start.position for s in self._sent if s.number > self._playing]
        reached.append(self._end_counts.position)
        return tuple((min(steps), max(steps)) for steps in zip(*reached, strict=True))

    # --- what the device says --------------------------------------------------------------------

    def contradiction(self, status: Status) -> str:
        """Why this STATUS cannot be, a part of a sentence; empty: it can."""
        if status.ended >= len(ENDED_NAMES):
            return f"reason {status.ended} for a standstill"
        places = [status.place]
        if status.state & State.LATCHED:
            places.append(status.latched)
        for place in places:
            sent = self._by_serial.get(place.serial)
            if sent is not None and not sent.has(place):
                return f"tick {place.done} of a block of {sent.ticks}"
        if self._is_behind(status.place):
            return f"block {status.place.serial} after block {self._place.serial}"
        return ""

    def _is_behind(self, place: Place) -> bool:
        """It was told before that more was played: nothing is played back."""
        ahead = (place.serial - self._place.serial) % _SERIALS
        return ahead >= _SERIALS // 2 or (not ahead and place.done < self._place.done)

    def see(self, status: Status, *, dropped: bool) -> None:
        """Take a STATUS.

        Args:
            status: the device's word.
            dropped: its epoch is a new one.
        """
        self._see_contact(status)
        self._see_latch(status)
        place = self._place = status.place
        sent = self._by_serial.get(place.serial)
        if sent is not None and sent.number > self._settled:
            self.counts = sent.counts(place.done, place.moved)
            self._playing = sent.number
            is_whole = not status.more & More.IN_HAND and place.done >= sent.ticks
            of_session = sent.number - self._settled - (not is_whole)
            self.finished = self._settled_finished + of_session
        else:
            sent = None
            self.counts = self._settled_counts
            self._playing = self._settled
            self.finished = self._settled_finished
        self._in_hand = sent if status.more & More.IN_HAND else None
        self._tick = place.done if self._in_hand else 0
        self.torn = self._torn_by(status)
        if dropped:
            self.settle(status)
        self._forget()

    def settle(self, status: Status) -> None:
        """Everything after the place of a STATUS was dropped, or never came to the device."""
        while self._sent and self._sent[-1].number > self._playing:
            self._by_serial.pop(self._sent.pop().serial, None)
        self._settled = self._playing = self.pushed
        self._settled_finished = self.finished
        self._settled_counts = self._end_counts = self.counts
        self._in_hand = None
        self._tick = 0
        self._next_serial = (status.last + 1) % _SERIALS

    def _find(self, number: int) -> _Sent | None:
        """A block by its number; of dropped ones, the last that was played."""
        return next((sent for sent in reversed(self._sent) if sent.number <= number), None)

    def _forget(self) -> None:
        while self._sent and self._sent[0].number < self._playing - _REMEMBERED:
            old = self._sent.popleft()
            if self._by_serial.get(old.serial) is old:
                del self._by_serial[old.serial]

    # --- contacts --------------------------------------------------------------------------------

    def _see_contact(self, status: Status) -> None:
        if not status.more & More.CONTACT:
            self._contact = None
            self.candidates = frozenset()
            return
        contact = (status.contact_serial, status.contact_oldest)
        if contact != self._contact:
            self._contact = contact
            self.candidates = self._ends_of(status) or self._every

    def _ends_of(self, status: Status) -> frozenset[End]:
        """Ends towards which anything moved that can have made the contact."""
        oldest = status.contact_oldest
        count = (status.contact_serial - oldest) % _SERIALS + 1
        # None at all: the oldest is one above the other.
        serials = range(oldest, oldest + count) if count <= _REMEMBERED else ()
        blocks = [self._by_serial.get(serial % _SERIALS) for serial in serials]
        if status.more & More.IN_HAND:
            blocks.append(self._by_serial.get(status.place.serial))
        return frozenset(
            End(motor, 1 if n > 0 else -1)
            for sent in blocks
            if sent is not None
            for motor, n in enumerate(sent.block.steps)
            if n
        )

    def _see_latch(self, status: Status) -> None:
        if not status.state & State.LATCHED:
            self._latch = None
            self.latched_steps = None
        elif status.latched != self._latch:
            self._latch = status.latched
            sent = self._by_serial.get(status.latched.serial)
            place = status.latched
            self.latched_steps = sent and sent.counts(place.done, place.moved).position

    def _torn_by(self, status: Status) -> frozenset[int]:
        serial = torn_serial(status)
        sent = None if serial is None else self._by_serial.get(serial)
        steps = sent.block.steps if sent else ()
        return frozenset(motor for motor, n in enumerate(steps) if n)
