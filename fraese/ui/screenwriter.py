"""What is drawn goes to the terminal by a thread that nobody waits for.

    app: write --> [ waits ] --thread--> terminal
                       '-- too much waits: what is drawn is dropped; read again: all drawn anew

Rule 1: ``write`` never waits: a terminal that nobody reads stops the picture and nothing else.
Rule 2: what is dropped is dropped in whole writes, so that no sequence of the terminal is torn.
Rule 3: at the end the terminal is asked to be as it was before, if it can be reached at all.
"""

import contextlib
import os
import select
import threading
from collections import deque
from collections.abc import Callable
from typing import Final

#: Some ten full pictures.
_ROOM_CHARACTERS: Final = 300_000
#: What is once given to the system cannot be taken back: so little at a time.
_PIECE_BYTES: Final = 2048
_DRAIN_S: Final = 0.3
#: Ends a sequence that was torn when what lay in the terminal was thrown away.
_BREAK: Final = "\x18\x1b\\"


class ScreenWriter:
    """Writes to a terminal.

    Args:
        fd: its file descriptor.
        caught_up: called in the thread when something was dropped and all the rest is written.
        throw_away: drops what the system holds and the terminal has not read.
    """

    def __init__(
        self, fd: int, caught_up: Callable[[], object], throw_away: Callable[[], object]
    ) -> None:
        self._fd = fd
        self._caught_up = caught_up
        self._throw_away = throw_away
        self._news = threading.Condition()
        self._waiting: deque[str] = deque()
        self._characters = 0
        self._dropped = False
        self._writing = False
        self._broken = False
        self._last_words: list[str] | None = None
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="screen", daemon=True)
        self._thread.start()

    def write(self, text: str) -> None:
        """Draw this when the terminal takes it, or never; does not wait."""
        with self._news:
            if self._broken or self._ended:
                return
            if self._last_words is not None:
                self._last_words.append(text)
            elif self._dropped or self._characters > _ROOM_CHARACTERS:
                self._dropped = True
                return
            self._put(text)

    def begin_last_words(self) -> None:
        """From now on nothing is dropped: the terminal is being given back."""
        with self._news:
            self._last_words = []

    def close(self) -> None:
        """Write what waits, if it can be written soon; else only the last words, or nothing."""
        if not self._is_written(_DRAIN_S):
            with self._news:
                self._waiting.clear()
                self._characters = 0
                last = "".join(self._last_words or ())
                self._put(_BREAK + last)
            with contextlib.suppress(OSError):
                self._throw_away()
            self._is_written(_DRAIN_S)
        with self._news:
            self._ended = True
            self._waiting.clear()
            self._news.notify_all()

    def _put(self, text: str) -> None:
        self._waiting.append(text)
        self._characters += len(text)
        self._news.notify_all()

    def _is_written(self, timeout_s: float) -> bool:
        with self._news:
            return self._news.wait_for(
                lambda: self._broken or not (self._waiting or self._writing), timeout_s
            )

    def _run(self) -> None:
        while True:
            with self._news:
                self._writing = False
                caught_up = self._dropped and not self._waiting
                if caught_up:
                    self._dropped = False
                elif not self._waiting:
                    self._news.notify_all()
                    self._news.wait_for(lambda: self._waiting or self._ended)
                if self._ended:
                    return
                text = self._waiting.popleft() if self._waiting else ""
                self._characters -= len(text)
                self._writing = bool(text)
            if caught_up:
                self._caught_up()
            if text and not self._written(text):
                return

    def _written(self, text: str) -> bool:
        data = text.encode("utf-8", "backslashreplace")
        try:
            while data:
                try:
                    data = data[os.write(self._fd, data[:_PIECE_BYTES]) :]
                except BlockingIOError:
                    # Somebody else who has this terminal open does not wait in it.
                    select.select([], [self._fd], [])
        except OSError:
            with self._news:
                self._broken = True
                self._waiting.clear()
                self._writing = False
                self._news.notify_all()
            return False
        return True
