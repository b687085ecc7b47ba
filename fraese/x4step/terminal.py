r"""Keys from a terminal: from one that knows kitty's protocol with their releases, else plain.

    standing   the terminal is the program's: echo, lines, as it was
    begin      no echo, byte by byte; what was typed before is kept (``ahead``)
    moving     every byte is a key; none reaches the program
    end        what is left is thrown away, the terminal is as it was

Rule 1: a program in the background leaves the terminal alone; so does one whose terminal is gone.
Rule 2: Ctrl-C stays what it is. So does Ctrl-Z, but it is read like a key, for the terminal is
        given back first. Ctrl-\ ends the program as other signals do (``lifeline``).
Rule 3: what was typed before the start brakes nothing. It is handed back by ``getch`` and ``gets``;
        it is lost for ``input``.
Rule 4: as long as the terminal is not as it was, it is on the list of what must not stay so
        (``lifeline``).
"""

import contextlib
import os
import select
import signal
import termios
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final, TextIO

from fraese.phrases import phrase
from fraese.x4step import lifeline
from fraese.x4step.decoder import Decoder, Held, Key, Stroke
from fraese.x4step.keys import NoKeys
from fraese.x4step.kitty import FOCUS_LOST, Kitty, Wanted

_LOCAL: Final = 3
_CONTROL_CHARACTERS: Final = 6
_CHUNK: Final = 4096
#: Between two looks for a key, s.
_LOOK_S: Final = 0.01
#: Until a signal that stops a program has stopped all its threads, s.
_STOPPING_S: Final = 0.05
#: Control characters that are signals.
_SIGNALS: Final = {
    termios.VINTR: signal.SIGINT,
    termios.VQUIT: signal.SIGQUIT,
    termios.VSUSP: signal.SIGTSTP,
}


