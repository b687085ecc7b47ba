"""The terminal of the app, whatever it sends and whether or not anybody reads it.

Textual's driver for Unix with another way out (``ScreenWriter``) and another way in.

Rule 1: no byte that arrives ends the app: what is no UTF-8 is a replacement character, what the
        parser of keys does not understand is left out, and a paste without an end gets one.
Rule 2: a terminal that is gone is told of once, at once.
Rule 3: what is typed faster than the app can follow is left out, but for the stop keys: no backlog
        moves a machine later. What is pasted has an end.
"""

import codecs
import contextlib
import os
import select
import sys
import termios
from collections.abc import Collection, Iterator
from typing import Any, Final

from textual._xterm_parser import XTermParser
from textual.drivers.linux_driver import LinuxDriver
from textual.events import Key, MouseEvent, Paste, Resize
from textual.message import Message

from fraese.ui.keys import STOP_KEYS
from fraese.ui.screenwriter import ScreenWriter

_LOOK_EVERY_S: Final = 0.1
_READ_BYTES: Final = 4096
#: So many events wait for the app, and no more; a hand types some twenty a second.
_BACKLOG: Final = 200
#: A path has 4,096 at most.
_PASTE_CHARACTERS: Final = 5_000
#: More is no text that somebody chose.
_LONGEST_PASTE: Final = 1_000_000
#: Within a paste nothing comes for so long: its end was lost.
_PASTE_SILENCE_S: Final = 0.5
_PASTE_BEGINS: Final = "\x1b[200~"
_PASTE_ENDS: Final = "\x1b[201~"
#: A screen is not larger; a torn report of its size may say so.
_MOST_CELLS: Final = 2_000


class Terminal(LinuxDriver):
    """What Textual reads from and draws on.

    The app has two methods for it, which are called from its threads: ``terminal_is_gone`` and
    ``draw_all``.
    """

    _screen: ScreenWriter | None = None

    # --- out -------------------------------------------------------------------------------------

    def start_application_mode(self) -> None:
        """Take the terminal."""
        app: Any = self._app
        fd = _drawn_on()
        self._screen = ScreenWriter(fd, app.draw_all, lambda: termios.tcflush(fd, termios.TCOFLUSH))
        super().start_application_mode()  # type: ignore[no-untyped-call]

    def write(self, data: str) -> None:
        """Draw this; never waits."""
        if self._screen is not None:
            self._screen.write(data)

    def stop_application_mode(self) -> None:
        """Give the terminal back."""
        if self._screen is not None:
            self._screen.begin_last_words()
        super().stop_application_mode()

    def close(self) -> None:
        """Nothing is drawn any more."""
        if self._screen is not None:
            self._screen.close()
        super().close()

    # --- in --------------------------------------------------------------------------------------

    def run_input_thread(self) -> None:
        """Hear what the terminal sends, until it is given back or gone."""
        keys = _Keys(self._debug)
        while not self.exit_event.is_set():
            data = b""
            try:
                if select.select([self.fileno], [], [], _LOOK_EVERY_S)[0]:
                    data = os.read(self.fileno, _READ_BYTES)
                    if not data:
                        return self._gone()
            except OSError:
                return self._gone()
            for message in keys.heard(data):
                self.process_message(message)
        return None

    def process_message(self, message: Message) -> None:
        """Pass on what was heard."""
        if isinstance(message, Paste):
            message.text = message.text[:_PASTE_CHARACTERS]
        if isinstance(message, Resize) and max(message.size) > _MOST_CELLS:
            return
        if isinstance(message, Key | MouseEvent | Paste) and not _is_one_of(message, STOP_KEYS):
            app: Any = self._app
            if app.backlog() > _BACKLOG:
                return
            app.hears()
        super().process_message(message)

    def _gone(self) -> None:
        app: Any = self._app
        app.terminal_is_gone()


class _Keys:
    """Bytes to messages, whatever the bytes are.

    Args:
        debug: as Textual's.
    """

    def __init__(self, debug: bool = False) -> None:
        self._debug = debug
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._parser = XTermParser(debug)
        self._tail = ""
        self._pasted = 0
        self._pasting = False
        self._silent_s = 0.0

    def heard(self, data: bytes) -> Iterator[Message]:
        """What these bytes mean; none: nothing came for a moment."""
        text = self._decoder.decode(data)
        try:
            if text:
                yield from self._parser.feed(text)
            yield from self._parser.tick()
        except Exception:
            # It has lost its place: it begins anew with what comes next.
            self._begin_anew()
        yield from self._watch_paste(text)

    def _watch_paste(self, text: str) -> Iterator[Message]:
        """A paste whose end was lost would swallow every key that follows, the stop key too."""
        seen = self._tail + text
        begun, ended = seen.rfind(_PASTE_BEGINS), seen.rfind(_PASTE_ENDS)
        was_pasting = self._pasting
        if begun != ended:
            self._pasting = begun > ended
        self._tail = seen[-len(_PASTE_ENDS) :] if not text or max(begun, ended) < 0 else ""
        if not self._pasting:
            self._pasted, self._silent_s = 0, 0.0
            return
        if was_pasting and "\x03" in text:
            yield Key("ctrl+c", "\x03")
        self._pasted += len(text)
        self._silent_s = 0.0 if text else self._silent_s + _LOOK_EVERY_S
        if self._pasted > _LONGEST_PASTE or self._silent_s > _PASTE_SILENCE_S:
            self._begin_anew()

    def _begin_anew(self) -> None:
        self._parser = XTermParser(self._debug)
        self._tail, self._pasted, self._pasting = "", 0, False


def _is_one_of(message: Message, keys: Collection[str]) -> bool:
    return isinstance(message, Key) and message.key in keys


def _drawn_on() -> int:
    """The terminal, also where standard error is something else."""
    stream = sys.__stdout__
    if stream is not None:
        with contextlib.suppress(OSError, ValueError):
            if os.isatty(stream.fileno()):
                return stream.fileno()
    return sys.__stderr__.fileno() if sys.__stderr__ is not None else 2
