"""The memory that parent and child share, and who may write what in it.

    0        words     64 numbers of 8 bytes
    512      text      what the child says in words: an answer, a failure, facts about its start
    2048     report    one record under a sequence lock
    4096     ring      blocks on their way
    + RING   samples   32-bit numbers, only when the child measures itself

Rule 1: every word has one writer. A number of 8 bytes, aligned, is written and read in one piece.
Rule 2: whoever fills something first writes what is in it, then the word that says so. Readers see
        both in that order: the machines that have such a port (x86) keep the order of writes.
Rule 3: nobody waits for a lock, since the other side may be dead.
"""

import mmap
import os
from typing import Final

WORDS: Final = 64
TEXT_AT: Final = 512
TEXT_BYTES: Final = 1536
REPORT_AT: Final = 2048
REPORT_BYTES: Final = 2048
RING_AT: Final = 4096
RING_BYTES: Final = 1 << 20
SAMPLE_BYTES: Final = 4

# --- words that the parent writes ----------------------------------------------------------------

#: Changes whenever one of the three after it has changed: the only one that is read every tick.
WISHES: Final = 0
#: Changes with every ``brake``,
BRAKES: Final = 1
#: with every ``stop``.
STOPS: Final = 2
#: The feed override, 256 for 100 %.
OVERRIDE: Final = 3
#: Number of the last ``poll``: the child answers it in a report that knows all that came before.
ASKED: Final = 4
#: When the parent last called the driver, monotonic ns.
HEARTBEAT: Final = 5
#: Bytes put into the ring since it was made.
RING_HEAD: Final = 6
#: Number of the last command in the mailbox, its kind and its arguments.
COMMAND: Final = 7
COMMAND_KIND: Final = 8
COMMAND_A: Final = 9
COMMAND_B: Final = 10
#: Until then motors may play, monotonic ns, and brake if it is not put off; 0: for ever.
LEASE: Final = 11

# --- words that the child writes -----------------------------------------------------------------

#: Where its life stands: one of the numbers below.
STAGE: Final = 32
#: Bytes taken out of the ring.
RING_TAIL: Final = 33
#: Number of the last command that was answered, and its result.
ANSWER: Final = 34
RESULT: Final = 35
#: Odd while the report is being written.
REPORT_SEQUENCE: Final = 36
#: It sleeps until somebody rings.
DOZING: Final = 37
#: Samples written, of those that fit and those that did not.
SAMPLES: Final = 38
#: Length of the text.
TEXT_LENGTH: Final = 39
#: When the first and the last edge were written, monotonic ns, where they are measured.
FIRST_EDGE: Final = 40
LAST_EDGE: Final = 41

#: The block in hand and its ticks done, as of the last wait (``place.py``).
PLACE: Final = 42

STARTING: Final = 0
READY: Final = 1
#: It gave up; the text says why, and the motors are off.
FAILED: Final = 2
#: It gave up, and could not switch the motors off.
FAILED_LIVE: Final = 3
#: It was asked to end, and the motors are off.
ENDED: Final = 4


class Memory:
    """The shared memory, seen from either side.

    Args:
        fd: a file of at least ``size(samples)`` bytes; it stays the caller's.
        samples: room for so many measurements.

    Attributes:
        words: the numbers, by the names above.
        report: bytes of the report.
        ring: bytes of the ring.
        samples: the measurements.
    """

    def __init__(self, fd: int, samples: int = 0) -> None:
        self._map = mmap.mmap(fd, size(samples))
        whole = memoryview(self._map)
        self.words = whole[: WORDS * 8].cast("Q")
        self._text = whole[TEXT_AT : TEXT_AT + TEXT_BYTES]
        self.report = whole[REPORT_AT : REPORT_AT + REPORT_BYTES]
        self.ring = whole[RING_AT : RING_AT + RING_BYTES]
        self.samples = whole[RING_AT + RING_BYTES :].cast("I")
        self._views = (whole, self.words, self._text, self.report, self.ring, self.samples)

    def say(self, text: str) -> None:
        """Put a text into the memory, cut to what fits."""
        data = text.encode("utf-8")[:TEXT_BYTES]
        self._text[: len(data)] = data
        self.words[TEXT_LENGTH] = len(data)

    def text(self) -> str:
        """The text in the memory."""
        return bytes(self._text[: self.words[TEXT_LENGTH]]).decode("utf-8", "replace")

    def measured(self) -> bytes:
        """The measurements so far, as they lie there."""
        return bytes(self.samples[: min(self.words[SAMPLES], len(self.samples))])

    def close(self) -> None:
        """Give the memory back; the other side keeps its own view. Safe to call twice."""
        for view in self._views:
            view.release()
        self._map.close()


def size(samples: int = 0) -> int:
    """Bytes of the whole memory."""
    return RING_AT + RING_BYTES + samples * SAMPLE_BYTES


def create(samples: int = 0) -> int:
    """A file descriptor of fresh memory that has no name and goes with its last owner."""
    fd = os.memfd_create("fraese", os.MFD_CLOEXEC)
    os.ftruncate(fd, size(samples))
    return fd
