"""The terminal of the app, whatever it sends and whether or not anybody reads it.

Textual's driver for Unix with another way out (``ScreenWriter``) and another way in.

Rule 1: no byte that arrives ends the app: what is no UTF-8 is a replacement character, what the
        parser of keys does not understand is left out, and a paste without an end gets one.
Rule 2: a terminal that is gone is told of once, at once.
        Text that comes faster than fingers type is a paste, whether the terminal says so or not.
Rule 3: what is typed faster than the app can follow is left out, but for the keys that stop and
        quit: no backlog moves a machine later. What is pasted has an end.
Rule 4: a key that is let go is told where the terminal knows kitty's protocol (``KeyEvents``); what
        is held is let go at once, in this thread.
Rule 5: a lone ESC is the Escape key when nothing follows for 20 ms. What follows later, and would
        have been the rest of a longer key, is left out.
Rule 6: what was typed before anything was drawn is left out, for the same reason, but for the key
        that quits.
"""

import codecs
import contextlib
import os
import re
import select
import sys
import termios
import time
from collections.abc import Callable, Collection, Iterator
from typing import Any, Final

from textual import constants
from textual._xterm_parser import XTermParser
from textual.drivers.linux_driver import LinuxDriver
from textual.events import AppBlur, Key, MouseEvent, Paste, Resize
from textual.message import Message

from fraese.earlyterminal import EARLY
from fraese.ui.keyevents import WANTED, KeyEvents, Up
from fraese.ui.keyrows.everywhere import (
    ESCAPE,
    ESCAPE_KEY,
    QUIT_KEYS,
    STOP_BYTE,
    STOP_BYTE_KEY,
    STOP_KEYS,
)
from fraese.ui.messages import KeyUp
from fraese.ui.pastes import with_pastes
from fraese.ui.screenwriter import ScreenWriter

#: What is heard however much waits.
_ALWAYS_HEARD: Final = STOP_KEYS | QUIT_KEYS
_LOOK_EVERY_S: Final = 0.1
#: What belongs to a sequence follows its ESC within this time.
_ESCAPE_S: Final = 0.02
#: What comes so soon behind an ESC that was taken for a key comes from no finger.
_TORN_S: Final = 0.15
_REST: Final = re.compile(r"\[[<?]?[\d;:]*[@-~]?|O[A-Za-z]?")
_READ_BYTES: Final = 4096
#: A terminal keeps no more for who does not read.
_MOST_EARLY: Final = 1 << 16
#: So many events wait for the app, and no more; a hand types some twenty a second.
_BACKLOG: Final = 200
#: A path has 4,096 at most.
_PASTE_CHARACTERS: Final = 5_000
#: More is no text that somebody chose.
_LONGEST_PASTE: Final = 1_000_000
#: Within a paste nothing comes for so long: its end was lost.
_PASTE_SILENCE_S: Final = 0.5
#: A screen is not larger; a torn report of its size may say so.
_MOST_CELLS: Final = 2_000


