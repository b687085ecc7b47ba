"""Nothing in a foreign text commands a terminal."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.plaintext import dotted, plain, plain_lines

ANY_TEXT = st.text(st.characters(exclude_categories=()))


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain, µ and 漢", "plain, µ and 漢"),
        ("\x1b]0;title\x07", "\\x1b]0;title\\x07"),
        ("\x1b]52;c;aGk=\x1b\\", "\\x1b]52;c;aGk=\\x1b\\"),
        ("\x9b2J", "\\x9b2J"),
        ("a\rb\nc\td", "a\\rb\\nc\\td"),
        ("\u202egnp.exe", "\\u202egnp.exe"),
        ("\udc80", "\\udc80"),
        ("\U000e0041", "\\U000e0041"),
        ("\x7f\u2028\u200f", "\\x7f\\u2028\\u200f"),
    ],
)
def test_what_commands_is_shown_as_an_escape(text: str, shown: str) -> None:
    assert plain(text) == shown
    assert plain(shown) == shown


@given(ANY_TEXT)
def test_no_control_and_no_direction_is_left(text: str) -> None:
    for shown in (plain(text), dotted(text), plain_lines(text).replace("\n", "").replace("\t", "")):
        assert not any(unicodedata.category(c) in ("Cc", "Cs", "Zl", "Zp") for c in shown)
        assert not any(
            unicodedata.bidirectional(c) in ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI")
            for c in shown
        )
        shown.encode()


@given(ANY_TEXT)
def test_twice_is_once_and_dots_keep_the_length(text: str) -> None:
    assert plain(plain(text)) == plain(text)
    assert len(dotted(text)) == len(text)


def test_lines_stay_lines() -> None:
    assert plain_lines("a\n\tb\x1b\rc") == "a\n\tb\\x1b\\rc"
