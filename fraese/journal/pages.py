"""Records as pages: bytes that say by themselves whether they are whole.

    a record = page 0 | page 1 | ... | page n-1          one sequence number, one count
    a page   = magic 4, version 2, index 2, count 2, used 2, sequence 8, data, digest 16; 512 bytes

Rule 1: a page is as large as what a disk writes at once, and each has a digest of its own. So a
        write that a power cut broke off (whole pages of two records) is told from damage (a page
        that fits no digest).
Rule 2: no page is ever all zero: one that was never written is a page too, of sequence 0. What a
        disk lost and gives back as zeros is damage.
Rule 3: the digest is SHA-256, cut to 128 bits: no burst of changed bits slips through, as some do
        a CRC, it is in the standard library, and a record takes it some ten microseconds.
Rule 4: magic, version and digest stand in these places in every version to come.
"""

import hashlib
import struct
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Final

PAGE: Final = 512
PAGES: Final = 64
SLOT: Final = PAGE * PAGES
VERSION: Final = 1

_MAGIC: Final = b"frj\n"
_HEAD: Final = struct.Struct(">4sHHHHQ")
_DIGEST: Final = 16
_DATA: Final = PAGE - _HEAD.size - _DIGEST

#: A record has no more bytes.
MOST_BYTES: Final = _DATA * PAGES


@dataclass(frozen=True, slots=True)
class Page:
    """A page that fits its digest."""

    version: int
    index: int
    count: int
    sequence: int
    data: bytes


class Condition(Enum):
    """What became of a slot."""

    #: A record, as it was written.
    WHOLE = auto()
    #: A write was broken off; what it was to replace is gone, and it was never finished.
    BROKEN_OFF = auto()
    #: Never written.
    BLANK = auto()
    #: Some byte is another than was written.
    DAMAGED = auto()
    #: Another version of this program wrote it.
    NEWER = auto()


@dataclass(frozen=True, slots=True)
class Slot:
    """What was found in a slot.

    Attributes:
        condition: what became of it.
        sequence: of the record, or of its first page; None: that cannot be read.
        payload: of a whole record.
    """

    condition: Condition
    sequence: int | None = None
    payload: bytes = b""


def blank_slot() -> bytes:
    """A slot that was never written."""
    return b"".join(_page(index, 0, 0, b"") for index in range(PAGES))


def record(payload: bytes, sequence: int) -> bytes:
    """The pages of a record.

    Raises:
        ValueError: if it is too long.
    """
    if len(payload) > MOST_BYTES:
        raise ValueError(f"a record of {len(payload)} bytes; {MOST_BYTES} are the most")
    parts = [payload[at : at + _DATA] for at in range(0, len(payload), _DATA)] or [b""]
    return b"".join(_page(index, len(parts), sequence, part) for index, part in enumerate(parts))


def read_slot(content: bytes) -> Slot:
    """What a slot of the file holds; pages that are missing are damage."""
    pages = [_read(content[at : at + PAGE]) for at in range(0, SLOT, PAGE)]
    first = pages[0]
    if any(page is not None and page.version != VERSION for page in pages):
        return Slot(Condition.NEWER)
    if first is None:
        return Slot(Condition.DAMAGED)
    if first.count and _belong(pages[: first.count], first):
        payload = b"".join(page.data for page in pages[: first.count] if page is not None)
        return Slot(Condition.WHOLE, first.sequence, payload)
    if any(page is None for page in pages):
        return Slot(Condition.DAMAGED, first.sequence)
    if any(page is not None and page.sequence for page in pages):
        return Slot(Condition.BROKEN_OFF, first.sequence)
    return Slot(Condition.BLANK, 0)


def _belong(pages: Iterable[Page | None], first: Page) -> bool:
    return all(
        page is not None and (page.sequence, page.count) == (first.sequence, first.count)
        for page in pages
    )


def _page(index: int, count: int, sequence: int, data: bytes) -> bytes:
    head = _HEAD.pack(_MAGIC, VERSION, index, count, len(data), sequence)
    body = head + data.ljust(_DATA, b"\0")
    return body + _digest(body)


def _read(content: bytes) -> Page | None:
    """A page, if it is one."""
    body, digest = content[:-_DIGEST], content[-_DIGEST:]
    if len(content) != PAGE or digest != _digest(body):
        return None
    magic, version, index, count, used, sequence = _HEAD.unpack_from(body)
    if magic != _MAGIC:
        return None
    return Page(version, index, count, sequence, body[_HEAD.size : _HEAD.size + used])


def _digest(body: bytes) -> bytes:
    return hashlib.sha256(body).digest()[:_DIGEST]
