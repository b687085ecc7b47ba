r"""A device that lived on through the end of its program is asked where the motors stand.

    open line -> STATUS? -> another session, or none: it is not the one, or was reset
                         -> moving:                   BRAKE, and again
                         -> standing, twice the same: place + ledger = counts

Rule 1: asked before HELLO, which makes the device forget its session.
Rule 2: believed is only the very session of the ledger: a device that was reset has none, and one
        that another program has greeted has another one.
Rule 3: two answers must agree, some time apart: the dead program's last bytes may still be on
        their way, and begin something.
Rule 4: all that can be compared must fit (phases, ticks of the block); else nothing is known.
"""

from typing import Final

from fraese.errors import PortError
from fraese.motor.bridge.account import steps_in, torn_serial
from fraese.motor.bridge.codec import Decoder, Frame, Place, Status
from fraese.motor.bridge.constants import (
    KIND_STATUS,
    URGENT_BRAKE,
    URGENT_STATUS,
    State,
    ended_of,
)
from fraese.motor.bridge.ledger import Book, Entry, StepCounts
from fraese.motor.bridge.line import Line, OpenLine
from fraese.motor.realtime.lastwords import LastWords
from fraese.motor.seams import Clock

#: A device that is there answers within some milliseconds; one that was reset waits in its boot
#: loader, and knows nothing.
_PATIENCE_S: Final = 0.3
#: Between two questions, and between two answers that must agree.
_AGAIN_S: Final = 0.05
#: Motors that are found moving have so long to come to rest.
_REST_S: Final = 5.0
_LOOK_S: Final = 0.005
_NS_PER_S: Final = 1_000_000_000


def ask(open_line: OpenLine, clock: Clock, book: Book) -> LastWords | None:
    """Where the motors of a program stand that ended suddenly; None: nobody knows.

    Args:
        open_line: to where the device was.
        clock: for the patience.
        book: what that program wrote down.
    """
    try:
        line = open_line()
    except PortError:
        return None
    try:
        status = _Questioner(line, clock, book.session).at_rest()
    except PortError:
        return None
    finally:
        line.close()
    return None if status is None else words_of(status, book)


class _Questioner:
    """Who asks.

    Args:
        line: open.
        clock: for the patience.
        session: that is asked for.
    """

    def __init__(self, line: Line, clock: Clock, session: int) -> None:
        self._line, self._clock, self._session = line, clock, session
        self._decoder = Decoder()

    def at_rest(self) -> Status | None:
        """What the device says when it stands; None: it is not the one, or never does."""
        until_ns = self._ns_after(_REST_S)
        before: Status | None = None
        while self._clock.now_ns() < until_ns:
            status = self._answer(brakes=before is not None and _moves(before))
            if status is None or status.ack.session != self._session:
                return None
            if before is not None and _told(before) == _told(status) and not _moves(status):
                return status
            before = status
            self._heard(_AGAIN_S)
        return None

    def _answer(self, *, brakes: bool) -> Status | None:
        """A STATUS; None: nobody answers."""
        # A frame may have broken off with its program: an urgent counts when it is said twice.
        words = 2 * bytes((URGENT_BRAKE,)) * brakes + 2 * bytes((URGENT_STATUS,))
        until_ns = self._ns_after(_PATIENCE_S)
        while self._clock.now_ns() < until_ns:
            self._line.write(words)
            if status := self._heard(_AGAIN_S, at_once=True):
                return status
        return None

    def _heard(self, seconds: float, *, at_once: bool = False) -> Status | None:
        """The last STATUS that comes within that time, or the first one."""
        last, until_ns = None, self._ns_after(seconds)
        while self._clock.now_ns() < until_ns and not (at_once and last):
            for item in self._decoder.feed(self._line.read(_LOOK_S)):
                if isinstance(item, Frame) and item.kind == KIND_STATUS:
                    last = _parsed(item.payload) or last
        return last

    def _ns_after(self, seconds: float) -> int:
        return self._clock.now_ns() + round(seconds * _NS_PER_S)


def _parsed(payload: bytes) -> Status | None:
    try:
        return Status.parse(payload)
    except ValueError:
        return None


def _moves(status: Status) -> bool:
    return bool(status.state & State.MOVING)


def _told(status: Status) -> tuple[object, ...]:
    """What no byte that comes late may change."""
    ack = status.ack
    return ack.session, ack.next_seq, ack.epoch, status.last, status.place, status.phases


def words_of(status: Status, book: Book) -> LastWords | None:
    """What a STATUS at standstill means; None: it does not fit."""
    place, entry = status.place, book.entry(status.place.serial)
    if status.ack.session != book.session or entry is None or _is_beyond(place, entry):
        return None
    made = steps_in(entry.steps, entry.ticks, place.done, place.moved)
    counts = tuple(a + b for a, b in zip(entry.start, made, strict=True))
    phases = _phases(counts, book)
    if book.table and phases != status.phases[: len(phases)]:
        return None
    return LastWords(
        token=book.token,
        position_steps=counts,
        phases=phases,
        torn=_torn(status, book),
        ended=ended_of(status.ended),
    )


def _is_beyond(place: Place, entry: Entry) -> bool:
    """Before the first block of a session the ticks are those of an earlier one."""
    return bool(entry.ticks) and place.done > entry.ticks


def _phases(counts: StepCounts, book: Book) -> StepCounts:
    """Of these counts."""
    net = tuple(
        phase + count - base
        for phase, count, base in zip(book.phases, counts, book.counts, strict=True)
    )
    return tuple(phase % book.table for phase in net) if book.table else net


def _torn(status: Status, book: Book) -> frozenset[int]:
    """Motors that may have turned on; all of them, if it is not known which block tore them."""
    serial = torn_serial(status)
    if serial is None:
        return frozenset()
    entry = book.entry(serial)
    steps = entry.steps if entry else (1,) * len(book.counts)
    return frozenset(motor for motor, n in enumerate(steps) if n)
