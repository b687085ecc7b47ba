"""What a terminal sends for keys, with and without kitty's protocol, and what becomes of it."""

import pytest

pytest.importorskip("termios")

from hypothesis import given
from hypothesis import strategies as st
from textual.events import Key, MouseEvent, Paste
from textual.message import Message

from fraese.ui.keyevents import KeyEvents, Up
from fraese.ui.messages import KeyUp
from fraese.ui.terminal import _Keys
from tests.x4step.kittyterminal import KEYS, PRESS, RELEASE, REPEAT, encoded

KNOWS = b"\x1b[?27u"


class Line:
    """A line with a terminal at its end, and the time."""

    def __init__(self, *, kitty: bool = False) -> None:
        self.now_s = 0.0
        self.keys = _Keys(now=lambda: self.now_s)
        if kitty:
            assert self.send(KNOWS) == []

    def send(self, data: bytes) -> list[str]:
        """Names of what was heard at once; a release begins with a minus."""
        return [name for message in self.keys.heard(data) if (name := _named(message))]

    def silent(self) -> list[str]:
        self.now_s += self.keys.patience_s
        return self.send(b"")


def _named(message: Message) -> str:
    match message:
        case KeyUp():
            return f"-{message.key}"
        case Key():
            return message.key
        case Paste():
            return f"paste {message.text}"
        case MouseEvent():
            return type(message).__name__
    return ""


def test_presses_repeats_and_releases() -> None:
    line = Line(kitty=True)
    assert line.send(b"\x1b[1;1:1C\x1b[1;1:2C\x1b[1;1:3C") == ["right", "right", "-right"]
    assert line.send(b"\x1b[C\x1b[1;5:2A\x1b[1;5:3A") == ["right", "ctrl+up", "-ctrl+up"]
    assert line.send(b"\x1b[103;1:1;103u\x1b[103;1:3u") == ["g", "-g"]
    assert line.send(b"\x1b[103;2:1;71u\x1b[103;2:3u") == ["G", "-shift+g"]
    assert line.send(b"\x1b[5;1:1~\x1b[5;1:3~") == ["pageup", "-pageup"]
    assert line.send(b"\x1b[99;5u\x1b[99;5:3u") == ["ctrl+c", "-ctrl+c"]


def test_escape_comes_at_once_where_the_protocol_is_spoken() -> None:
    line = Line(kitty=True)
    assert line.send(encoded("ESC")) == ["escape"]
    assert line.send(encoded("ESC", RELEASE)) == ["-escape"]


@pytest.mark.parametrize("event", [PRESS, REPEAT, RELEASE])
def test_every_key_is_whole_wherever_it_is_torn(event: int) -> None:
    for name in KEYS:
        whole = encoded(name, event)
        if not whole.startswith(b"\x1b[") or b"::" in whole:
            continue
        expected = Line(kitty=True).send(whole)
        for at in range(1, len(whole)):
            line = Line(kitty=True)
            assert line.send(whole[:at]) + line.send(whole[at:]) == expected, (name, at)


def test_a_lone_escape_is_a_key_after_a_moment() -> None:
    line = Line()
    assert line.send(b"\x1b") == []
    assert line.keys.patience_s == 0.02
    assert line.silent() == ["escape"]
    assert line.send(b"\x1b\x1b") == []
    assert line.silent() == ["escape", "escape"]


def test_what_follows_an_escape_too_late_is_no_row_of_keys() -> None:
    for rest in (b"[C", b"[", b"OA", b"[1;5D"):
        line = Line()
        assert line.send(b"\x1b") + line.silent() == ["escape"]
        line.now_s += 0.05
        assert line.send(rest) == []
        line.now_s += 0.2
        assert line.send(b"g") == ["g"]


def test_what_is_in_time_is_one_key() -> None:
    line = Line()
    assert line.send(b"\x1b") + line.send(b"[C") == ["right"]
    assert line.send(b"a\x1b") + line.send(b"[D") == ["a", "left"]


def test_a_terminal_that_has_not_said_so_tells_nothing() -> None:
    line = Line()
    line.send(b"\x1b[?0u")
    assert not line.keys.tells
    line.send(b"\x1b[?27u")
    assert line.keys.tells


def test_nonsense_is_left_out_and_what_follows_is_heard() -> None:
    for nonsense in (b"\x1b[99999999999;1:3u", b"\x1b[;:3A", b"\x1b[1;1:3:3A", b"\x1b[?999999999u"):
        line = Line(kitty=True)
        line.send(nonsense)
        for _ in range(10):
            line.silent()
        assert line.send(encoded("RIGHT")) == ["right"]


@given(st.text(st.sampled_from("\x1b[1;:?3uCAO~ \x03a"), max_size=40), st.booleans())
def test_the_parts_are_what_came(text: str, tells: bool) -> None:
    events = KeyEvents()
    events.tells = tells
    parts = [*events.parts(text), *events.parts("")]
    if ":" not in text and "?" not in text:
        assert "".join(part for part in parts if isinstance(part, str)) == text
    assert not events.waits
    assert all(not isinstance(part, Up) or part.sequence.startswith("\x1b[") for part in parts)
