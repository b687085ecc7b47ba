r"""What the step process leaves when it ends: where the motors stand, in a small file.

    host --opens--> file --descriptor--> child ... host killed ... brake, off, last words, end
    next program --read--> LastWords: the count to the step

Rule 1: written once, after the motors stand and are off: what is there is final. It is synced if
        the host is dead; one that lives keeps a better record. A child that is killed, or fails,
        leaves none; half a record is none.
Rule 2: words belong to one session, by the token that the host chose; counts are those of the
        host's driver, over all its step processes.
Rule 3: a file that is a link, a pipe or a device is not read.
"""

import os
import stat
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from fraese.motor.realtime.report import MAX_MOTORS
from fraese.motor.seams import Ended

TOKEN_BYTES: Final = 16
_MAGIC: Final = b"fraeseL2"
_ENDS: Final = tuple(Ended)
#: Magic, token, motors, torn as bits, ended, whether the ways are known, counts, phases, ways; a
#: checksum follows.
_WORDS: Final = struct.Struct(f"<8s{TOKEN_BYTES}sBBBB{3 * MAX_MOTORS}q")
_SUM: Final = struct.Struct("<I")
#: Length of the file.
SIZE: Final = _WORDS.size + _SUM.size


@dataclass(frozen=True, slots=True)
class LastWords:
    """How the motors were left.

    Attributes:
        token: of the session, as the host gave it.
        position_steps: signed count of every motor since the host's driver was opened.
        phases: phase index of every motor; net pulses where drives keep their own.
        torn: motors that stopped without ramp above their start/stop rate.
        ended: why they stood, before they were switched off.
        travelled_steps: the count of every motor, both directions added, since then; empty: nobody
            knows.
    """

    token: bytes
    position_steps: tuple[int, ...]
    phases: tuple[int, ...]
    torn: frozenset[int]
    ended: Ended
    travelled_steps: tuple[int, ...] = ()

    def packed(self) -> bytes:
        """As they stand in the file."""
        motors = len(self.position_steps)
        words = _WORDS.pack(
            _MAGIC, self.token, motors, sum(1 << motor for motor in self.torn),
            _ENDS.index(self.ended), bool(self.travelled_steps), *_filled(self.position_steps),
            *_filled(self.phases), *_filled(self.travelled_steps),
        )  # fmt: skip
        return words + _SUM.pack(zlib.crc32(words))


def unpacked(data: bytes) -> LastWords | None:
    """What ``packed`` made; None: these are no whole last words."""
    if len(data) != SIZE or _SUM.unpack(data[_WORDS.size :])[0] != zlib.crc32(data[: _WORDS.size]):
        return None
    magic, token, motors, torn, ended, has_ways, *counts = _WORDS.unpack(data[: _WORDS.size])
    if magic != _MAGIC or motors > MAX_MOTORS or ended >= len(_ENDS):
        return None
    return LastWords(
        token=token,
        position_steps=tuple(counts[:motors]),
        phases=tuple(counts[MAX_MOTORS : MAX_MOTORS + motors]),
        torn=frozenset(motor for motor in range(motors) if torn >> motor & 1),
        ended=_ENDS[ended],
        travelled_steps=tuple(counts[2 * MAX_MOTORS :][:motors]) if has_ways else (),
    )


def open_for(path: Path) -> int:
    """A descriptor for a session's last words, the file empty; close it when the driver is closed.

    Raises:
        OSError: if it cannot be made, or is a link.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
    fd = os.open(path, flags, 0o600)
    try:
        if not stat.S_ISREG(os.fstat(fd).st_mode):
            raise OSError(f"{path} is no file")
        os.ftruncate(fd, 0)
    except BaseException:
        os.close(fd)
        raise
    return fd


def read(path: Path) -> LastWords | None:
    """What was left in a file; None: nothing, or nothing whole."""
    try:
        fd = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return None
    try:
        if not stat.S_ISREG(os.fstat(fd).st_mode):
            return None
        return unpacked(os.read(fd, SIZE + 1))
    finally:
        os.close(fd)


def leave(fd: int, words: LastWords, *, durable: bool = True) -> None:
    """Write, and sync if it is to outlive the computer too."""
    os.pwrite(fd, words.packed(), 0)
    if durable:
        os.fsync(fd)


def _filled(values: Sequence[int]) -> list[int]:
    return [*values, *[0] * (MAX_MOTORS - len(values))]
