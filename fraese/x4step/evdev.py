"""Keys from the keyboards of Linux, /dev/input/event*, with their releases.

    struct input_event:  time, 2 long | type u16 | code u16 | value s32      24 bytes, or 16
    type 1 (key):        value 1 down, 2 repeats, 0 up
    type 0, code 3:      events were lost

Rule 1: a keyboard is heard whichever window has the focus. So it only brakes: what starts a motion
        comes from the terminal, and nothing of it is text.
Rule 2: who sits at another keyboard (ssh) still brakes: what the terminal sends counts too, unless
        the same key was heard here.
Rule 3: a keyboard that goes away, or loses events, has all its keys up.
Rule 4: nothing is grabbed: other programs hear the keys as ever.
"""

import contextlib
import errno
import fcntl
import os
import struct
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

from fraese.x4step.codes import ESC_CODE
from fraese.x4step.decoder import Key, Stroke
from fraese.x4step.keyboard import BREAK, EVDEV_CODES, MAKE_CODES
from fraese.x4step.keys import KeySource
from fraese.x4step.terminal import TerminalKeys

FOLDER: Final = Path("/dev/input")
#: This machine's struct input_event: seconds, microseconds, type, code, value.
NATIVE: Final = struct.Struct("llHHi")

_EV_SYN, _SYN_DROPPED = 0, 3
_EV_KEY: Final = 1
_UP, _DOWN, _REPEAT = 0, 1, 2
_CHUNK: Final = 64
#: EVIOCGBIT(EV_KEY, 96): which keys a device has, as bits.
_KEY_BYTES: Final = 96
_HAS_KEYS: Final = 2 << 30 | _KEY_BYTES << 16 | ord("E") << 8 | 0x20 + _EV_KEY
_A_KEYBOARD_HAS: Final = tuple(MAKE_CODES[name] for name in ("ESC", "A", "ENTER"))


class EventDevice:
    """One keyboard, already open.

    Args:
        descriptor: of the device; does not block.
        layout: of its events.
    """

    def __init__(self, descriptor: int, layout: struct.Struct = NATIVE) -> None:
        self._descriptor = descriptor
        self._layout = layout
        self._rest = b""
        self._is_gone = False
        self.down: set[int] = set()

    def codes(self) -> list[int]:
        """Scan codes since the last call, in order; never waits."""
        codes: list[int] = []
        while not self._is_gone and (data := self._chunk()):
            data = self._rest + data
            whole = len(data) - len(data) % self._layout.size
            self._rest = data[whole:]
            for _, _, kind, number, value in self._layout.iter_unpack(data[:whole]):
                codes += self._event(kind, number, value)
        return codes + self._all_up() if self._is_gone else codes

    def close(self) -> None:
        """Not heard any more."""
        self._is_gone = True
        descriptor, self._descriptor = self._descriptor, -1
        if descriptor >= 0:
            os.close(descriptor)

    def _chunk(self) -> bytes:
        try:
            data = os.read(self._descriptor, _CHUNK * self._layout.size)
        except BlockingIOError:
            return b""
        except OSError as error:
            if error.errno == errno.EINTR:
                return b""
            data = b""
        if not data:
            self.close()
        return data

    def _event(self, kind: int, number: int, value: int) -> list[int]:
        if (kind, number) == (_EV_SYN, _SYN_DROPPED):
            return self._all_up()
        code = EVDEV_CODES.get(number, 0) if kind == _EV_KEY else 0
        if not code or value not in (_UP, _DOWN, _REPEAT):
            return []
        if value == _UP:
            self.down.discard(code)
            return [code | BREAK]
        self.down.add(code)
        return [code]

    def _all_up(self) -> list[int]:
        down, self.down = sorted(self.down), set()
        return [code | BREAK for code in down]


class EvdevKeys:
    """A source of keys: keyboards, beside the terminal that is the program's.

    Args:
        devices: the keyboards.
        program: what the program reads; its keys brake too.
        said: what keys come from, for a person.
    """

    def __init__(self, devices: Sequence[EventDevice], program: KeySource, said: str) -> None:
        self._devices = devices
        self._program = program
        self._first: list[int] = []
        self._heard: set[int] = set()
        self.said = said

    def begin(self) -> None:
        """Axes will move: take the keyboard away from the program."""
        before = self._events()
        self._program.begin()
        down = {code for device in self._devices for code in device.down}
        self._heard = set(down)
        self._first = self._let_go_already(before, down)

    def codes(self) -> list[int]:
        """Scan codes since the last call, in order; never waits."""
        # The terminal first: what it tells the keyboard has told before.
        sent = list(self._program.codes())
        codes, self._first = self._first + self._events(), []
        self._heard |= {code & ~BREAK for code in codes}
        return codes + [
            code for code in sent if code & ~BREAK not in self._heard or code == ESC_CODE
        ]

    def strokes(self) -> list[Stroke]:
        """What happened to keys since the last call, without their text; never waits."""
        return [
            Stroke(Key(code & ~BREAK, ""), "release" if code & BREAK else "press")
            for code in self.codes()
        ]

    def end(self) -> None:
        """They stand: give it back, without what was typed meanwhile."""
        self._program.end()
        self._first = []

    def kbhit(self) -> bool:
        """A key waits for ``getch``."""
        return self._program.kbhit()

    def getch(self) -> Key:
        """The next key of those that are the program's; waits for one."""
        return self._program.getch()

    def skip(self, code: int) -> bool:
        """Take the next key if it is this one, and waits; never waits for it."""
        return self._program.skip(code)

    def line_ahead(self) -> str:
        """What was typed ahead, up to the end of its line."""
        return self._program.line_ahead()

    def _events(self) -> list[int]:
        return [code for device in self._devices for code in device.codes()]

    def _let_go_already(self, before: Iterable[int], down: set[int]) -> list[int]:
        """The key that the program was just given is up again: its break code comes at once."""
        if not isinstance(self._program, TerminalKeys):
            return []
        guess = self._program.held.guess
        if guess.down not in before:
            return []
        given = guess.release()
        return [code for code in given if code & ~BREAK not in down]


def keyboards(paths: Iterable[str | Path]) -> list[tuple[Path, EventDevice]]:
    """Those that can be read; of all devices, if none is named, those that are keyboards."""
    named = [Path(path) for path in paths]
    found = []
    for path in named or sorted(
        FOLDER.glob("event*"), key=lambda path: (len(path.name), path.name)
    ):
        with contextlib.suppress(OSError):
            descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
            if named or _is_keyboard(descriptor):
                found.append((path, EventDevice(descriptor)))
            else:
                os.close(descriptor)
    return found


def _is_keyboard(descriptor: int) -> bool:
    bits = bytearray(_KEY_BYTES)
    try:
        fcntl.ioctl(descriptor, _HAS_KEYS, bits)
    except OSError:
        return False
    return all(bits[code // 8] >> code % 8 & 1 for code in _A_KEYBOARD_HAS)
