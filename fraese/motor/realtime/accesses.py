"""Accesses to a port on their way from the step process to a waveform.

    child: TracedPort --> AccessRing (shared memory) --> thread of the host --> Waveform --> file

    ring    words:  written | taken | missing | (at_ns, register << 8 | value) ...

Rule 1: the child never waits: what finds no room is counted as missing.
Rule 2: the ring outlives the child. Whoever follows it, another child or the host that switches the
        motors off for it, writes into the same ring; never two at a time.
Rule 3: the thread has taken everything, and the file is whole, when ``close`` returns.
"""

import mmap
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Final

from fraese.motor.ports.traced import TracedPort
from fraese.motor.realtime.setup import Setup
from fraese.motor.seams import Port
from fraese.motor.waveform import Waveform

_WRITTEN: Final = 0
_TAKEN: Final = 1
_MISSING: Final = 2
_HEAD_WORDS: Final = 4
#: Room for three seconds of four axes at 20 kHz: two writes a step.
_ACCESSES: Final = 1 << 17
_MASK: Final = _ACCESSES - 1
_BYTES: Final = 8 * (_HEAD_WORDS + 2 * _ACCESSES)
#: At once; in between other threads of the host have their turn.
_CHUNK: Final = 512
_LOOK_S: Final = 0.02


class AccessRing:
    """Accesses in shared memory.

    Args:
        fd: of memory that ``create`` has made.
    """

    def __init__(self, fd: int) -> None:
        # Populated: a page that is not there yet would cost the step process its time.
        flags = mmap.MAP_SHARED | mmap.MAP_POPULATE
        self._map = mmap.mmap(fd, _BYTES, flags)
        self._words = memoryview(self._map).cast("Q")
        self._written = self._words[_WRITTEN]
        self._missing = 0

    @staticmethod
    def create() -> int:
        """A file descriptor of an empty ring, that a child may inherit."""
        fd = os.memfd_create("fraese-trace")
        os.ftruncate(fd, _BYTES)
        return fd

    def put(self, at_ns: int, register: int, value: int) -> None:
        """Note an access, or that it is missing."""
        words, written = self._words, self._written
        if written - words[_TAKEN] >= _ACCESSES:
            words[_MISSING] += 1
            return
        at = _HEAD_WORDS + 2 * (written & _MASK)
        words[at] = at_ns
        words[at + 1] = register << 8 | value
        self._written = words[_WRITTEN] = written + 1

    def take(self) -> Iterator[tuple[int, int, int]]:
        """What lies there, as time, register and value; at most a chunk."""
        words = self._words
        taken = words[_TAKEN]
        count = min(words[_WRITTEN] - taken, _CHUNK, _ACCESSES - (taken & _MASK))
        first = _HEAD_WORDS + 2 * (taken & _MASK)
        lying = words[first : first + 2 * count].tolist()
        words[_TAKEN] = taken + count
        for at_ns, access in zip(lying[::2], lying[1::2], strict=True):
            yield at_ns, access >> 8, access & 0xFF

    def newly_missing(self) -> int:
        """How many more are missing than when this was asked last."""
        missing = self._words[_MISSING]
        newly, self._missing = missing - self._missing, missing
        return newly

    def close(self) -> None:
        """Give the memory back."""
        self._words.release()
        self._map.close()


def open_traced(open_port: Callable[[], Port], fd: int) -> Port:
    """Open a port, with every access to it noted in a ring."""
    port = open_port()
    return TracedPort(port, time.monotonic_ns, AccessRing(fd).put)


class ChildTrace:
    """A waveform of what the step process writes.

    Args:
        waveform: its file.
    """

    def __init__(self, waveform: Waveform) -> None:
        self.waveform = waveform
        self._fd = AccessRing.create()
        self._ring = AccessRing(self._fd)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._follow, name="waveform", daemon=True)
        self._thread.start()

    def on(self, setup: Setup) -> Setup:
        """That set-up, with everything noted."""
        open_port = partial(open_traced, setup.open_port, self._fd)
        return replace(setup, open_port=open_port, inherited=(*setup.inherited, self._fd))

    def close(self) -> None:
        """The child is gone: take what it has left. Safe to call twice."""
        if self._over.is_set():
            return
        self._over.set()
        self._thread.join()
        self.waveform.close(time.monotonic_ns())
        self._ring.close()
        os.close(self._fd)

    def _follow(self) -> None:
        """In a thread of its own."""
        while not self._over.wait(_LOOK_S):
            self._drain()
        self._drain()

    def _drain(self) -> None:
        ring, note = self._ring, self.waveform.note
        while True:
            chunk = list(ring.take())
            for at_ns, register, value in chunk:
                note(at_ns, register, value)
            if not chunk:
                break
        newly = ring.newly_missing()
        if newly:
            self.waveform.skip(newly)
