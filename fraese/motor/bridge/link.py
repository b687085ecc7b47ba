r"""One end of a line that loses, damages and doubles: commands in order, once, and a stream.

    command ----> waiting --.                       .--> acknowledged
                             >--> in flight (192 bytes) --'
    stream  ----> backlog --'     |         ^
                                  '- again -'    GAP, or 30 ms without progress

Rule 1: no I/O and no clock: bytes in and out, and the time is an argument.
Rule 2: commands go before the stream, so that nothing that is wanted now waits for room in the
        device. Among themselves both keep their order.
Rule 3: the stream is cut into BLOCKS frames only when window and credit allow it; what is dropped
        before that was never there.
Rule 4: an urgent is a wish: it is said at once, and again until a STATUS shows that it counted.
Rule 5: a device that is busy with steps has little time to read, and 32 bytes to store what it has
        not read. So the window is halved when anything must be sent again, and grows while nothing
        must.
Rule 6: what is acknowledged with another session is not from the device that was greeted.
"""

from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from fraese.motor.bridge.codec import Ack, Decoder, Frame, Status, Urgent, frame
from fraese.motor.bridge.constants import (
    KIND_ACK,
    KIND_BLOCKS,
    KIND_PING,
    KIND_STATUS,
    PAYLOAD_MAX,
    URGENT_STATUS,
    URGENT_STOP,
    WINDOW,
)

#: Without progress for so long, all is sent again; next time twice as long must pass, and so on: a
#: device that is busy with steps is not helped by more to read.
RESEND_NS: Final = 30_000_000
_MOST_RESEND_NS: Final = 120_000_000
#: GAPs that follow one with the same number within this time speak of the same loss.
GAP_DEAF_NS: Final = 10_000_000
#: A wish to brake or stop is repeated so often.
WISH_NS: Final = 20_000_000
#: A question for a STATUS likewise; an answer takes 2.3 ms on the line at 250,000 baud.
ASK_NS: Final = 15_000_000

#: A sequence number so far back is no gap, however much is under way.
_LONG_PAST: Final = 0x70

_CHUNK: Final = PAYLOAD_MAX - 1
#: What a frame of the stream has besides: two FLAGs, kind, sequence, epoch, CRC.
_AROUND: Final = 7
#: The window is never smaller, and grows by so much with every acknowledgement, bytes.
_LEAST_WINDOW: Final = 30
_WINDOW_STEP: Final = 4


@dataclass(slots=True)
class _Flying:
    """A frame that was sent and is not acknowledged."""

    sequence: int
    data: bytes
    #: Command that it carries, 0: a part of the stream.
    ticket: int
    #: Bytes of the stream in it.
    credit: int


@dataclass(slots=True)
class _Wish:
    """An urgent that is not confirmed."""

    byte: int
    #: The device's count when it was first said.
    count: int
    said_ns: int


