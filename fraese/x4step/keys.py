"""Keys as X4Step knows them: scan codes, make 1 to 127, break 128 more.

    source --codes--> Keyboard --> every reader that listens: it brakes for the codes it was told

Rule 1: while axes move the keyboard is X4Step's. What was typed then does not reach the program.
Rule 2: what was typed before brakes nothing; it is kept for ``getch``.
"""

import threading
from collections import deque
from collections.abc import Iterable
from typing import Final, Protocol, TextIO

from fraese.x4step.decoder import Key, Stroke
from fraese.x4step.keyboard import char_codes

_US_CODES: Final = char_codes("us")


class KeySource(Protocol):
    """Where keys come from."""

    def begin(self) -> None:
        """Axes will move: take the keyboard away from the program."""

    def codes(self) -> Iterable[int]:
        """Scan codes since the last call, in order; never waits."""

    def end(self) -> None:
        """They stand: give it back, without what was typed meanwhile."""

    def kbhit(self) -> bool:
        """A key waits for ``getch``."""

    def getch(self) -> Key:
        """The next key of those that are the program's; waits for one.

        Raises:
            EOFError: if there will be none.
        """

    def skip(self, code: int) -> bool:
        """Take the next key if it is this one, and waits; never waits for it."""

    def line_ahead(self) -> str:
        """What was typed before the last ``begin`` and not asked for, up to the end of its line."""


class ToldKeys(KeySource, Protocol):
    """A source that tells more: what it is, and what happens to every key."""

    @property
    def said(self) -> str:
        """What keys come from, for a person."""

    def strokes(self) -> list[Stroke]:
        """What happened to keys since the last call; never waits."""


class NoKeys:
    """A source that brakes nothing: the input is no terminal, but a file or a pipe.

    Args:
        stream: what it is.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream

    def begin(self) -> None:
        """Nothing to take."""

    def codes(self) -> Iterable[int]:
        """None."""
        return ()

    def end(self) -> None:
        """Nothing to give back."""

    def kbhit(self) -> bool:
        """Nobody knows."""
        return False

    def getch(self) -> Key:
        """The next character of the input."""
        char = self._stream.read(1) if self._stream else ""
        if not char:
            raise EOFError
        return Key(_US_CODES.get(char, 0), char)

    def skip(self, code: int) -> bool:
        """Nobody knows."""
        return False

    def line_ahead(self) -> str:
        """Nothing was taken away."""
        return ""


class HandKeys:
    """Keys that a program presses: a test, a script.

    Attributes:
        taken: the keyboard is X4Step's just now.
    """

    def __init__(self) -> None:
        self.taken = False
        self._pressed: deque[int] = deque()
        self._typed: deque[Key] = deque()

    def press(self, code: int) -> None:
        """A scan code comes."""
        if self.taken:
            self._pressed.append(code)

    def begin(self) -> None:
        """Axes will move."""
        self.taken = True

    def codes(self) -> Iterable[int]:
        """Scan codes since the last call."""
        codes = list(self._pressed)
        self._pressed.clear()
        return codes

    def end(self) -> None:
        """They stand."""
        self.taken = False
        self._pressed.clear()

    def type(self, *keys: Key) -> None:
        """Keys that wait for the program."""
        self._typed.extend(keys)

    def kbhit(self) -> bool:
        """One waits."""
        return bool(self._typed)

    def getch(self) -> Key:
        """The next of them."""
        if not self._typed:
            raise EOFError
        return self._typed.popleft()

    def skip(self, code: int) -> bool:
        """Take the next of them if it is this one."""
        found = bool(self._typed) and self._typed[0].code == code
        if found:
            self._typed.popleft()
        return found

    def line_ahead(self) -> str:
        """Nothing is taken away."""
        return ""


class KeyReader:
    """What one machine hears; made by a ``Keyboard``."""

    def __init__(self, keyboard: "Keyboard") -> None:
        self._keyboard = keyboard
        self.heard: deque[int] = deque()

    def begin(self) -> None:
        """Axes will move."""
        self.heard.clear()
        self._keyboard.join(self)

    def codes(self) -> list[int]:
        """Scan codes since the last call."""
        self._keyboard.pump()
        # One by one: the owner of another machine may be handing round just now.
        codes = []
        while self.heard:
            codes.append(self.heard.popleft())
        return codes

    def end(self) -> None:
        """They stand."""
        self._keyboard.leave(self)


class Keyboard:
    """One source, heard by all machines of a program.

    Args:
        source: where keys come from.

    Attributes:
        source: as given.
        last_code: the last scan code that was heard, as port 60h of a PC would read; 0: none.
    """

    def __init__(self, source: KeySource) -> None:
        self.source = source
        self.last_code = 0
        self._lock = threading.RLock()
        self._listening: list[KeyReader] = []

    def reader(self) -> KeyReader:
        """For one machine."""
        return KeyReader(self)

    def join(self, reader: KeyReader) -> None:
        """A machine begins to listen; the first one takes the keyboard."""
        with self._lock:
            if not self._listening:
                self.source.begin()
            self._listening.append(reader)

    def leave(self, reader: KeyReader) -> None:
        """It has heard enough; the last one gives the keyboard back."""
        with self._lock:
            if reader in self._listening:
                self._listening.remove(reader)
                if not self._listening:
                    self.source.end()

    def pump(self) -> None:
        """Hand round what was typed."""
        with self._lock:
            for code in self.source.codes() if self._listening else ():
                self.last_code = code
                for reader in self._listening:
                    reader.heard.append(code)

    def kbhit(self) -> bool:
        """A key waits for ``getch``."""
        return self.source.kbhit()

    def getch(self) -> Key:
        """The next key of those that are the program's; waits for one. The axes stand.

        Raises:
            EOFError: if there will be none.
        """
        key = self.source.getch()
        self.last_code = key.code
        return key
