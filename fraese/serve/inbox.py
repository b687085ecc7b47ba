"""Lines that wait: put in by who reads what comes, taken out by the machine's thread."""

import threading
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

#: grbl's own buffer: what a sender that counts characters counts with.
GRBL_BYTES: Final = 128
#: So much waits here before the line is read no further.
MOST_BYTES: Final = 1 << 16


@dataclass(frozen=True, slots=True)
class Sent:
    """A line.

    Attributes:
        text: without its end.
        is_own: it was not sent, but is done at every start ($N).
    """

    text: str
    is_own: bool = False


class Inbox:
    """First in, first out.

    Args:
        waits: whether who asks for a line may wait for it; a test with a clock of its own does not.
    """

    def __init__(self, *, waits: bool = True) -> None:
        self._waits = waits
        self._news = threading.Condition()
        self._lines: deque[Sent] = deque()
        self._bytes = 0

    def put(self, line: Sent) -> None:
        """One more."""
        with self._news:
            self._lines.append(line)
            self._bytes += len(line.text) + 1
            self._news.notify_all()

    def put_first(self, lines: Iterable[Sent]) -> None:
        """These before all others."""
        with self._news:
            for line in reversed(tuple(lines)):
                self._lines.appendleft(line)
                self._bytes += len(line.text) + 1
            self._news.notify_all()

    def head(self, patience_s: float = 0.0) -> Sent | None:
        """The next one, which stays; None: none came in that time."""
        with self._news:
            if not self._lines and self._waits and patience_s:
                self._news.wait(patience_s)
            return self._lines[0] if self._lines else None

    def take(self, line: Sent) -> bool:
        """Take out the next one, which was looked at; False: somebody else has, meanwhile."""
        with self._news:
            if not self._lines or self._lines[0] is not line:
                return False
            self._lines.popleft()
            self._bytes -= len(line.text) + 1
            return True

    def clear(self) -> None:
        """Drop everything."""
        with self._news:
            self._lines.clear()
            self._bytes = 0

    @property
    def waiting_bytes(self) -> int:
        """With their ends."""
        return self._bytes

    @property
    def is_full(self) -> bool:
        """No more should be read for now."""
        return self._bytes > MOST_BYTES
