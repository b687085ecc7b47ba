r"""Which block had which number: a file that tells the next program what a device's words mean.

    head    session, base counts and phases    once a session
    slot    serial, steps, ticks, start        before the block is sent; the serial says in which

    serial    4       5       6       7
    start   (9,0)   (9,3)   ...                place (serial 5, done 40) = 40 ticks after (9,3)

Rule 1: a block stands here before its first byte is on the line: whatever the device has in hand is
        found, however suddenly the program ended.
Rule 2: nothing is synced and nobody waits: the file outlives the program, not the computer. So it
        says in which run of the computer it was written, and in another one nothing of it holds.
Rule 3: every part has a checksum that begins with the session: half of one, or one of an earlier
        session, is none.
Rule 4: an older ledger is left alone until a session begins: then the device has forgotten, too.
Rule 5: what cannot be written is not worth an alarm: then nothing is known after a crash.
"""

import struct
import uuid
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final, NamedTuple

from fraese.motor.bridge.constants import MOTORS_MAX

TOKEN_BYTES: Final = 16
_MAGIC: Final = b"fraeseB1"
#: Blocks that are remembered: more than twice as many as are ever taken before they are played.
SLOTS: Final = 512
#: Magic, token, run of the computer, session, motors, length of the table, counts, phases.
_HEAD: Final = struct.Struct(f"<8s{TOKEN_BYTES}s16sHBB{MOTORS_MAX}q{MOTORS_MAX}q")
#: Serial, ticks, steps, counts where it begins.
_SLOT: Final = struct.Struct(f"<HI{MOTORS_MAX}i{MOTORS_MAX}q")
_SUM: Final = struct.Struct("<I")
_SLOT_BYTES: Final = _SLOT.size + _SUM.size
_SLOTS_AT: Final = 128
SIZE: Final = _SLOTS_AT + SLOTS * _SLOT_BYTES

StepCounts = tuple[int, ...]


class Ledger:
    """Nothing is written down: what stands behind a driver without a state folder."""

    def begin(self, session: int, table: int, counts: StepCounts, phases: StepCounts) -> None:
        """A session begins, at standstill.

        Args:
            session: its number.
            table: length of the phase table; 0: drives keep their phases themselves.
            counts: of every motor, since the driver was opened.
            phases: as the device was told; net pulses where there is no table.
        """

    def note(self, serial: int, steps: StepCounts, ticks: int, start: StepCounts) -> None:
        """A block will be sent.

        Args:
            serial: the device's number for it.
            steps: of every motor.
            ticks: how many it has.
            start: counts where it begins.
        """

    def close(self) -> None:
        """Nothing more will be written."""


class FileLedger(Ledger):
    """Writes it down.

    Args:
        file: without a buffer; closed with this.
        token: of the driver's owner, who will know it again.
        boot: which run of the computer this is, see ``this_boot``.
    """

    def __init__(self, file: BinaryIO, token: bytes, boot: bytes) -> None:
        self._file = file
        self._token, self._boot = token, boot
        self._seed: int | None = None

    def begin(self, session: int, table: int, counts: StepCounts, phases: StepCounts) -> None:
        """A session begins; what was written in another one holds no more."""
        if self._seed is None:
            # What is written later needs no more room.
            self._put(0, bytes(SIZE))
        self._seed = _seed(self._token, session)
        head = _HEAD.pack(
            _MAGIC, self._token, self._boot, session, len(counts), table,
            *_filled(counts), *_filled(phases),
        )  # fmt: skip
        # Before its first block, a device stands at the end of one without steps.
        self.note(0, (0,) * len(counts), 0, counts)
        self._put(0, head + _SUM.pack(zlib.crc32(head)))

    def note(self, serial: int, steps: StepCounts, ticks: int, start: StepCounts) -> None:
        """A block will be sent."""
        slot = _SLOT.pack(serial, ticks, *_filled(steps), *_filled(start))
        self._put(_at(serial), slot + _SUM.pack(zlib.crc32(slot, self._seed or 0)))

    def close(self) -> None:
        """Nothing more will be written. Safe to call twice."""
        self._file.close()

    def _put(self, offset: int, data: bytes) -> None:
        """See rule 5: from the first failure on the file stays as it is."""
        if self._file.closed:
            return
        try:
            self._file.seek(offset)
            if self._file.write(data) == len(data):
                return
        except OSError:
            pass
        self._file.close()


class Entry(NamedTuple):
    """A block: see ``Ledger.note``."""

    serial: int
    ticks: int
    steps: StepCounts
    start: StepCounts


@dataclass(frozen=True)
class Book:
    """A ledger as it was left; the fields are those of ``Ledger.begin``.

    Attributes:
        token: of the driver's owner.
        boot: in which run of the computer it was written.
    """

    token: bytes
    boot: bytes
    session: int
    table: int
    counts: StepCounts
    phases: StepCounts
    _data: bytes

    def entry(self, serial: int) -> Entry | None:
        """The block with that number; None: it was never to be sent, or long ago."""
        part = self._data[_at(serial) :][:_SLOT_BYTES]
        slot, given = part[: _SLOT.size], _SUM.unpack(part[_SLOT.size :])[0]
        if given != zlib.crc32(slot, _seed(self.token, self.session)):
            return None
        number, ticks, *rest = _SLOT.unpack(slot)
        motors = len(self.counts)
        steps, start = rest[:motors], rest[MOTORS_MAX:][:motors]
        return Entry(number, ticks, tuple(steps), tuple(start)) if number == serial else None


def book_in(data: bytes) -> Book | None:
    """A ledger from the bytes of its file; None: it is none, or not a whole one."""
    if len(data) != SIZE:
        return None
    head, given = data[: _HEAD.size], _SUM.unpack_from(data, _HEAD.size)[0]
    if given != zlib.crc32(head):
        return None
    magic, token, boot, session, motors, table, *rest = _HEAD.unpack(head)
    if magic != _MAGIC or not 0 < motors <= MOTORS_MAX:
        return None
    counts, phases = rest[:motors], rest[MOTORS_MAX:][:motors]
    return Book(token, boot, session, table, tuple(counts), tuple(phases), data)


def this_boot(root: Path = Path("/")) -> bytes:
    """Which run of the computer this is; empty: the system does not say."""
    try:
        text = (root / "proc/sys/kernel/random/boot_id").read_text("ascii")
        return uuid.UUID(text.strip()).bytes
    except (OSError, ValueError):
        return b""


def _at(serial: int) -> int:
    return _SLOTS_AT + serial % SLOTS * _SLOT_BYTES


def _seed(token: bytes, session: int) -> int:
    return zlib.crc32(token + session.to_bytes(2, "little"))


def _filled(values: StepCounts) -> list[int]:
    return [*values, *[0] * (MOTORS_MAX - len(values))]