class Terminal(LinuxDriver):
    """What Textual reads from and draws on.

    The app has methods for it, which are called from its threads: ``terminal_is_gone``,
    ``draw_all``, ``tells_releases``, ``lets_go``, ``hears`` and ``backlog``.
    """

    _screen: ScreenWriter | None = None
    _typed_early = b""

    # --- out -------------------------------------------------------------------------------------

    def start_application_mode(self) -> None:
        """Take the terminal."""
        app: Any = self._app
        fd = _drawn_on()
        self._screen = ScreenWriter(fd, app.draw_all, lambda: termios.tcflush(fd, termios.TCOFLUSH))
        as_before = EARLY.before
        if as_before is not None:
            self._typed_early = self._waiting()
        super().start_application_mode()  # type: ignore[no-untyped-call]
        if as_before is not None:
            self.attrs_before = as_before
            EARLY.is_the_drivers()
        if not constants.DISABLE_KITTY_KEY:
            self.write(WANTED)

    def write(self, data: str) -> None:
        """Draw this; never waits."""
        if self._screen is not None:
            self._screen.write(data)

    def stop_application_mode(self) -> None:
        r"""Give the terminal back: at first its picture, at last its keys.

        The other way round, a Ctrl+\ that comes meanwhile would end us in between. What was typed
        for the app is not for the shell.
        """
        as_before, self.attrs_before = self.attrs_before, None
        if self._screen is not None:
            self._screen.begin_last_words()
        super().stop_application_mode()
        if self._screen is not None:
            self._screen.close()
        with contextlib.suppress(termios.error):
            if as_before is not None:
                termios.tcflush(self.fileno, termios.TCIFLUSH)
                termios.tcsetattr(self.fileno, termios.TCSANOW, as_before)

    # --- in --------------------------------------------------------------------------------------

    def run_input_thread(self) -> None:
        """Hear what the terminal sends, until it is given back or gone."""
        keys = _Keys(self._debug)
        early, self._typed_early = self._typed_early, b""
        for message in keys.heard(early):
            if _is_one_of(message, QUIT_KEYS):
                self.process_message(message)
        while not self.exit_event.is_set():
            data = b""
            try:
                if select.select([self.fileno], [], [], keys.patience_s)[0]:
                    data = os.read(self.fileno, _READ_BYTES)
                    if not data:
                        return self._gone()
            except OSError:
                return self._gone()
            for message in keys.heard(data):
                self.process_message(message)
            self._app.tells_releases(keys.tells)  # type: ignore[attr-defined]
        return None

    def _waiting(self) -> bytes:
        """What has arrived by now."""
        data = b""
        with contextlib.suppress(OSError):
            while len(data) < _MOST_EARLY and select.select([self.fileno], [], [], 0)[0]:
                read = os.read(self.fileno, _READ_BYTES)
                if not read:
                    break
                data += read
        return data

    def process_message(self, message: Message) -> None:
        """Pass on what was heard."""
        if isinstance(message, Paste):
            message.text = message.text[:_PASTE_CHARACTERS]
        if isinstance(message, KeyUp | AppBlur):
            letting_go: Any = self._app
            letting_go.lets_go(getattr(message, "key", ""))
        if isinstance(message, Resize) and max(message.size) > _MOST_CELLS:
            return
        if isinstance(message, Key | MouseEvent | Paste) and not _is_one_of(message, _ALWAYS_HEARD):
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
        now: tells the time, s.
    """

    def __init__(self, debug: bool = False, now: Callable[[], float] = time.monotonic) -> None:
        self._debug = debug
        self._now = now
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._events = KeyEvents()
        self._parser = XTermParser(debug)
        self._swallowed = 0
        self._silent_s = 0.0
        self._escaped_s = -_TORN_S

    @property
    def tells(self) -> bool:
        """The terminal tells when a key comes up."""
        return self._events.tells

    @property
    def patience_s(self) -> float:
        """When ``heard`` is to be called, if nothing comes."""
        return _ESCAPE_S if self._events.waits else _LOOK_EVERY_S

    def heard(self, data: bytes) -> Iterator[Message]:
        """What these bytes mean; none: nothing came for ``patience_s``."""
        waited_s = self.patience_s
        text = self._decoder.decode(data)
        if text and self._now() < self._escaped_s + _TORN_S:
            text = _REST.sub("", text, count=1) if _REST.match(text) else text
        messages: list[Message] = []
        try:
            for part in self._events.parts(text):
                messages.extend(self._meant(part, waited=not text))
            messages.extend(self._parser.tick())
        except Exception:
            # It has lost its place: it begins anew with what comes next.
            self._begin_anew()
        told = bool(messages)
        braked = any(_is_one_of(message, (STOP_BYTE_KEY,)) for message in messages)
        yield from with_pastes(messages)
        if STOP_BYTE in text and not braked:
            # It stands in the middle of something else.
            yield Key(STOP_BYTE_KEY, STOP_BYTE)
        self._watch(text, told, waited_s)

    def _meant(self, part: str | Up, *, waited: bool) -> Iterator[Message]:
        if isinstance(part, Up):
            for message in self._parser.feed(part.sequence):
                yield KeyUp(message.key) if isinstance(message, Key) else message
        elif waited and not part.strip(ESCAPE):
            self._escaped_s = self._now()
            yield from (Key(ESCAPE_KEY, ESCAPE) for _ in part)
        else:
            yield from self._parser.feed(part)

    def _watch(self, text: str, told: bool, waited_s: float) -> None:
        """A paste whose end was lost swallows every key that follows: it is given up.

        Whatever swallows and says nothing is given up so, when the terminal has been silent. What
        the parser tells in the silence, because its own patience is over, may be half of it.
        """
        if told and text:
            self._swallowed = 0
        self._swallowed += len(text)
        self._silent_s = 0.0 if text else self._silent_s + waited_s
        over = self._swallowed and self._silent_s > _PASTE_SILENCE_S
        if over or self._swallowed > _LONGEST_PASTE:
            self._begin_anew()

    def _begin_anew(self) -> None:
        before, self._parser = self._parser, XTermParser(self._debug)
        # What the terminal has told of itself stays.
        self._parser.mouse_pixels = before.mouse_pixels
        self._parser.terminal_size = before.terminal_size
        self._parser.terminal_pixel_size = before.terminal_pixel_size
        self._swallowed = 0


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
