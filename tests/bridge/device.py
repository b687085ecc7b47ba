"""The real firmware in the simulated microcontroller, with a host so plain that tests can trust it.

    Device.upload(card) -> push(blocks) -> start() -> run ... -> writes()

Rule 1: the host here sends one frame at a time and waits for its acknowledgement, except in
        ``stream``, which keeps the window full. It knows nothing of drivers.
Rule 2: time is the microcontroller's; nothing waits for the wall.
"""

import subprocess
from collections.abc import Callable, Sequence
from fcntl import LOCK_EX, flock
from functools import cache
from pathlib import Path

from fraese.blocks import Block
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import CardFacts, card_commands
from fraese.motor.bridge.codec import (
    Ack,
    Decoder,
    Frame,
    Hello,
    Status,
    frame,
    hello,
)
from fraese.motor.bridge.records import Carried, Dry, carried_after, record
from rigs.avr import board
from rigs.avr.binding import SRAM_END
from rigs.avr.build import missing
from rigs.avr.simavr import Avr

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware"
MS = 16_000
SESSION = 4711


@cache
def image(baud: int = c.DEFAULT_BAUD, board_name: str = "uno") -> Path:
    """The firmware for a board, built; by one process at a time."""
    elf = f"build/{board_name}-{baud}/fraese.elf"
    place = FIRMWARE / "build"
    place.mkdir(exist_ok=True)
    command = ["make", "-s", "-C", str(FIRMWARE), f"BOARD={board_name}", f"BAUD={baud}", elf]
    with (place / "lock").open("w") as lock:
        flock(lock, LOCK_EX)
        subprocess.run(command, check=True, capture_output=True)
    return FIRMWARE / elf


def reason_to_skip() -> str:
    """Why the firmware cannot be tried here; empty if it can."""
    return missing()


class Device:
    """A microcontroller that has just been switched on.

    Attributes:
        avr: the simulated chip.
        status: the last STATUS.
        ack: the last acknowledgement.
        frames: everything received.
    """

    def __init__(self, session: int = SESSION, baud: int = c.DEFAULT_BAUD) -> None:
        self._image = image(baud)
        self.avr = Avr(self._image)
        self.status: Status | None = None
        self.ack: Ack | None = None
        self.hello: Hello | None = None
        self.frames: list[Frame] = []
        self._decoder = Decoder()
        #: Cycle from which on a test looks at the writes.
        self.mark = 0
        self.sequence = 0
        self._carried = Carried()
        self.avr.run(20 * MS)
        self.avr.feed(hello(session))
        self.wait(lambda: self.hello is not None)

    # -- time and frames

    def run(self, cycles: int) -> None:
        """Let time pass, and read what comes."""
        self.avr.run(cycles)
        for item in self._decoder.feed(self.avr.take()):
            assert isinstance(item, Frame)
            self.frames.append(item)
            if item.kind == c.KIND_STATUS:
                self.status = Status.parse(item.payload)
                self.ack = self.status.ack
            elif item.kind == c.KIND_ACK:
                self.ack = Ack.parse(item.payload)
            elif item.kind == c.KIND_HELLO_REPLY:
                self.hello = Hello.parse(item.payload)

    def wait(self, done: Callable[[], bool], limit_ms: int = 200, slice_cycles: int = 4000) -> None:
        """Let time pass until something is so."""
        end = self.avr.cycle + limit_ms * MS
        while not done():
            assert self.avr.cycle < end, "it did not happen in time"
            self.run(slice_cycles)

    def send(self, kind: int, payload: bytes = b"", before_cycle: int = 0) -> None:
        """A command, without waiting; as a whole on the wire at a cycle that is still to come."""
        data = frame(kind, self.sequence, payload)
        start = before_cycle - round(len(data) * 10 * self.avr.bit_cycles) if before_cycle else 0
        self.avr.feed(data, at_cycle=start)
        self.sequence = (self.sequence + 1) & 0xFF

    def command(self, kind: int, payload: bytes = b"") -> int:
        """A command, acknowledged; the code with which it was refused, 0 if it was not."""
        number = self.sequence
        self.send(kind, payload)
        wanted = self.sequence
        self.wait(lambda: self.ack is not None and self.ack.next_seq == wanted)
        assert self.ack is not None
        return self.ack.refused_code if self.ack.refused_seq == number else 0

    def urgent(self, byte: int, at_cycle: int = 0) -> None:
        """A single byte between frames."""
        self.avr.feed(bytes((byte,)), at_cycle=at_cycle)

    def ask(self) -> Status:
        """The present STATUS."""
        self.wait(lambda: not self.avr.backlog)
        self.run(12 * MS)
        self.status = None
        self.urgent(c.URGENT_STATUS)
        self.wait(lambda: self.status is not None)
        assert self.status is not None
        return self.status

    # -- cards and blocks

    def upload(self, facts: CardFacts) -> None:
        """Make it this card."""
        for kind, payload in card_commands(facts):
            assert self.command(kind, payload) == 0

    def stream_of(self, blocks: Sequence[Block], dry: Sequence[Dry | None]) -> bytes:
        """The records of some blocks, going on from those before."""
        out = bytearray()
        for block, point in zip(blocks, dry, strict=True):
            out += record(block, self._carried, point)
            self._carried = carried_after(block, self._carried)
        return bytes(out)

    def begin_epoch(self) -> None:
        """The queue was dropped: records say everything anew."""
        self._carried = Carried()

    def push(
        self, blocks: Sequence[Block], dry: Sequence[Dry | None] | None = None, epoch: int = 0
    ) -> None:
        """Put blocks into the ring, as far as there is room; the rest must fit later."""
        data = self.stream_of(blocks, dry or [None] * len(blocks))
        while data:
            part, data = data[: c.PAYLOAD_MAX - 1], data[c.PAYLOAD_MAX - 1 :]
            if self.ack is not None:
                self._wait_for_room(len(part))
            assert self.command(c.KIND_BLOCKS, bytes((epoch,)) + part) == 0

    def _wait_for_room(self, size: int) -> None:
        self.wait(lambda: self.free >= size, 20_000)

    @property
    def ring(self) -> int:
        """Bytes of records that it holds."""
        assert self.hello is not None
        return self.hello.ring

    @property
    def free(self) -> int:
        """Credit; asks for a report when it is old."""
        return self.ask().ack.free

    def start(self, epoch: int = 0) -> None:
        """Play what is queued."""
        assert self.command(c.KIND_START, bytes((epoch,))) == 0

    def stand_still(self, limit_ms: int = 60_000) -> Status:
        """Wait until the motors stand, for whatever reason."""

        def stands() -> bool:
            return self.status is not None and not self.status.state & c.State.MOVING

        self.status = None
        self.wait(stands, limit_ms, 20_000)
        return self.ask()

    def stack_free(self) -> int:
        """Bytes above all variables that the stack has never touched."""
        listing = subprocess.run(
            ["avr-nm", str(self._image)], check=True, capture_output=True, text=True
        ).stdout
        end = next(
            int(line.split()[0], 16) for line in listing.splitlines() if "_end" in line.split()[2:]
        )
        memory = self.avr.peek(end & 0xFFFF, SRAM_END - (end & 0xFFFF))
        return next((i for i, byte in enumerate(memory) if byte != memory[0]), len(memory))

    def accesses(self) -> board.Accesses:
        """All register writes so far, in the parallel port's terms."""
        return board.decode(self.avr.log())
