"""A device in the protocol's terms, and a line that lies for it.

    driver --bytes--> Sham: takes, plays in jumps --answers--> Liar: as told --bytes--> driver

Rule 1: what the device takes it takes honestly, as the firmware does: in order, once, of its epoch.
        What was really taken and played is the truth.
Rule 2: what is said of it is what the script wants, answer by answer; behind its end, the truth.
Rule 3: time is virtual, and passes while somebody reads.
"""

import struct
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from fraese.blocks import Block
from fraese.errors import PortError
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import Ack, Decoder, Frame, Hello, Status, Urgent, frame
from fraese.motor.clock import VirtualClock
from tests.bridge.recordreader import RecordReader

RING: Final = 900
#: What an answer takes on the line.
_ANSWER_NS: Final = 2_400_000
_ACK: Final = Ack._FORMAT
_STATUS: Final = Status._FORMAT
#: Of a STATUS, as struct has them: the acknowledgement and the phases are bytes.
STATUS_WIDTHS: Final = (0, 1, 1, 1, 2, 4, 1, 2, 4, 1, 2, 4, 1, 2, 2, 2, 1, 1, 1, 1, 1, 2, 0, 1)
ACK_WIDTHS: Final = (1, 2, 1, 1, 2, 1, 1)
_STATE, _ENDED, _PLACE, _LAST = 1, 3, 4, 7


class Lie(NamedTuple):
    """What becomes of one answer.

    Attributes:
        kind: see ``Liar``.
        ack: fields of the acknowledgement in it, by number, that are others.
        status: likewise of a STATUS.
        data: bytes.
        at: a place in the answer.
    """

    kind: str
    ack: dict[int, int] = {}  # noqa: RUF012 (never changed)
    status: dict[int, int] = {}  # noqa: RUF012
    data: bytes = b""
    at: int = 0


TRUTH: Final = Lie("truth")


class Sham:
    """The device.

    Args:
        motors: of the card.
        pace: ticks that are played between two reports.

    Attributes:
        taken: blocks that came, by session and epoch, in order.
        started: how often START was followed.
        answers: that were given.
    """

    def __init__(self, motors: int = 3, pace: int = 40) -> None:
        self._motors, self._pace = motors, pace
        self._decoder = Decoder()
        self.session = self.answers = self.started = 0
        self.taken: list[list[Block]] = []
        self._begin_anew()

    def _begin_anew(self) -> None:
        self._next_seq = self._epoch = self._brakes = self._stops = self._ended = 0
        self._refused = (0, 0)
        self._last = self._serial = self._done = 0
        self._moving = self._held = self._energised = False
        self._drop()

    def _drop(self) -> None:
        self.taken.append([])
        self._waiting: list[tuple[int, Block]] = []
        self._reader = RecordReader(self._motors)

    # --- in --------------------------------------------------------------------------------------

    def feed(self, data: bytes) -> Iterator[tuple[int, bytes]]:
        """Answers, as kind and payload."""
        for item in self._decoder.feed(data):
            if isinstance(item, Urgent):
                yield from self._urgent(item.byte)
            elif item.kind == c.KIND_HELLO:
                self._begin_anew()
                self.session = struct.unpack_from("<BH", item.payload)[1]
                yield c.KIND_HELLO_REPLY, self._hello()
            elif self.session:
                ahead = (item.sequence - self._next_seq) & 0xFF
                if not ahead:
                    self._follow(item)
                    self._next_seq = (self._next_seq + 1) & 0xFF
                yield c.KIND_ACK, self._ack(0 < ahead < 0x80)

    def _urgent(self, byte: int) -> Iterator[tuple[int, bytes]]:
        if byte == c.URGENT_BRAKE:
            self._brakes += 1
            self._held, self._moving = True, False
        elif byte == c.URGENT_STOP:
            self._stops += 1
            self._end(c.ENDED_STOP)
        elif self.session:
            self._play()
            yield c.KIND_STATUS, self._status()

    def _end(self, why: int) -> None:
        if self._waiting:
            self._epoch = (self._epoch + 1) & 0xFF
            self._drop()
        self._moving, self._ended = False, why

    def _follow(self, item: Frame) -> None:
        if item.kind == c.KIND_BLOCKS:
            if item.payload[:1] != bytes((self._epoch,)):
                self._refused = (item.sequence, c.REFUSED_EPOCH)
                return
            for record in self._reader.feed(item.payload[1:]):
                self._last = (self._last + 1) & 0xFFFF
                self._waiting.append((self._last, record.block))
                self.taken[-1].append(record.block)
        elif item.kind == c.KIND_START:
            if item.payload == bytes((self._epoch,)) and self._waiting and not self._held:
                self._moving = self._energised = True
                self._ended = c.ENDED_NOT
                self.started += 1
        elif item.kind == c.KIND_RESUME:
            self._moving, self._held = self._held and bool(self._waiting), False
        elif item.kind == c.KIND_FLUSH:
            self._held = False
            self._epoch = (self._epoch + 1) & 0xFF
            self._drop()
            self._ended = c.ENDED_FLUSH
        elif item.kind in (c.KIND_IDLE, c.KIND_CLOSE):
            self._energised = False

    def _play(self) -> None:
        left = self._pace if self._moving else 0
        while left and self._waiting:
            self._serial, block = self._waiting[0]
            ticks = sum(piece.ticks for piece in block.pieces)
            step = min(left, ticks - self._done)
            self._done, left = self._done + step, left - step
            if self._done == ticks:
                self._waiting.pop(0)
                if self._waiting:
                    self._serial, self._done = self._waiting[0][0], 0
        if self._moving and not self._waiting:
            self._moving, self._ended = False, c.ENDED_TARGET

    # --- out -------------------------------------------------------------------------------------

    def _hello(self) -> bytes:
        facts = (c.PROTOCOL_VERSION, self.session, 1, 1, RING, c.PAYLOAD_MAX, c.MOTORS_MAX)
        return Hello._FORMAT.pack(*facts, c.TABLE_MAX, c.WINDOW, 3, 1, 7, 0) + b"sham"

    def _ack(self, gap: bool) -> bytes:
        free = RING - 30 * len(self._waiting)
        return _ACK.pack(
            self._next_seq, self.session, gap and c.ACK_GAP, self._epoch, max(0, free),
            *self._refused,
        )  # fmt: skip

    def _status(self) -> bytes:
        state = (
            self._moving * c.State.MOVING
            | self._held * c.State.HELD
            | self._energised * c.State.ENERGISED
        )
        in_hand = c.More.IN_HAND if self._waiting and self._done else 0
        fields = [
            self._ack(False), state, in_hand | c.More.CARD, self._ended,
            self._serial, self._done, 0, self._last, 16_000 * self._moving, 0xF8,
            0, 0, 0, 0, 0, 0, 0, 0, 0, self._brakes & 0xFF, self._stops & 0xFF, 256, bytes(4), 0,
        ]  # fmt: skip
        return _STATUS.pack(*fields)


