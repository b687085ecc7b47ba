"""What a file held at one moment: read once, and from then on only the copy.

Rule 1: memory does not grow with the file: a larger copy lies in a temporary file without a name.
Rule 2: a copy is all of one state of the file: what is written meanwhile is not taken.
Rule 3: it can be read by several at once, from any thread.
"""

import hashlib
import io
import os
import tempfile
import threading
import weakref
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, BinaryIO, Final

from fraese.errors import ProgramError
from fraese.gcode.text import lines_of, open_plain
from fraese.phrases import phrase, reason

#: Up to here a copy is kept in memory.
_IN_MEMORY_BYTES: Final = 4 << 20
#: No program is larger; a file that is would fill the disk.
MOST_BYTES: Final = 1 << 30
_CHUNK_BYTES: Final = 1 << 18
#: A file that is larger holds something.
_MOST_BLANKS: Final = 4096
#: So often a file that changes while it is copied is begun anew.
_TRIES: Final = 3


@dataclass(frozen=True, slots=True)
class Stamp:
    """What the file system says of a file: another one, or changed, if any of it differs."""

    device: int
    inode: int
    size: int
    changed_ns: int

    @classmethod
    def of(cls, seen: os.stat_result) -> "Stamp":
        """As it was seen."""
        return cls(seen.st_dev, seen.st_ino, seen.st_size, seen.st_mtime_ns)


class Content:
    """The copy of a file.

    Args:
        file: name in messages.
        stream: it is read from here; closed when nobody needs the copy any more.
        content_hash: SHA-256, in hexadecimal.
        size: in bytes.
        stamp: of the file when it was copied; None: it did not come from one.
    """

    def __init__(
        self, file: str, stream: BinaryIO, content_hash: str, size: int, stamp: Stamp | None = None
    ) -> None:
        self.file = file
        self.content_hash = content_hash
        self.size = size
        self.stamp = stamp
        self._stream = stream
        self._lock = threading.Lock()
        weakref.finalize(self, stream.close)

    def open(self) -> io.BufferedReader:
        """A reader of its own, at the beginning."""
        return io.BufferedReader(_Reading(self), _CHUNK_BYTES)

    @property
    def is_blank(self) -> bool:
        """There is nothing in it but blanks."""
        if self.size > _MOST_BLANKS:
            return False
        with self.open() as stream:
            return not stream.read().strip()

    def lines(self) -> Generator[str, None, None]:
        """Its lines without their ends.

        Raises:
            ProgramError: it is binary, or has a line that is too long.
        """
        return lines_of(self.open(), self.file)

    def starts_with(self, marks: tuple[bytes, ...]) -> bool:
        """Whether it begins with one of these."""
        head = bytearray(max(map(len, marks)))
        return bytes(head[: self.read_at(0, memoryview(head))]).startswith(marks)

    def read_at(self, at: int, into: memoryview) -> int:
        """Fill a buffer from a place on; how many bytes there were."""
        with self._lock:
            self._stream.seek(at)
            return self._stream.readinto(into)  # type: ignore[attr-defined, no-any-return]


class _Reading(io.RawIOBase):
    """One reader's place in a copy."""

    def __init__(self, content: Content) -> None:
        self._content = content
        self._at = 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        count = self._content.read_at(self._at, buffer)
        self._at += count
        return count


def take(path: Path, file: str = "") -> Content | None:
    """Copy a plain file; None: there is none.

    Args:
        path: the file.
        file: its name in messages; the path as given where empty.

    Raises:
        ProgramError: it cannot be read, is too large, or changes all the time.
    """
    file = file or str(path)
    for _ in range(_TRIES):
        stream = open_plain(path, file)
        if stream is None:
            return None
        with stream:
            before = os.fstat(stream.fileno())
            content = taken_from(stream, file, before.st_size, Stamp.of(before))
            after = os.fstat(stream.fileno())
        if Stamp.of(after) == content.stamp and content.size == after.st_size:
            return content
    raise ProgramError(phrase("is being written just now; open it when that is done."), file=file)


def taken_from(
    stream: IO[bytes],
    file: str,
    size: int,
    stamp: Stamp | None = None,
) -> Content:
    """Copy so many bytes from a stream, or all that it has.

    Raises:
        ProgramError: it cannot be read or kept, or is too large.
    """
    if size > MOST_BYTES:
        raise ProgramError(
            phrase(
                "is larger than {most_bytes} MB, the most there can be.",
                most_bytes=MOST_BYTES >> 20,
            ),
            0,
            file,
        )
    copy = tempfile.SpooledTemporaryFile(_IN_MEMORY_BYTES)  # noqa: SIM115
    digest, left = hashlib.sha256(), size
    try:
        while left and (chunk := stream.read(min(_CHUNK_BYTES, left))):
            digest.update(chunk)
            copy.write(chunk)
            left -= len(chunk)
    except OSError as error:
        copy.close()
        raise ProgramError(
            phrase("cannot be copied: {reason}.", reason=reason(error)), file=file
        ) from error
    return Content(file, copy, digest.hexdigest(), size - left, stamp)  # type: ignore[arg-type]


def is_still(path: Path, content: Content) -> bool | None:
    """Whether a file holds what was copied from it; None: it is gone, or cannot be read."""
    try:
        stamp = Stamp.of(os.stat(path))
        if stamp == content.stamp:
            return True
        if stamp.size != content.size:
            return False
        again = take(path)
    except (OSError, ProgramError):
        return None
    return None if again is None else again.content_hash == content.content_hash
