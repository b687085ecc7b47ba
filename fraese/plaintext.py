r"""Text from elsewhere, made fit to be shown and logged: nothing in it can command a terminal.

    a ESC ]0;title BEL b  ->  a\x1b]0;title\x07b

Programs, file names, configuration values and what a device says of itself are foreign. What a
terminal obeys (C0, C1, DEL), what turns the reading direction (bidi controls), what breaks a line
where none should end (LS, PS) and what cannot be encoded (lone surrogates) is shown as an escape.

Rule 1: it is done where text leaves the program: standard error and output, the app's widgets, the
        log. What passes twice stays the same.
Rule 2: only what is written so is a control character of ours; it never passes here.
"""

from collections.abc import Mapping
from typing import Final

#: C0, DEL and C1; soft hyphen; Arabic letter mark; zero widths and directional marks; line and
#: paragraph separators, embeddings and overrides; word joiner to isolates and deprecated formats;
#: surrogates; byte order mark, annotations; tags.
_RANGES: Final = (
    (0x00, 0x1F),
    (0x7F, 0x9F),
    (0xAD, 0xAD),
    (0x061C, 0x061C),
    (0x180E, 0x180E),
    (0x200B, 0x200F),
    (0x2028, 0x202E),
    (0x2060, 0x206F),
    (0xD800, 0xDFFF),
    (0xFEFF, 0xFEFF),
    (0xFFF9, 0xFFFB),
    (0xE0000, 0xE007F),
)
_NAMED: Final = {"\n": "\\n", "\r": "\\r", "\t": "\\t"}


def _escape(code: int) -> str:
    if code <= 0xFF:
        return _NAMED.get(chr(code), f"\\x{code:02x}")
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"


_HARMFUL: Final = [code for first, last in _RANGES for code in range(first, last + 1)]
_ESCAPES: Final[Mapping[int, str]] = {code: _escape(code) for code in _HARMFUL}
_LINES: Final[Mapping[int, str]] = {
    code: text for code, text in _ESCAPES.items() if chr(code) not in "\n\t"
}
_DOTS: Final[Mapping[int, str]] = dict.fromkeys(_HARMFUL, "·")


def plain(text: str) -> str:
    """One line: what could command a terminal is shown as an escape."""
    return text if text.isascii() and text.isprintable() else text.translate(_ESCAPES)


def plain_lines(text: str) -> str:
    """The same for several lines: line feeds and tabs stay."""
    return text.translate(_LINES)


def dotted(text: str) -> str:
    """The same, each a dot: a text keeps its length."""
    return text.translate(_DOTS)
