"""A host that streams: window, credit, go back N, over a line that damages frames.

    blocks -> records -> frames -> (line: damage, loss) -> device
                   ^                                        |
                   '------- ACK: next sequence, credit -----'

Rule 1: at most ``WINDOW`` bytes as they stand on the line are not acknowledged.
Rule 2: what is sent again is sent from the awaited frame on; nothing else is ever repaired.
Rule 3: frames are held back when told so: a host that stands still for a while.
"""

import random
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from fraese.blocks import Block
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import frame
from fraese.motor.bridge.records import Carried, Dry, carried_after, record
from fraese.motor.horizon import Horizon
from tests.bridge.device import MS, Device

_SILENCE_CYCLES = 30 * MS
_SLICE_CYCLES = 4_000
_ASK_CYCLES = 10 * MS
#: As the protocol advises: fewer bytes are on the way after any had to be sent again.
_LEAST_WINDOW = 30
_WINDOW_STEP = 4
_AROUND = 8


def records(blocks: Iterable[Block]) -> Iterator[bytes]:
    """The records of a stream, with the dry points that a driver would send."""
    horizon, carried = Horizon(), Carried()
    for serial, block in enumerate(blocks, 1):
        point = horizon.add(serial, block)
        dry = point and Dry(serial - point.serial, point.ticks_done)
        yield record(block, carried, dry)
        carried = carried_after(block, carried)


@dataclass
class Stream:
    """Feeds a device that has its card.

    Attributes:
        device: it.
        blocks: what to play.
        damage_every: about one frame in so many arrives damaged, lost, or twice; 0: none.
        least_free: smallest number of bytes free in the ring when a report came (fullest ring).
        sent: frames that were put on the line.
        damaged: those of them that did not arrive as they were.
        resent: those that were sent again.
        restarts: how often the queue was played before the next block had come.
    """

    device: Device
    blocks: Iterable[Block]
    damage_every: int = 0
    sent: int = 0
    damaged: int = 0
    resent: int = 0
    restarts: int = 0
    least_free: int = 1 << 16
    _unacknowledged: deque[tuple[int, bytes, int]] = field(default_factory=deque)

    def __post_init__(self) -> None:
        self._source = records(self.blocks)
        self._waiting = bytearray()
        self._dry = False
        self._chance = random.Random(5)
        self._acknowledged_at = self.device.avr.cycle
        self._window = c.WINDOW
        self._gap_at = (0, 0)
        self._asked_at = 0

    def fill(self) -> None:
        """Until the ring is full or nothing is left."""
        before = None
        while (
            before != (self._sent_all, self.device.ack and self.device.ack.free)
            or self._unacknowledged
        ):
            before = (self._sent_all, self.device.ack and self.device.ack.free)
            for _ in range(8):
                self.step()

    @property
    def _sent_all(self) -> bool:
        return self._dry and not self._waiting and not self._unacknowledged

    def run(self, cycles: int, sending: bool = True) -> None:
        """Let time pass; without ``sending`` the host stands still."""
        end = self.device.avr.cycle + cycles
        while self.device.avr.cycle < end:
            if sending:
                self.step()
            else:
                self.device.run(_SLICE_CYCLES)

    def finish(self, limit_s: float = 60.0, watch: Callable[[], None] = lambda: None) -> None:
        """Until the motors stand and nothing is left to send; ``watch`` is called now and then."""
        end = self.device.avr.cycle + int(limit_s * 1000 * MS)
        while not (self._sent_all and self._stands(played=True)):
            assert self.device.avr.cycle < end, "it did not end in time"
            for _ in range(80):
                self.step()
            watch()
            self.device.status = None
            self.device.urgent(c.URGENT_STATUS)
            for _ in range(20):
                self.step()
            if self._stands(played=False) and not self._unacknowledged:
                # The queue was played while blocks were on the line.
                self.restarts += 1
                self._post(c.KIND_START, b"\0", 0)

    def _stands(self, played: bool) -> bool:
        status = self.device.status
        if status is None or status.state & c.State.MOVING:
            return False
        return (status.place.serial == status.last and status.last > 0) == played

    def step(self) -> None:
        """Send what may be sent, then let a quarter of a millisecond pass."""
        self._take_acks()
        self._send()
        if self.device.avr.cycle - self._asked_at > _ASK_CYCLES:
            self._asked_at = self.device.avr.cycle
            self.device.urgent(c.URGENT_STATUS)
        self.device.run(_SLICE_CYCLES)

    def _take_acks(self) -> None:
        ack, now = self.device.ack, self.device.avr.cycle
        if ack is None:
            return
        self.least_free = min(self.least_free, ack.free)
        while self._unacknowledged and (ack.next_seq - self._unacknowledged[0][0] - 1) & 0xFF < 128:
            self._unacknowledged.popleft()
            self._acknowledged_at = now
            self._window = min(c.WINDOW, self._window + _WINDOW_STEP)
        if not self._unacknowledged:
            self._acknowledged_at = now
        gap = ack.gap and (self._gap_at[0] != ack.next_seq or now - self._gap_at[1] > 10 * MS)
        if self._unacknowledged and (gap or now - self._acknowledged_at > _SILENCE_CYCLES):
            self._gap_at = (ack.next_seq, now)
            self._acknowledged_at = now
            self._window = max(_LEAST_WINDOW, self._window // 2)
            for _, data, _ in self._unacknowledged:
                self.resent += 1
                self._onto_the_line(data)

    def _send(self) -> None:
        free = self.device.ack.free if self.device.ack else 0
        free -= sum(size for _, _, size in self._unacknowledged)
        while True:
            while len(self._waiting) < c.PAYLOAD_MAX - 1 and not self._dry:
                more = next(self._source, None)
                self._dry = more is None
                self._waiting += more or b""
            size = min(c.PAYLOAD_MAX - 1, self._window - _AROUND)
            part = bytes(self._waiting[:size])
            if not part or len(part) > free:
                return
            data = frame(c.KIND_BLOCKS, self.device.sequence, b"\0" + part)
            flying = sum(len(d) for _, d, _ in self._unacknowledged)
            if flying and flying + len(data) > self._window:
                return
            self._post(c.KIND_BLOCKS, b"\0" + part, len(part))
            free -= len(part)
            del self._waiting[: len(part)]

    def _post(self, kind: int, payload: bytes, size: int) -> None:
        sequence = self.device.sequence
        self.device.sequence = (sequence + 1) & 0xFF
        data = frame(kind, sequence, payload)
        self._unacknowledged.append((sequence, data, size))
        self._onto_the_line(data)

    def _onto_the_line(self, data: bytes) -> None:
        self.sent += 1
        if self.damage_every and not self._chance.randrange(self.damage_every):
            self.damaged += 1
            kind = self._chance.randrange(4)
            if kind == 0:
                return
            if kind == 1:
                data += data
            else:
                at = self._chance.randrange(len(data))
                other = data[at] ^ self._chance.randrange(1, 256)
                data = data[:at] + bytes((other,)) + data[at + 1 :]
        self.device.avr.feed(data)
