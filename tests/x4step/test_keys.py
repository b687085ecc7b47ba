"""Make codes, the decoder of a plain terminal, and a real one."""

import os
import pty
import select
import subprocess
import sys
import termios
import textwrap
import time
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import pytest

from fraese.x4step.decoder import Decoder, Holding, Key
from fraese.x4step.keyboard import AT_KEYBOARD, MAKE_CODES, MF2_KEYBOARD, char_codes
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.terminal import TerminalKeys

MS = 1_000_000
ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("name", "code"),
    [("ESC", 1), ("1", 2), ("0", 11), ("-", 12), ("=", 13), ("BACKSPACE", 14), ("TAB", 15),
     ("Q", 16), ("P", 25), ("]", 27), ("ENTER", 28), ("CTRL", 29), ("A", 30), ("L", 38),
     ("`", 41), ("SHIFT", 42), ("\\", 43), ("Z", 44), ("M", 50), ("/", 53), ("RIGHTSHIFT", 54),
     ("KP*", 55), ("ALT", 56), ("SPACE", 57), ("CAPSLOCK", 58), ("F1", 59), ("F10", 68),
     ("NUMLOCK", 69), ("SCROLLLOCK", 70), ("HOME", 71), ("UP", 72), ("PAGEUP", 73), ("KP-", 74),
     ("LEFT", 75), ("KP5", 76), ("RIGHT", 77), ("KP+", 78), ("END", 79), ("DOWN", 80),
     ("PAGEDOWN", 81), ("INSERT", 82), ("DELETE", 83), ("SYSREQ", 84), ("102ND", 86),
     ("F11", 87), ("F12", 88)],
)  # fmt: skip
def test_make_codes(name: str, code: int) -> None:
    assert MAKE_CODES[name] == code


#: Both keyboards as they lie on a table.
_AT_KEYS = (
    "F1 F2 ` 1 2 3 4 5 6 7 8 9 0 - = \\ BACKSPACE ESC NUMLOCK SCROLLLOCK SYSREQ",
    "F3 F4 TAB Q W E R T Y U I O P [ ] HOME UP PAGEUP KP*",
    "F5 F6 CTRL A S D F G H J K L ; ' ENTER LEFT KP5 RIGHT KP-",
    "F7 F8 SHIFT Z X C V B N M , . / RIGHTSHIFT END DOWN PAGEDOWN",
    "F9 F10 ALT SPACE CAPSLOCK INSERT DELETE KP+",
)
_MF2_KEYS = (
    "ESC F1 F2 F3 F4 F5 F6 F7 F8 F9 F10 F11 F12 SCROLLLOCK",
    "` 1 2 3 4 5 6 7 8 9 0 - = BACKSPACE INSERT HOME PAGEUP NUMLOCK / KP* KP-",
    "TAB Q W E R T Y U I O P [ ] ENTER DELETE END PAGEDOWN HOME UP PAGEUP KP+",
    "CAPSLOCK A S D F G H J K L ; ' \\ LEFT KP5 RIGHT",
    "SHIFT 102ND Z X C V B N M , . / RIGHTSHIFT UP END DOWN PAGEDOWN ENTER",
    "CTRL ALT SPACE ALT CTRL LEFT DOWN RIGHT INSERT DELETE",
)


def test_keyboards_of_the_manual() -> None:
    assert sum(map(len, AT_KEYBOARD)) == 84
    assert sorted(code for row in AT_KEYBOARD for code in row) == list(range(1, 85))
    mf2 = [code for row in MF2_KEYBOARD for code in row]
    assert set(mf2) == {*range(1, 89)} - {84, 85}
    twice = {code for code in mf2 if mf2.count(code) == 2}
    assert {28, 29, 56, 71, 72, 73, 75, 77, 79, 80, 81, 82, 83} <= twice
    assert MF2_KEYBOARD[3][0] == 58
    assert [[MAKE_CODES[name] for name in row.split()] for row in _AT_KEYS] == [
        *map(list, AT_KEYBOARD)
    ]
    assert [[MAKE_CODES[name] for name in row.split()] for row in _MF2_KEYS] == [
        *map(list, MF2_KEYBOARD)
    ]


@pytest.mark.parametrize(
    ("layout", "char", "code"),
    [("us", "z", 44), ("us", "Z", 44), ("de", "z", 21), ("de", "y", 44), ("us", "y", 21),
     ("us", "+", 13), ("de", "+", 27), ("us", "-", 12), ("de", "-", 53), ("de", "ö", 39),
     ("us", "\r", 28), ("de", "\n", 28), ("us", " ", 57), ("us", "\x7f", 14), ("us", "\t", 15),
     ("us", "\x01", 30), ("de", "\x1a", 21), ("de", "<", 86), ("us", "?", 53), ("us", "0", 11)],
)  # fmt: skip
def test_characters_lie_where_the_layout_says(layout: str, char: str, code: int) -> None:
    assert char_codes(layout)[char] == code


ESC = Key(1, "\x1b")


