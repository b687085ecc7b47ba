"""Frames of the bridge protocol: bytes to frames and back, no line, no time.

    FLAG | kind | sequence | payload ... | crc high | crc low | FLAG
          `------------- stuffed: ESCAPE, byte ^ 0x20 -------------'

Rule 1: nothing of a frame is believed before its CRC is.
Rule 2: both directions are framed alike; only the host has single-byte urgents.
Rule 3: what is damaged is thrown away and counted, never repaired here.
"""

import binascii
import struct
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from fraese.motor.bridge.constants import (
    ABLE_CLOCKS,
    ABLE_PHASES,
    ABLE_POWER,
    ACK_GAP,
    CRC_START,
    ESCAPE,
    ESCAPE_XOR,
    FLAG,
    KIND_HELLO,
    PAYLOAD_MAX,
    PROTOCOL_VERSION,
    RESERVED,
    RESERVED_MASK,
    More,
    State,
)

_LONGEST: Final = 2 + PAYLOAD_MAX + 2
_SHORTEST: Final = 4


class Frame(NamedTuple):
    """What stands between two FLAGs, its CRC checked and taken off."""

    kind: int
    sequence: int
    payload: bytes


class Urgent(NamedTuple):
    """A single-byte command that counts."""

    byte: int


def stuffed(content: bytes) -> bytes:
    """The same without reserved bytes."""
    out = bytearray()
    for byte in content:
        if byte & RESERVED_MASK == RESERVED:
            out += bytes((ESCAPE, byte ^ ESCAPE_XOR))
        else:
            out.append(byte)
    return bytes(out)


def frame(kind: int, sequence: int, payload: bytes = b"") -> bytes:
    """A whole frame as it stands on the line, both FLAGs included.

    Raises:
        ValueError: if the payload is longer than ``PAYLOAD_MAX`` bytes.
    """
    if len(payload) > PAYLOAD_MAX:
        raise ValueError(f"a payload of {len(payload)} bytes; {PAYLOAD_MAX} at most")
    content = bytes((kind, sequence & 0xFF)) + payload
    crc = binascii.crc_hqx(content, CRC_START)
    return bytes((FLAG,)) + stuffed(content + crc.to_bytes(2, "big")) + bytes((FLAG,))


class Decoder:
    """Takes bytes as they come, in pieces of any size, and gives what they mean.

    Attributes:
        damaged: frames that were thrown away.
    """

    def __init__(self) -> None:
        self.damaged = 0
        self._content = bytearray()
        self._open = False
        self._escaped = False
        self._broken = False
        self._previous = FLAG

    def feed(self, data: bytes) -> list[Frame | Urgent]:
        """Everything that came to its end with these bytes."""
        found: list[Frame | Urgent] = []
        for byte in data:
            item = self._take(byte)
            if item is not None:
                found.append(item)
            self._previous = byte
        return found

    def _take(self, byte: int) -> Frame | Urgent | None:
        if byte & RESERVED_MASK != RESERVED:
            self._open = True
            self._content.append(byte ^ ESCAPE_XOR if self._escaped else byte)
            self._escaped = False
            self._broken |= len(self._content) > _LONGEST
            if self._broken:
                self._content.clear()
        elif byte == FLAG:
            return self._end()
        elif byte == ESCAPE:
            self._open = True
            self._broken |= self._escaped
            self._escaped = True
        elif not self._open or byte == self._previous:
            return Urgent(byte)
        else:
            self._broken = True
        return None

    def _end(self) -> Frame | None:
        content, was_open = bytes(self._content), self._open
        sound = not self._broken and not self._escaped and len(content) >= _SHORTEST
        self._content.clear()
        self._open = self._escaped = self._broken = False
        if sound and binascii.crc_hqx(content, CRC_START) == 0:
            return Frame(content[0], content[1], content[2:-2])
        self.damaged += was_open
        return None


def hello(session: int) -> bytes:
    """The frame that opens a session, 1 to 65535."""
    return frame(KIND_HELLO, 0, struct.pack("<BH", PROTOCOL_VERSION, session))


class Place(NamedTuple):
    """Somewhere in the path.

    Attributes:
        serial: number of the block, modulo 65536.
        done: its whole ticks.
        moved: motors, a bit each, that have stepped already in the tick after those.
    """

    serial: int
    done: int
    moved: int


def _numbers(layout: struct.Struct, payload: bytes, what: str) -> tuple[Any, ...]:
    """The fields at the beginning of a payload; what follows them is of a later version."""
    if len(payload) < layout.size:
        raise ValueError(f"{what} of {len(payload)} bytes; {layout.size} at least")
    return layout.unpack_from(payload)


