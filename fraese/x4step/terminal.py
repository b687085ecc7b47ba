"""Keys from a plain terminal.

    standing   the terminal is the program's: echo, lines, as it was
    begin      no echo, byte by byte; what was typed before is kept (``ahead``)
    moving     every byte is a key; none reaches the program
    end        what is left is thrown away, the terminal is as it was

Rule 1: a program in the background leaves the terminal alone.
Rule 2: Ctrl-C stays what it is.
Rule 3: what was typed before the start brakes nothing. It is handed back by ``getch`` and ``gets``;
        it is lost for ``input``.
"""

import os
import select
import termios
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final, TextIO

from fraese.x4step.decoder import Decoder, Holding, Key

_LOCAL: Final = 3
_CONTROL_CHARACTERS: Final = 6
_CHUNK: Final = 4096
#: Between two looks for a key, s.
_LOOK_S: Final = 0.01


class TerminalKeys:
    """A source of keys: a terminal.

    Args:
        descriptor: of the terminal.
        layout: "us" or "de".
        now_ns: the time.

    Attributes:
        ahead: keys that were typed and not asked for yet.
    """

    def __init__(
        self, descriptor: int, layout: str, now_ns: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self._descriptor = descriptor
        self._now_ns = now_ns
        self._decoder = Decoder(layout)
        self._holding = Holding()
        self._before: list[Any] | None = None
        self._is_gone = False
        self.ahead: deque[Key] = deque()

    def begin(self) -> None:
        """Axes will move: take the keyboard away from the program."""
        self._holding.elapsed(self._now_ns())
        if self._take():
            self.ahead.extend(self._keys())
            self.ahead.extend(self._decoder.rest())

    def codes(self) -> list[int]:
        """Scan codes since the last call, in order; never waits."""
        codes: list[int] = []
        if self._before is not None:
            for key in self._keys():
                if key.code:
                    codes += self._holding.press(key.code, self._now_ns())
            codes += self._holding.elapsed(self._now_ns())
        return codes

    def end(self) -> None:
        """They stand: give it back, without what was typed meanwhile."""
        if self._before is not None:
            termios.tcflush(self._descriptor, termios.TCIFLUSH)
            self._decoder = self._decoder.anew()
        self._give_back()

    def close(self) -> None:
        """As it was before the first ``begin``."""
        self._give_back()

    def kbhit(self) -> bool:
        """A key waits."""
        if not self.ahead and self._take():
            try:
                self.ahead.extend(self._keys())
            finally:
                self._give_back()
        return bool(self.ahead)

    def getch(self) -> Key:
        """The next key; waits for one.

        Raises:
            EOFError: if the terminal is gone.
        """
        if not self.ahead and self._take():
            try:
                while not self.ahead and not self._is_gone:
                    select.select([self._descriptor], [], [], _LOOK_S)
                    self.ahead.extend(self._keys())
            finally:
                self._give_back()
        if not self.ahead:
            raise EOFError
        key = self.ahead.popleft()
        self._holding.press(key.code, self._now_ns())
        return key

    def skip(self, code: int) -> bool:
        """Take the next key if it is this one, and waits; never waits for it."""
        found = self.kbhit() and self.ahead[0].code == code
        if found:
            self.ahead.popleft()
        return found

    def line_ahead(self) -> str:
        """What was typed ahead, up to the end of its line."""
        line = ""
        while self.ahead and not line.endswith("\n"):
            text = self.ahead.popleft().text
            line += "" if text.startswith("\0") else text.replace("\r", "\n")
        return line

    def _take(self) -> bool:
        """Byte by byte, without echo; False: the terminal is not ours."""
        if self._before is None and self._is_ours():
            self._before = termios.tcgetattr(self._descriptor)
            mine = termios.tcgetattr(self._descriptor)
            mine[_LOCAL] &= ~(termios.ICANON | termios.ECHO)
            mine[_CONTROL_CHARACTERS][termios.VMIN] = 0
            mine[_CONTROL_CHARACTERS][termios.VTIME] = 0
            termios.tcsetattr(self._descriptor, termios.TCSANOW, mine)
        return self._before is not None

    def _give_back(self) -> None:
        before, self._before = self._before, None
        if before is not None and self._is_ours():
            termios.tcsetattr(self._descriptor, termios.TCSANOW, before)

    def _is_ours(self) -> bool:
        try:
            return os.tcgetpgrp(self._descriptor) == os.getpgrp()
        except OSError:
            return False

    def _keys(self) -> list[Key]:
        data = b""
        try:
            while select.select([self._descriptor], [], [], 0)[0]:
                chunk = os.read(self._descriptor, _CHUNK)
                data += chunk
                if not chunk:
                    self._is_gone = True
                    break
        except OSError:
            self._is_gone = True
        return self._decoder.take(data, self._now_ns())


def keys_of(stream: TextIO, layout: str) -> TerminalKeys | None:
    """The terminal that a stream reads from; None: it is none."""
    try:
        return TerminalKeys(stream.fileno(), layout) if stream.isatty() else None
    except (OSError, ValueError):
        return None