@pytest.mark.parametrize(
    ("data", "codes"),
    [(b"a", [30]), (b"\x1b[A", [72]), (b"\x1b[B", [80]), (b"\x1b[C", [77]), (b"\x1b[D", [75]),
     (b"\x1bOD", [75]), (b"\x1b[5~", [73]), (b"\x1b[1;5D", [75]), (b"\x1bOP", [59]),
     (b"\x1b[24~", [88]), (b"\x1b[[A", [59]), (b"\x1b[3~x", [83, 45]), (b"\x1b[200~", []),
     (b"\x1b\x1b[D", [1, 75]), (b"\x1bq", [1, 16]), ("ö".encode(), [0]), (b"\x1b[Z", [])],
)  # fmt: skip
def test_what_a_terminal_sends(data: bytes, codes: list[int]) -> None:
    assert [key.code for key in Decoder("us").take(data, 0)] == codes
    # The same, byte by byte and slowly, but for what follows ESC.
    decoder, slow = Decoder("us"), []
    for number in range(len(data)):
        slow += decoder.take(data[number : number + 1], number * MS)
    assert [key.code for key in slow] == codes


def test_a_lone_escape_is_known_25_ms_later() -> None:
    decoder = Decoder("us")
    assert decoder.take(b"\x1b", 0) == []
    assert decoder.take(b"", 24 * MS) == []
    assert decoder.take(b"", 25 * MS) == [ESC]
    assert decoder.take(b"\x1b[", 100 * MS) == []
    assert decoder.take(b"", 130 * MS) == [ESC, Key(26, "[")]


def test_a_key_that_is_held_and_let_go() -> None:
    holding = Holding()
    assert holding.press(13, 0) == [13]
    assert holding.elapsed(699 * MS) == []
    assert holding.press(13, 699 * MS) == [13]
    assert holding.press(13, 740 * MS) == [13]
    assert holding.elapsed(889 * MS) == []
    assert holding.elapsed(890 * MS) == [141]
    assert holding.elapsed(2000 * MS) == []
    assert holding.press(12, 3000 * MS) == [12]
    assert holding.press(13, 3001 * MS) == [140, 13]
    assert holding.elapsed(3702 * MS) == [141]


@pytest.fixture
def ends() -> tuple[int, int]:
    return pty.openpty()


def test_a_terminal_in_the_background_is_left_alone(ends: tuple[int, int]) -> None:
    _, slave = ends
    before = termios.tcgetattr(slave)
    keys = TerminalKeys(slave, "us")
    keys.begin()
    assert termios.tcgetattr(slave) == before
    assert keys.codes() == []
    keys.end()


#: A program that has a terminal of its own.
_PROGRAM = """
    import sys, time
    from fraese.x4step import *
    from fraese.x4step import surroundings

    def state():
        import termios
        return termios.tcgetattr(0)

    before = state()
    print("first:", input())
    X4Init(2)
    X4MovePos(1, 1000, 50)
    print("moving", flush=True)
    while X4GetState():
        pass
    print("code", X4LastBrakeCode(), state() == before, flush=True)
    print("then:", input())
    if kbhit(): print("ahead:", getch())
    X4ReInit()
"""


def typed(script: list[tuple[str, bytes]]) -> str:
    """Run the program; after each of the words was seen, type something; what was on the screen."""
    child, screen = pty.fork()
    if child == 0:
        os.environ["PYTHONPATH"] = str(Path(__file__).parents[2])
        os.execv(sys.executable, [sys.executable, "-c", textwrap.dedent(_PROGRAM)])
    seen, until_s = "", time.monotonic() + 30
    mark = 0
    for word, data in script:
        while word not in seen[mark:]:
            assert select.select([screen], [], [], until_s - time.monotonic())[0], seen
            seen += os.read(screen, 1024).decode()
        mark = seen.index(word, mark) + len(word)
        time.sleep(0.1)
        os.write(screen, data)
    try:
        while chunk := os.read(screen, 1024):
            seen += chunk.decode()
    except OSError:
        pass
    os.waitpid(child, 0)
    return seen.replace("\r\n", "\n")


@pytest.mark.alone
def test_what_is_typed_while_it_moves_does_not_reach_the_program() -> None:
    seen = typed([("", b"one\n"), ("moving", b"secret\x1b[D"), ("", b"\x1b"), ("code", b"two\n")])
    assert "first: one" in seen
    assert "code 1 True" in seen
    assert "then: two" in seen
    assert "secret" not in seen


@pytest.mark.alone
def test_type_ahead_does_not_brake_and_is_handed_back_by_getch() -> None:
    seen = typed([("", b"one\n\x1b"), ("moving", b""), ("", b"\x1b"), ("code", b"two\n")])
    assert "code 1 True" in seen
    assert "then: two" in seen
    assert "ahead: \x1b" in seen


def test_scancodes_are_shown() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "fraese", "scancodes"],
        cwd=ROOT,
        env={**os.environ, "XDG_CONFIG_HOME": "/nowhere"},
        input="+\x1b[D\nö\x1b\x1bx",
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines() == [
        "=          make  13  break 141",
        "LEFT       make  75  break 203",
        "ENTER      make  28  break 156",
        "'ö': lies nowhere on this keyboard; see x4step.keyboard",
        "ESC        make   1  break 129",
        "ESC        make   1  break 129",
    ]


class SharedCodes(deque[int]):
    """While one machine takes what it heard, the owner of another one hands it one more."""

    def _meanwhile(self) -> None:
        self.append(203)

    def __iter__(self) -> Iterator[int]:
        yield from [self[place] for place in range(len(self))]
        self._meanwhile()

    def popleft(self) -> int:
        code = super().popleft()
        if code != 203:
            self._meanwhile()
        return code


def test_a_key_that_another_machine_hands_round_meanwhile_is_heard() -> None:
    source = HandKeys()
    reader = Keyboard(source).reader()
    reader.begin()
    reader.heard = SharedCodes()
    source.press(75)
    assert [*reader.codes(), *reader.codes()] == [75, 203]