class TerminalKeys:
    """A source of keys: a terminal.

    Args:
        descriptor: of the terminal.
        layout: "us" or "de".
        now_ns: the time.
        wanted: whether it is asked for kitty's protocol.

    Attributes:
        ahead: keys that were typed and not asked for yet.
        held: keys that are down.
    """

    def __init__(
        self,
        descriptor: int,
        layout: str,
        now_ns: Callable[[], int] = time.monotonic_ns,
        wanted: Wanted = "plain",
    ) -> None:
        self._descriptor = descriptor
        self._now_ns = now_ns
        self._decoder = Decoder(layout)
        self._kitty = Kitty(self._write, wanted, now_ns)
        self._before: list[Any] | None = None
        self._is_gone = False
        self.ahead: deque[Key] = deque()
        self.held = Held()

    @property
    def said(self) -> str:
        """What keys come from, for a person."""
        if self._kitty.is_known:
            return phrase("the terminal, which tells releases (kitty keyboard protocol)")
        return phrase("the terminal, which does not tell releases")

    def begin(self) -> None:
        """Axes will move: take the keyboard away from the program."""
        self.held.guess.elapsed(self._now_ns())
        if self._take():
            self._keep(self._read())
            self.ahead.extend(self._decoder.rest())
            self._decoder.reports.clear()
            self._kitty.begin()

    def codes(self) -> list[int]:
        """Scan codes since the last call, in order; never waits."""
        codes: list[int] = []
        if self._before is not None and not self._is_ours():
            # In the background, where reading stops a program, or gone: nobody holds a key there.
            return self.held.all_up()
        for stroke in self.strokes():
            codes += self.held.codes(stroke, self._now_ns())
        if FOCUS_LOST in self._decoder.reports:
            codes += self.held.all_up()
        self._decoder.reports.clear()
        if self._before is not None:
            codes += self.held.guess.elapsed(self._now_ns())
        return codes

    def strokes(self) -> list[Stroke]:
        """What happened to keys since the last call; never waits."""
        if self._before is None:
            return []
        strokes = self._read()
        self._kitty.settled()
        return [stroke for stroke in strokes if not self._signals(stroke)]

    def end(self) -> None:
        """They stand: give it back, without what was typed meanwhile."""
        if self._before is not None:
            self._settle()
            with contextlib.suppress(termios.error):
                termios.tcflush(self._descriptor, termios.TCIFLUSH)
            self._decoder = self._decoder.anew()
        self._give_back()

    def close(self) -> None:
        """As it was before the first ``begin``."""
        self.end()

    def kbhit(self) -> bool:
        """A key waits."""
        if not self.ahead and self._take():
            try:
                self._keep(self.strokes())
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
                self._kitty.begin()
                while not self.ahead and not self._is_gone:
                    select.select([self._descriptor], [], [], _LOOK_S)
                    self._keep(self.strokes())
            finally:
                self._keep(self._settle())
                self._give_back()
        if not self.ahead:
            raise EOFError
        key = self.ahead.popleft()
        self.held.guess.press(key.code, self._now_ns())
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

    def _keep(self, strokes: list[Stroke]) -> None:
        """They are the program's."""
        went_down = (stroke.key for stroke in strokes if stroke.phase != "release")
        self.ahead.extend(key for key in went_down if key.text)

    def _take(self) -> bool:
        """Byte by byte, without echo; False: the terminal is not ours."""
        if self._before is None and self._is_ours():
            self._before = termios.tcgetattr(self._descriptor)
            lifeline.hold(self)
            mine = termios.tcgetattr(self._descriptor)
            mine[_LOCAL] &= ~(termios.ICANON | termios.ECHO)
            mine[_CONTROL_CHARACTERS][termios.VMIN] = 0
            mine[_CONTROL_CHARACTERS][termios.VTIME] = 0
            mine[_CONTROL_CHARACTERS][termios.VSUSP] = self._nothing
            termios.tcsetattr(self._descriptor, termios.TCSANOW, mine)
        return self._before is not None

    def _settle(self) -> list[Stroke]:
        """Plain again; what was typed until then."""
        strokes: list[Stroke] = []
        self._kitty.end()
        while not self._kitty.settled() and not self._is_gone:
            select.select([self._descriptor], [], [], _LOOK_S)
            strokes += self._read()
        self.held.forget()
        return strokes

    def _give_back(self) -> None:
        before, self._before = self._before, None
        if before is not None:
            if self._is_ours():
                termios.tcsetattr(self._descriptor, termios.TCSANOW, before)
            lifeline.let_go(self)

    def _signals(self, stroke: Stroke) -> bool:
        """Do what the terminal itself would have done for this key; False: nothing."""
        before, char = self._before, stroke.key.text.encode()
        if before is None or not before[_LOCAL] & termios.ISIG or char in (b"", self._nothing):
            return False
        for place, number in _SIGNALS.items():
            if before[_CONTROL_CHARACTERS][place] == char and stroke.phase in ("press", "typed"):
                self._send(number)
                return True
        return False

    @property
    def _nothing(self) -> bytes:
        """The control character that is none."""
        return bytes([os.fpathconf(self._descriptor, "PC_VDISABLE")])

    def _send(self, number: signal.Signals) -> None:
        if number is signal.SIGINT:
            os.killpg(os.getpgrp(), number)
            return
        self._settle()
        self._give_back()
        os.killpg(os.getpgrp(), number)
        # It may be another thread that is told; this one must not go on before all are stopped.
        time.sleep(_STOPPING_S)
        if self._take():
            self._kitty.begin()

    def _is_ours(self) -> bool:
        try:
            return os.tcgetpgrp(self._descriptor) == os.getpgrp()
        except OSError:
            return False

    def _write(self, data: bytes) -> None:
        if self._is_ours():
            with contextlib.suppress(OSError):
                os.write(self._descriptor, data)

    def _read(self) -> list[Stroke]:
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
        self._decoder.tells_releases = self._kitty.is_on
        strokes = self._decoder.strokes(data, self._now_ns())
        for report in self._decoder.reports:
            self._kitty.heard(report)
        self._decoder.reports = [r for r in self._decoder.reports if r == FOCUS_LOST]
        return strokes


class RedirectedKeys(NoKeys):
    """The input is a file or a pipe, but the program runs in a terminal: its keys brake.

    Args:
        stream: the input; ``getch`` is of that.
        terminal: where the program runs.
    """

    def __init__(self, stream: TextIO | None, terminal: TerminalKeys) -> None:
        super().__init__(stream)
        self._terminal = terminal

    def begin(self) -> None:
        """Axes will move: take the keyboard away."""
        self._terminal.begin()

    def codes(self) -> list[int]:
        """Scan codes since the last call, in order; never waits."""
        return self._terminal.codes()

    def end(self) -> None:
        """They stand: give it back; what was typed ahead is nobody's."""
        self._terminal.end()
        self._terminal.ahead.clear()


def keys_beside(stream: TextIO | None, layout: str, wanted: Wanted = "plain") -> NoKeys:
    """Keys of a program whose input is no terminal: of the terminal that it runs in, if any."""
    try:
        descriptor = os.open("/dev/tty", os.O_RDWR | os.O_NOCTTY | os.O_CLOEXEC)
    except OSError:
        return NoKeys(stream)
    return RedirectedKeys(stream, TerminalKeys(descriptor, layout, wanted=wanted))


def keys_of(stream: TextIO, layout: str, wanted: Wanted = "plain") -> TerminalKeys | None:
    """The terminal that a stream reads from; None: it is none."""
    try:
        if not stream.isatty():
            return None
        return TerminalKeys(stream.fileno(), layout, wanted=wanted)
    except (OSError, ValueError):
        return None
