"""The journal of a machine: one file, two slots, written in turn.

    | record n (slot 0) | record n-1 (slot 1) |      record n+1 goes to slot 1, in place

Rule 1: a record is written in place over the older one and synced: that needs no room on a full
        disk and no new name in a folder; the newer record stays whole meanwhile.
Rule 2: what a power cut broke off was never believed by anybody: the other record holds. What is
        damaged may have been believed, and may have said "in motion": then the other record is
        found, but not trusted.
Rule 3: a record that was not trusted is not written beside: the whole file is replaced, so that
        nothing of it comes back as trusted.
Rule 4: until a record is synced the same slot is used again: the other one was.
"""

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from fraese.errors import ConfigError
from fraese.journal.files import make_folder, open_plain, read_all, replace, sync, write_all
from fraese.journal.pages import SLOT, Condition, Slot, blank_slot, read_slot, record
from fraese.phrases import phrase, reason

_SLOTS: Final = 2


@dataclass(frozen=True, slots=True)
class Found:
    """What a journal holds.

    Attributes:
        payload: the record in force.
        is_trusted: it was the last one; else a later one was damaged.
    """

    payload: bytes
    is_trusted: bool


class Journal:
    """The journal in a file.

    Args:
        path: made when first written, its folder too.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._fd: int | None = None
        self._sequence = 0
        self._slot = 0
        self._goes_on = False

    def read(self) -> Found | None:
        """What it holds; None: there is none. Writes nothing.

        Raises:
            ConfigError: if it cannot be read, is damaged, or from a newer version.
        """
        try:
            fd = open_plain(self.path, os.O_RDONLY)
            if fd is None:
                return None
            try:
                content = read_all(fd, _SLOTS * SLOT)
            finally:
                os.close(fd)
        except OSError as error:
            raise ConfigError(
                phrase(
                    "{path}: the state cannot be read: {reason}; start with --fresh.",
                    path=self.path,
                    reason=reason(error),
                )
            ) from error
        slots = [read_slot(content[at : at + SLOT]) for at in (0, SLOT)]
        return self._chosen(slots)

    def _chosen(self, slots: list[Slot]) -> Found:
        if any(slot.condition is Condition.NEWER for slot in slots):
            raise ConfigError(
                phrase(
                    "{path}: was written by another version of fraese: use that one, or"
                    " start with --fresh and reference the machine.",
                    path=self.path,
                )
            )
        whole = [slot for slot in slots if slot.condition is Condition.WHOLE]
        numbers = [slot.sequence for slot in slots if slot.sequence is not None]
        if not whole or (len(whole) == _SLOTS and len({*numbers}) == 1):
            raise ConfigError(
                phrase(
                    "{path}: is damaged; start with --fresh and reference the machine.",
                    path=self.path,
                )
            )
        best = max(whole, key=lambda slot: slot.sequence or 0)
        other = slots[1 - slots.index(best)]
        is_trusted = other.condition is not Condition.DAMAGED or (
            # It begins with what the best one followed: nothing was ever finished after that.
            other.sequence is not None and other.sequence < (best.sequence or 0)
        )
        self._sequence = max(numbers)
        self._slot = 1 - slots.index(best)
        self._goes_on = is_trusted
        return Found(best.payload, is_trusted)

    def start_anew(self) -> None:
        """What is there is not gone on with: the next record replaces the whole file."""
        self._goes_on = False
        self.close()

    def write(self, payload: bytes, *, durable: bool = True) -> None:
        """Put down a record.

        Args:
            payload: at most ``MOST_BYTES``.
            durable: on the disk before this returns; else a crash of the program leaves it, a power
                cut perhaps only the last durable one.

        Raises:
            ConfigError: if it cannot be written; what was there before holds.
        """
        try:
            if not self._goes_on:
                self._create(payload)
                return
            if self._fd is None:
                self._fd = open_plain(self.path, os.O_RDWR)
            if self._fd is None:
                self._create(payload)
                return
            self._sequence += 1
            write_all(self._fd, record(payload, self._sequence), self._slot * SLOT)
            if durable:
                sync(self._fd)
                self._slot = 1 - self._slot
        except OSError as error:
            raise ConfigError(
                phrase(
                    "{path}: the state cannot be written: {reason}.",
                    path=self.path,
                    reason=reason(error),
                )
            ) from error

    def _create(self, payload: bytes) -> None:
        make_folder(self.path.parent)
        self.close()
        first = record(payload, self._sequence + 1)
        blank = blank_slot()
        replace(self.path, first + blank[len(first) :] + blank)
        self._sequence += 1
        self._slot, self._goes_on = 1, True

    def close(self) -> None:
        """Give the file back; it may be written again."""
        fd, self._fd = self._fd, None
        if fd is not None:
            with suppress(OSError):
                os.close(fd)
