"""A ring of records between one writer and one reader, without locks.

    |....[rec][rec][rec....][0]|      [0]: nothing more here, go on at the start
         ^tail              ^head     both count bytes and never go back

Rule 1: the writer owns the head, the reader the tail. The record is there before the head says so,
        and is not touched any more when the tail has passed it.
Rule 2: a record lies in one piece. Where the rest up to the end is too short, it is skipped.
Rule 3: all records are multiples of eight bytes, so that there is always room for the mark.
"""

import struct

from fraese.motor.realtime.memory import RING_HEAD, RING_TAIL
from fraese.motor.realtime.records import size_at


class RingWriter:
    """The parent's end.

    Args:
        words: holds head and tail.
        ring: the bytes.
    """

    def __init__(self, words: memoryview, ring: memoryview) -> None:
        self._words = words
        self._ring = ring
        self._bytes = len(ring)

    def put(self, record: bytes) -> bool:
        """Take a record; False: no room, nothing was taken.

        Raises:
            ValueError: if there would be no room even in an empty ring.
        """
        if not self.has_room(len(record)):
            return False
        head: int = self._words[RING_HEAD]
        at, skipped = head % self._bytes, self._skipped(len(record))
        if skipped:
            struct.pack_into("=q", self._ring, at, 0)
            at = 0
        self._ring[at : at + len(record)] = record
        self._words[RING_HEAD] = head + skipped + len(record)
        return True

    def has_room(self, size: int) -> bool:
        """A record of so many bytes can be put.

        Raises:
            ValueError: if there would be no room even in an empty ring.
        """
        # Half: the rest up to the end may have to be skipped.
        if size > self._bytes // 2:
            raise ValueError(f"a block of {size} bytes is too long for the ring")
        filled: int = self._words[RING_HEAD] - self._words[RING_TAIL]
        return filled + self._skipped(size) + size <= self._bytes

    def _skipped(self, size: int) -> int:
        """Bytes up to the end of the ring, where they do not suffice for a record."""
        left: int = self._bytes - self._words[RING_HEAD] % self._bytes
        return left if size > left else 0


class RingReader:
    """The child's end. The arguments are the writer's."""

    def __init__(self, words: memoryview, ring: memoryview) -> None:
        self._words = words
        self._ring = ring
        self._bytes = len(ring)

    def first(self) -> int:
        """Where the first record begins; there must be one."""
        tail: int = self._words[RING_TAIL]
        at = tail % self._bytes
        if not size_at(self._ring, at):
            self._words[RING_TAIL] = tail + self._bytes - at
            at = 0
        return at

    def drop_first(self) -> None:
        """The first record has been read: its room is free."""
        at = self.first()
        self._words[RING_TAIL] += size_at(self._ring, at)
