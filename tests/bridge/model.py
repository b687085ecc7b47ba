"""The device's frame layer, as the protocol describes it, and a line that is not to be trusted."""

import random
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import Decoder, Frame, Status, Urgent, frame

SESSION = 77
RING = 300
STATUS_LENGTH = Status._FORMAT.size


@dataclass
class Model:
    """The device's frame layer: what it takes, and what it answers.

    Attributes:
        taken: commands that were carried out, in order.
        stream: bytes of the record stream.
        used: bytes in the ring.
    """

    session: int = SESSION
    refuses: int = -1
    taken: list[tuple[int, bytes]] = field(default_factory=list)
    stream: bytearray = field(default_factory=bytearray)
    used: int = 0
    next_seq: int = 0
    epoch: int = 0
    brakes: int = 0
    stops: int = 0
    refused: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        self._decoder = Decoder()
        self._counter = 0

    def feed(self, data: bytes) -> bytes:
        return b"".join(self._answers(data))

    def _answers(self, data: bytes) -> Iterator[bytes]:
        for item in self._decoder.feed(data):
            if isinstance(item, Frame):
                yield self._say(c.KIND_ACK, self._ack(self._take(item)))
            elif item == Urgent(c.URGENT_STATUS):
                yield self.status()
            elif item == Urgent(c.URGENT_BRAKE):
                self.brakes += 1
            elif item == Urgent(c.URGENT_STOP):
                self.stops += 1

    def _take(self, item: Frame) -> bool:
        """True: the frame lies ahead."""
        ahead = (item.sequence - self.next_seq) & 0xFF
        if ahead:
            return ahead < 0x80
        if item.kind == c.KIND_BLOCKS:
            if self.used + len(item.payload) - 1 > RING:
                return False
            if item.payload[0] != self.epoch:
                self.refused = (item.sequence, c.REFUSED_EPOCH)
            else:
                self.stream += item.payload[1:]
                self.used += len(item.payload) - 1
        elif item.kind == self.refuses:
            self.refused = (item.sequence, c.REFUSED_MOVING)
        else:
            self.taken.append((item.kind, item.payload))
        self.next_seq = (self.next_seq + 1) & 0xFF
        return False

    def status(self) -> bytes:
        rest = bytearray(STATUS_LENGTH - 9)
        rest[33:35] = bytes((self.brakes & 0xFF, self.stops & 0xFF))
        return self._say(c.KIND_STATUS, self._ack(False) + bytes(rest))

    def _ack(self, gap: bool) -> bytes:
        free = RING - self.used
        return struct.pack(
            "<BHBBHBB", self.next_seq, self.session, gap, self.epoch, free, *self.refused
        )

    def _say(self, kind: int, payload: bytes) -> bytes:
        self._counter = (self._counter + 1) & 0xFF
        return frame(kind, self._counter, payload)

    def play(self, count: int) -> None:
        self.used = max(0, self.used - count)


class BadLine:
    """Loses, flips, doubles and delays; both ways."""

    def __init__(self, seed: int, badness: float) -> None:
        self._random = random.Random(seed)
        self._badness = badness
        self._late = b""

    def carry(self, data: bytes) -> bytes:
        out, self._late = bytearray(self._late), b""
        for part in self._parts(data):
            what = self._random.random() / self._badness if self._badness else 9
            if what < 0.25:
                continue
            if what < 0.5:
                at = self._random.randrange(len(part))
                part = (
                    part[:at] + bytes((part[at] ^ 1 << self._random.randrange(8),)) + part[at + 1 :]
                )
            elif what < 0.75:
                out += part
            elif what < 1:
                self._late += part
                continue
            out += part
        return bytes(out)

    def _parts(self, data: bytes) -> Iterator[bytes]:
        """Frames, more or less: what stands between two FLAGs."""
        at = 0
        while at < len(data):
            end = data.find(bytes((c.FLAG, c.FLAG)), at)
            end = len(data) if end < 0 else end + 1
            yield data[at:end]
            at = end