@dataclass(frozen=True, slots=True)
class Hello:
    """What the device answers to HELLO.

    Attributes:
        version: of the protocol.
        session: the one that is set; another than the one sent: not accepted.
        firmware: major and minor version.
        ring: bytes of records that the device holds.
        payload_max: longest payload.
        motors: most motors of a card.
        table_max: longest phase table.
        window: most bytes without acknowledgement.
        phase_cards, clock_cards: kinds of cards it can play.
        reset_reason: MCUSR bits: 1 power-on, 2 external, 4 brown-out, 8 watchdog; 0: not known.
        boots: changes with every reset.
        moving: HELLO was refused, since motors are moving.
        board: its name.
        powers: it can set the power of a lamp.
    """

    version: int
    session: int
    firmware: tuple[int, int]
    ring: int
    payload_max: int
    motors: int
    table_max: int
    window: int
    phase_cards: bool
    clock_cards: bool
    reset_reason: int
    boots: int
    moving: bool
    board: str
    powers: bool = False

    _FORMAT = struct.Struct("<BHBBHBBBBBBHB")

    @classmethod
    def parse(cls, payload: bytes) -> "Hello":
        """From the payload of a HELLO reply.

        Raises:
            ValueError: if it is too short.
        """
        head = _numbers(cls._FORMAT, payload, "a HELLO reply")
        version, session, major, minor, ring, longest, motors, table, window = head[:9]
        able, reason, boots, moving = head[9:]
        board = payload[cls._FORMAT.size :].decode("ascii", "replace")
        return cls(
            version, session, (major, minor), ring, longest, motors, table, window,
            bool(able & ABLE_PHASES), bool(able & ABLE_CLOCKS), reason, boots, bool(moving), board,
            bool(able & ABLE_POWER),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Ack:
    """How far the device has followed.

    Attributes:
        next_seq: sequence number that it waits for.
        session: its session; 0 after a reset.
        gap: a frame came whose number lies ahead.
        epoch: rises whenever a queue is dropped.
        free: bytes of records that it takes after the frames before ``next_seq``.
        refused_seq, refused_code: the command refused last; code 0: none.
    """

    next_seq: int
    session: int
    gap: bool
    epoch: int
    free: int
    refused_seq: int
    refused_code: int

    _FORMAT = struct.Struct("<BHBBHBB")

    @classmethod
    def parse(cls, payload: bytes) -> "Ack":
        """From the payload of an ACK, or the beginning of a STATUS.

        Raises:
            ValueError: if it is too short.
        """
        next_seq, session, flags, epoch, free, seq, code = _numbers(cls._FORMAT, payload, "an ACK")
        return cls(next_seq, session, bool(flags & ACK_GAP), epoch, free, seq, code)


@dataclass(frozen=True, slots=True)
class Status:
    """A picture of one moment; the fields are those of the protocol's STATUS.

    Attributes:
        ack: how far the device has followed.
        state: flags.
        more: more flags.
        ended: number of the reason why the motors stand, see ``ended_of``.
        place: where the player is.
        last: serial of the last record received.
        interval_cycles: of the last tick; 0 at standstill.
        inputs: status register.
        latched: counts at the contact that fulfilled the last watch; valid with ``LATCHED``.
        contact_serial: block in hand at the last contact,
        contact_oldest: and the oldest that may have made it.
        late_ticks: edges later than a quarter of their interval.
        dry_queues: how often the queue ran dry, modulo 256.
        late_throttle: throttle results that were not ready in time, modulo 256.
        line_errors: damaged frames and overruns, modulo 256.
        brakes, stops: urgents that counted, modulo 256.
        override_q8: as wanted last.
        phases: phase index of every motor.
        torn_serial: low byte of the block whose tick was the last, valid with ``TORN``.
    """

    ack: Ack
    state: State
    more: More
    ended: int
    place: Place
    last: int
    interval_cycles: int
    inputs: int
    latched: Place
    contact_serial: int
    contact_oldest: int
    late_ticks: int
    dry_queues: int
    late_throttle: int
    line_errors: int
    brakes: int
    stops: int
    override_q8: int
    phases: tuple[int, ...]
    torn_serial: int

    _FORMAT = struct.Struct("<9sBBBHLBHLBHLBHHHBBBBBH4sB")

    @classmethod
    def parse(cls, payload: bytes) -> "Status":
        """From the payload of a STATUS.

        Raises:
            ValueError: if it is too short.
        """
        (
            ack, state, more, ended, serial, done, moved, last, interval, inputs,
            latched_serial, latched_done, latched_moved, contact, oldest,
            late, dry, throttle, errors, brakes, stops, override, phases, torn,
        ) = _numbers(cls._FORMAT, payload, "a STATUS")  # fmt: skip
        return cls(
            Ack.parse(ack), State(state), More(more), ended,
            Place(serial, done, moved), last, interval, inputs,
            Place(latched_serial, latched_done, latched_moved), contact, oldest,
            late, dry, throttle, errors, brakes, stops, override, tuple(phases), torn,
        )  # fmt: skip
