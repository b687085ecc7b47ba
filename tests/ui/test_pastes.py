"""What is pasted is text for an input, and never a row of commands."""

import pytest
from textual.events import Key, Paste

from fraese.ui.pastes import with_pastes
from fraese.ui.terminal import _Keys


def heard(data: bytes) -> list[str]:
    """Keys by name, pastes in quotes."""
    return [
        repr(message.text) if isinstance(message, Paste) else message.key
        for message in _Keys().heard(data)
        if isinstance(message, Key | Paste)
    ]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"Xr1\r", ["X", "r", "1", "enter"]),
        (b"5\x1b[C\x1b[C", ["5", "right", "right"]),
        (b"wwwwww", ["w"] * 6),
        (b"garbage", ["'garbage'"]),
        (b"G0 X1\rr\rA", ["'G0 X1\\nr\\nA'"]),
        (b"part.nc\r", ["'part.nc'", "enter"]),
        (b"garbage\x03", ["'garbage'", "ctrl+c"]),
        (b"\x1b[Cgarbage\x1b[C", ["right", "'garbage'", "right"]),
    ],
)
def test_text_that_comes_at_once_is_a_paste(data: bytes, said: list[str]) -> None:
    assert heard(data) == said


def test_nothing_comes_of_nothing() -> None:
    assert list(with_pastes([])) == []
