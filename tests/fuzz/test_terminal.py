"""What a terminal sends: keys, or nothing; and a stop key is never swallowed.

The whole app with such a terminal: ``tests/ui/test_bad_terminals.py``.
"""

import sys

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.fuzz.lengths import fuzzed, soon

if sys.platform == "win32":
    pytest.skip("it takes what only Unix has", allow_module_level=True)

from textual.events import Key
from textual.message import Message

from fraese.ui.terminal import _Keys

_PIECES = st.one_of(
    st.binary(max_size=12),
    st.sampled_from(
        [
            b"\x1b[",
            b"\x1b",
            b"\x1bO",
            b"\x1b[<",
            b"\x1b[200~",
            b"\x1b[201~",
            b"\x1bP",
            b"\x1b]52;c;",
            b"\x9b",
            b"\x1b[M",
            b"\x1b[48;",
            b"\x1b[?2048;",
            b";99999999999;",
            b"M",
            b"t",
            b"u",
            b"\x1b[C",
            b"\x1b[113;5u",
            b"\xe6\xbc",
            b"\xed\xa0\x80",
            b"\x00",
            b"\x11",
            b"q",
        ]
    ),
)
#: Nothing came for a moment.
_SILENCE = st.just(b"")


def _named(messages: list[Message]) -> list[str]:
    return [message.key for message in messages if isinstance(message, Key)]


@fuzzed(300)
@given(st.lists(st.one_of(_PIECES, _PIECES, _SILENCE), max_size=25), st.integers(0, 25))
@example([b"\x1b[200~", b"G1 X"], 2)
def test_bytes_are_keys_or_nothing_and_ctrl_c_is_heard(pieces: list[bytes], at: int) -> None:
    pieces = [*pieces[:at], b"\x03", *pieces[at:]]
    keys = _Keys()
    for piece in pieces:
        with soon():
            heard = list(keys.heard(piece))
        if b"\x03" in piece:
            assert "ctrl+c" in _named(heard)


@fuzzed(100)
@given(st.lists(_PIECES, max_size=25))
def test_after_a_silence_keys_are_keys_again(pieces: list[bytes]) -> None:
    keys = _Keys()
    for piece in [*pieces, *[b""] * 10]:
        list(keys.heard(piece))
        # The parser's patience with a lone escape is over.
        keys._parser._timeout_time = keys._parser._timeout_time and 0.0
    assert _named(list(keys.heard(b"a\x11")))[-2:] == ["a", "ctrl+q"]