def _within(value: int, width: int) -> int:
    return value & ((1 << 8 * width) - 1)


def _bent_ack(payload: bytes, other: dict[int, int]) -> bytes:
    fields = list(_ACK.unpack_from(payload))
    for number, value in other.items():
        fields[number] = _within(value, ACK_WIDTHS[number])
    return _ACK.pack(*fields) + payload[_ACK.size :]


def _bent(kind: int, payload: bytes, lie: Lie) -> bytes:
    if kind not in (c.KIND_ACK, c.KIND_STATUS):
        return payload
    payload = _bent_ack(payload, lie.ack)
    if kind == c.KIND_ACK:
        return payload
    fields = list(_STATUS.unpack(payload))
    for number, value in lie.status.items():
        width = STATUS_WIDTHS[number]
        fields[number] = _within(value, width) if width else fields[number]
    return _STATUS.pack(*fields)


class Liar:
    """A Line to a sham device.

    truth    the answer          junk    bytes before it      flip   a byte of it is another
    bent     other fields        frame   another frame        late   after the next one
    lost     nothing             cut     its begin            gone   the plug is pulled
    twice    the answer, twice   short   a good frame with less in it

    Args:
        sham: the device.
        clock: its time.
        lies: what becomes of the answer with that number, from 0.

    Attributes:
        said: answers so far.
        closed: it was given back.
    """

    def __init__(self, sham: Sham, clock: VirtualClock, lies: Callable[[int], Lie]) -> None:
        self._sham, self._clock, self._lies = sham, clock, lies
        self.said = self._counter = 0
        self._coming = bytearray()
        self._late = b""
        self.closed = self._gone = False

    def read(self, timeout_s: float) -> bytes:
        """See ``Line``."""
        self._require_plug()
        if not self._coming:
            self._clock.pass_by(max(1, round(timeout_s * 1e9)))
        else:
            self._clock.pass_by(_ANSWER_NS)
        data, self._coming = bytes(self._coming), bytearray()
        return data

    def write(self, data: bytes) -> None:
        """See ``Line``."""
        self._require_plug()
        for kind, payload in self._sham.feed(data):
            self._say(kind, payload)

    def set_baud(self, baud: int) -> None:
        """See ``Line``."""

    def close(self) -> None:
        """See ``Line``."""
        self.closed = True

    def _require_plug(self) -> None:
        assert not self.closed, "a line is used after it was given back"
        if self._gone:
            raise PortError("The line is gone: is the plug still in?")

    def _say(self, kind: int, payload: bytes) -> None:
        lie = self._lies(self.said)
        self.said += 1
        self._counter = (self._counter + 1) & 0xFF
        bent = _bent(kind, payload, lie) if lie.kind == "bent" else payload
        if lie.kind == "short":
            bent = bent[: lie.at % (len(bent) + 1)]
        told = frame(kind, self._counter, bent)
        late, self._late = self._late, b""
        match lie.kind:
            case "lost":
                told = b""
            case "twice":
                told += told
            case "junk":
                told = lie.data + told
            case "frame":
                told = frame(lie.at & 0xFF, self._counter, lie.data[: c.PAYLOAD_MAX])
            case "cut":
                told = told[: lie.at % len(told)]
            case "flip":
                at = lie.at % len(told)
                told = told[:at] + bytes((told[at] ^ (lie.at >> 8 & 0xFF or 1),)) + told[at + 1 :]
            case "late":
                told, self._late = b"", told
            case "gone":
                self._gone = True
        self._coming += told + late
