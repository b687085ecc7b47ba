"""A terminal that knows kitty's keyboard protocol: what it sends for keys, and how it answers.

Encoded as https://sw.kovidgoyal.net/kitty/keyboard-protocol/ describes it: functional keys by their
table, event types left out for a press without modifiers, the place after two colons.
"""

import codecs
import os
import pty
import re
import select
import sys
import termios
import textwrap
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from fraese.x4step.keyboard import MAKE_CODES

ROOT = Path(__file__).parents[2]
PRESS, REPEAT, RELEASE = 1, 2, 3
_PATIENCE_S: Final = 30.0
_LOOK_S: Final = 0.02
_QUERY: Final = re.compile(rb"\x1b\[(\?u|c|>\d*u|<\d*u|=\d+;2u|\?1004[hl])")

#: Final character and number of keys, by their names here.
FUNCTIONAL: Final[Mapping[str, tuple[int, str]]] = {
    "ESC": (27, "u"), "ENTER": (13, "u"), "TAB": (9, "u"), "BACKSPACE": (127, "u"),
    "INSERT": (2, "~"), "DELETE": (3, "~"), "LEFT": (1, "D"), "RIGHT": (1, "C"), "UP": (1, "A"),
    "DOWN": (1, "B"), "PAGEUP": (5, "~"), "PAGEDOWN": (6, "~"), "HOME": (1, "H"), "END": (1, "F"),
    "CAPSLOCK": (57358, "u"), "SCROLLLOCK": (57359, "u"), "NUMLOCK": (57360, "u"),
    "F1": (1, "P"), "F2": (1, "Q"), "F3": (13, "~"), "F4": (1, "S"), "F5": (15, "~"),
    "F6": (17, "~"), "F7": (18, "~"), "F8": (19, "~"), "F9": (20, "~"), "F10": (21, "~"),
    "F11": (23, "~"), "F12": (24, "~"), "KP5": (1, "E"), "KP*": (57411, "u"),
    "KP-": (57412, "u"), "KP+": (57413, "u"), "SHIFT": (57441, "u"), "CTRL": (57442, "u"),
    "ALT": (57443, "u"), "RIGHTSHIFT": (57447, "u"), "SPACE": (32, "u"), "102ND": (60, "u"),
}  # fmt: skip
#: Every key that a terminal sends: all but SysRq.
KEYS: Final = tuple(name for name in MAKE_CODES if name != "SYSREQ")


def encoded(
    name: str, event: int = PRESS, modifiers: int = 0, *, place: str = "", text: str = ""
) -> bytes:
    """What is sent for a key.

    Args:
        name: of the key; a character for the others.
        event: press, repeat or release.
        modifiers: bits of the protocol.
        place: the key there on a keyboard of the United States, if it is another.
        text: that it types.
    """
    number, final = FUNCTIONAL.get(name, (ord(name[0].lower()), "u"))
    key = f"{number}" + (f"::{ord(place)}" if place else "")
    middle = ""
    if modifiers or event != PRESS:
        middle = f"{1 + modifiers}" + (f":{event}" if event != PRESS else "")
    fields = [key, middle, ":".join(str(ord(char)) for char in text)]
    while fields and not fields[-1]:
        fields.pop()
    if final not in "u~" and fields == ["1"]:
        fields = []
    return f"\x1b[{';'.join(fields)}{final}".encode()


@dataclass
class KittyTerminal:
    """Answers what a program asks, and remembers what it was told.

    Attributes:
        knows: it knows the protocol.
        flags: the stack of flags.
        focus: it tells when the focus changes.
    """

    knows: bool = True
    flags: list[int] = field(default_factory=list)
    focus: bool = False

    def answer(self, output: bytes) -> bytes:
        """What it sends back for what a program wrote."""
        back = b""
        for match in _QUERY.finditer(output):
            asked = match.group(1)
            if asked == b"c":
                back += b"\x1b[?62;4c"
            elif asked.startswith(b"?1004"):
                self.focus = asked.endswith(b"h")
            elif not self.knows:
                continue
            elif asked == b"?u":
                back += b"\x1b[?%du" % (self.flags[-1] if self.flags else 0)
            elif asked.startswith(b">"):
                self.flags.append(int(asked[1:-1] or 0))
            elif asked.startswith(b"="):
                self.flags[-1:] = [(self.flags or [0])[-1] | int(asked[1:-3])]
            else:
                del self.flags[-int(asked[1:-1] or 1) :]
        return back


@dataclass
class Screen:
    """A program that has such a terminal of its own.

    Attributes:
        terminal: what it has.
        seen: all that it wrote.
        mark: what of it was waited for already.
        left: how it left the terminal's settings.
    """

    terminal: KittyTerminal = field(default_factory=KittyTerminal)
    seen: str = ""
    _decoder: codecs.IncrementalDecoder = field(
        default_factory=codecs.getincrementaldecoder("utf-8"), repr=False
    )
    mark: int = 0
    left: list[object] = field(default_factory=list)

    def start(self, program: str, *arguments: str) -> None:
        """A Python program; without its text a command of fraese."""
        code = (
            ["-c", textwrap.dedent(program), *arguments]
            if program
            else ["-m", "fraese", *arguments]
        )
        surroundings = {"PYTHONPATH": str(ROOT), "XDG_CONFIG_HOME": "/no"}
        self.start_program([sys.executable, *code], {**os.environ, **surroundings})

    def start_program(self, command: list[str], environment: Mapping[str, str]) -> None:
        """Any program."""
        self.child, self.master = pty.fork()
        if self.child == 0:
            os.execve(command[0], command, {**environment, "TERM": "xterm-kitty"})

    def until(self, word: str) -> None:
        """It is seen."""
        self._read_until(lambda: word in self.seen[self.mark :])
        self.mark = self.seen.index(word, self.mark) + len(word)

    def until_flags(self, flags: list[int]) -> None:
        """The terminal was told so."""
        self._read_until(lambda: self.terminal.flags == flags)

    def read(self) -> bool:
        try:
            output = os.read(self.master, 4096)
        except OSError:
            return False
        # A character may be cut where a read ends.
        self.seen += self._decoder.decode(output)
        if back := self.terminal.answer(output):
            os.write(self.master, back)
        return bool(output)

    def type(self, data: bytes) -> None:
        os.write(self.master, data)

    def end(self) -> int:
        """It ends by itself; its status. What it leaves behind may keep the terminal open."""
        self._read_until(self._gone)
        while select.select([self.master], [], [], 0)[0] and self.read():
            pass
        self.left = termios.tcgetattr(self.master)
        os.close(self.master)
        self.seen = self.seen.replace("\r\n", "\n")
        return os.waitstatus_to_exitcode(self._status)

    def _gone(self) -> bool:
        process, self._status = os.waitpid(self.child, os.WNOHANG)
        return process == self.child

    def _read_until(self, holds: Callable[[], bool]) -> None:
        until_s = time.monotonic() + _PATIENCE_S
        open_ = True
        while not holds():
            assert time.monotonic() < until_s, self.seen
            if not open_:
                time.sleep(_LOOK_S)
            elif select.select([self.master], [], [], _LOOK_S)[0]:
                open_ = self.read()
