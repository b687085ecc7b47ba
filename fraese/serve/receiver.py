"""Bytes of a sender: lines, and what is acted on at once wherever it stands among them.

Rule 1: a byte of ``AT_ONCE`` never becomes part of a line, also within a remark.
Rule 2: a reset drops the line that was being sent.
Rule 3: a line ends with CR, LF, or both; of one that is too long the beginning is kept, which is
        too long as well.
"""

import re
from collections.abc import Callable
from typing import Final

RESET: Final = 0x18
STATUS: Final = ord("?")
HOLD: Final = ord("!")
GO_ON: Final = ord("~")
DOOR: Final = 0x84
JOG_CANCEL: Final = 0x85

#: Characters of a line; more are refused.
MOST: Final = 256
_APART: Final = re.compile(rb"[\x18?!~\x80-\xff\r\n]")


class Receiver:
    """Takes a stream of bytes apart.

    Args:
        line: told of every line, without its end.
        act: told of every byte that is acted on at once.
    """

    def __init__(self, line: Callable[[str], object], act: Callable[[int], object]) -> None:
        self._line = line
        self._act = act
        self._begun = b""
        self._after_cr = False

    def feed(self, data: bytes) -> None:
        """Some bytes have come."""
        start = 0
        for found in _APART.finditer(data):
            self._take(data[start : found.start()])
            start = found.end()
            byte = data[found.start()]
            if byte in b"\r\n":
                self._end(byte)
                continue
            if byte == RESET:
                self._begun = b""
            self._act(byte)
        self._take(data[start:])

    def _take(self, part: bytes) -> None:
        if part:
            self._after_cr = False
            self._begun = (self._begun + part)[: MOST + 1]

    def _end(self, byte: int) -> None:
        is_second = byte == ord("\n") and self._after_cr
        self._after_cr = byte == ord("\r")
        if not is_second:
            text, self._begun = self._begun, b""
            self._line(text.decode("ascii", "replace"))