class Link:
    """The host's end, from a HELLO that was accepted on.

    Args:
        session: of that HELLO.
        free: bytes of records that the device takes.

    Attributes:
        status: the last STATUS.
        epoch: of the queue as known here; BLOCKS and START carry it.
        stranger: session of a report that was not ours; None: there was none.
        done: number of the last command that was acknowledged,
        answered: and of the last one that the last STATUS knows of.
        heard: STATUSes that came.
        resent: frames that were sent again.
    """

    def __init__(self, session: int, free: int) -> None:
        self._session = session
        self._decoder = Decoder()
        self._waiting: deque[tuple[int, int, bytes]] = deque()
        self._backlog = bytearray()
        self._flying: deque[_Flying] = deque()
        self._sent = 0
        self._sequence = 0
        self._free = free
        self._tickets = 0
        self._refusal = (0, 0)
        self._refused: dict[int, int] = {}
        self._progress_ns = 0
        self._patience_ns = RESEND_NS
        self._window = WINDOW
        self._gap: tuple[int, int] | None = None
        self._wishes: dict[int, _Wish] = {}
        self._asked_ns: int | None = None
        self._ask_due = False
        self.status: Status | None = None
        self.epoch = 0
        self.stranger: int | None = None
        self.done = 0
        self.answered = 0
        self.heard = 0
        self.resent = 0

    # --- what is to be said ----------------------------------------------------------------------

    def command(self, kind: int, payload: bytes = b"") -> int:
        """Something to be carried out once; its number, from 1."""
        self._tickets += 1
        self._waiting.append((self._tickets, kind, payload))
        return self._tickets

    @property
    def last_command(self) -> int:
        """Number of the last command."""
        return self._tickets

    def refusal(self, ticket: int) -> int:
        """The code with which an acknowledged command was refused; 0: it was not. Ask once."""
        return self._refused.pop(ticket, 0)

    def stream(self, data: bytes) -> None:
        """More bytes of the record stream."""
        self._backlog += data

    def drop_stream(self) -> None:
        """What was not sent yet is not wanted any more."""
        self._backlog.clear()

    def wish(self, byte: int, now_ns: int) -> bytes:
        """A brake or stop; what to send at once. From any thread.

        It is said twice: between frames or not, it counts.
        """
        self._wishes[byte] = _Wish(byte, _count(self.status, byte), now_ns)
        return _said(byte)

    def out_of_sequence(self) -> bytes:
        """A frame that the device hears and throws away. From any thread."""
        return frame(KIND_PING, (self._sequence - _LONG_PAST) & 0xFF)

    def ask(self) -> None:
        """Ask for a STATUS, behind what is to be sent now; one that was asked for is waited for."""
        self._ask_due = self._ask_due or self._asked_ns is None

    # --- how it stands ---------------------------------------------------------------------------

    @property
    def backlog(self) -> int:
        """Bytes of the stream that were not sent yet."""
        return len(self._backlog)

    @property
    def streams(self) -> bool:
        """A part of the stream has not come to the device yet, as far as is known."""
        return bool(self._backlog) or any(flying.credit for flying in self._flying)

    @property
    def credit(self) -> int:
        """Bytes of the stream that the device surely takes."""
        return self._free - sum(flying.credit for flying in self._flying)

    @property
    def is_full(self) -> bool:
        """What is left of the stream must wait until the device has room."""
        return bool(self._backlog) and not self._next_chunk()

    @property
    def is_quiet(self) -> bool:
        """All is acknowledged but what must wait for room."""
        return not self._flying and not self._waiting and (not self._backlog or self.is_full)

    @property
    def expects(self) -> bool:
        """The device owes an answer."""
        return bool(self._flying or self._wishes or self._asked_ns is not None)

    def wants(self, byte: int) -> bool:
        """An urgent was said and is not confirmed."""
        return byte in self._wishes

    # --- bytes -----------------------------------------------------------------------------------

    def output(self, now_ns: int) -> bytes:
        """What to send now."""
        out = bytearray()
        for wish in list(self._wishes.values()):
            if now_ns - wish.said_ns >= WISH_NS:
                wish.said_ns = now_ns
                out += _said(wish.byte)
        if self._sent and now_ns - self._progress_ns >= self._patience_ns:
            self._go_back(now_ns)
            self._patience_ns = min(2 * self._patience_ns, _MOST_RESEND_NS)
        if not self._sent:
            self._progress_ns = now_ns
        for flying in self._coming():
            out += flying.data
        if self._ask_due or (self._asked_ns is not None and now_ns - self._asked_ns >= ASK_NS):
            self._ask_due, self._asked_ns = False, now_ns
            out.append(URGENT_STATUS)
        return bytes(out)

    def feed(self, data: bytes, now_ns: int) -> list[Status]:
        """Take what has come; the STATUSes in it."""
        found = []
        for item in self._decoder.feed(data):
            if isinstance(item, Urgent):
                continue
            with suppress(ValueError):
                status = self._take(item, now_ns)
                if status is not None:
                    found.append(status)
        return found

    # --- sending ---------------------------------------------------------------------------------

    def _coming(self) -> Iterator[_Flying]:
        """Frames that the window has room for: those to be sent again, then new ones."""
        used = sum(len(flying.data) for flying in list(self._flying)[: self._sent])
        while True:
            if self._sent == len(self._flying) and not self._launch(self._window - used):
                return
            flying = self._flying[self._sent]
            if used and used + len(flying.data) > self._window:
                return
            used += len(flying.data)
            self._sent += 1
            yield flying

    def _launch(self, room: int) -> bool:
        """Make the next frame; False: there is none, or it must wait."""
        if self._waiting:
            ticket, kind, payload = self._waiting[0]
            credit = 0
        elif chunk := self._next_chunk():
            ticket, kind, credit = 0, KIND_BLOCKS, len(chunk)
            payload = bytes((self.epoch,)) + chunk
        else:
            return False
        data = frame(kind, self._sequence, payload)
        if len(data) > room and self._flying:
            return False
        if credit:
            del self._backlog[:credit]
        else:
            self._waiting.popleft()
        self._flying.append(_Flying(self._sequence, data, ticket, credit))
        self._sequence = (self._sequence + 1) & 0xFF
        return True

    def _next_chunk(self) -> bytes:
        """The next part of the stream, as long as a frame can be; empty while there is no room."""
        size = min(len(self._backlog), _CHUNK, self._window - _AROUND)
        return bytes(self._backlog[:size]) if size <= self.credit else b""

    def _go_back(self, now_ns: int) -> None:
        self._window = max(_LEAST_WINDOW, self._window // 2)
        self.resent += self._sent
        self._sent = 0
        self._progress_ns = now_ns

    # --- receiving -------------------------------------------------------------------------------

    def _take(self, item: Frame, now_ns: int) -> Status | None:
        if item.kind == KIND_ACK:
            self._acknowledge(Ack.parse(item.payload), now_ns)
            return None
        if item.kind != KIND_STATUS:
            return None
        status = Status.parse(item.payload)
        if not self._acknowledge(status.ack, now_ns):
            return None
        self.status = status
        self.answered = self.done
        self.heard += 1
        self._asked_ns = None
        for wish in list(self._wishes.values()):
            if _count(status, wish.byte) != wish.count:
                self._wishes.pop(wish.byte, None)
        return status

    def _acknowledge(self, ack: Ack, now_ns: int) -> bool:
        if ack.session != self._session:
            self.stranger = ack.session
            return False
        refusal = (ack.refused_seq, ack.refused_code)
        is_news, self._refusal = refusal != self._refusal, refusal
        behind = (self._sequence - ack.next_seq) & 0xFF
        finished = len(self._flying) - behind
        if not 0 <= finished <= len(self._flying):
            return True
        for _ in range(finished):
            flying = self._flying.popleft()
            if flying.ticket:
                self.done = flying.ticket
                if is_news and ack.refused_code and flying.sequence == ack.refused_seq:
                    self._refused[flying.ticket] = ack.refused_code
        self._sent = max(0, self._sent - finished)
        self._free = ack.free
        if finished:
            self._progress_ns = now_ns
            self._patience_ns = RESEND_NS
            self._window = min(WINDOW, self._window + _WINDOW_STEP)
            self._gap = None
        if ack.gap:
            self._mind_gap(ack.next_seq, now_ns)
        return True

    def _mind_gap(self, next_seq: int, now_ns: int) -> None:
        if self._gap and self._gap[0] == next_seq and now_ns - self._gap[1] < GAP_DEAF_NS:
            return
        self._gap = (next_seq, now_ns)
        self._go_back(now_ns)


def _said(byte: int) -> bytes:
    return bytes((byte, byte))


def _count(status: Status | None, byte: int) -> int:
    """How often the device has counted an urgent, as far as known."""
    if status is None:
        return 0
    return status.stops if byte == URGENT_STOP else status.brakes
