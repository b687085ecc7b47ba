r"""Which of a terminal's bytes say that a key is let go: event types of kitty's keyboard protocol.

    ESC [ 1 ; 1 : 3 A      up, let go       -->  Up("\x1b[A")
    ESC [ 1 ; 1 : 2 A      up, repeats      -->  ESC [ A        as if it were pressed again
    ESC [ ? 27 u           it knows the protocol, and these are the flags in force

Textual switches the protocol on, but not these; its parser does not know them.

Rule 1: everything else passes as it came, and at once; what may be the beginning of such a sequence
        waits for its end, or until nothing more comes.
Rule 2: where the terminal has not said that it knows the protocol only ESC at the end waits: it may
        be a key, or the beginning of a longer one.

https://sw.kovidgoyal.net/kitty/keyboard-protocol/
"""

import re
from collections.abc import Iterator
from typing import Final, NamedTuple

#: Set, of the flags in force, the one for event types; ask which flags are in force.
WANTED: Final = "\x1b[=2;2u\x1b[?u"
_EVENT_TYPES: Final = 2
_RELEASE: Final = "3"
_ANY: Final = re.compile(
    r"\x1b\[(?P<number>\d{1,7})(?::\d*){0,2};(?P<modifiers>\d{0,4}):(?P<event>\d)"
    r"(?:;(?P<text>[\d:]*))?(?P<final>[u~A-HPQRS])"
    r"|\x1b\[\?(?P<flags>\d{0,4})u"
)
_PART: Final = re.compile(r"\x1b+(?:\[[?]?[\d;:]*)?\Z")
_ESCAPES: Final = re.compile(r"\x1b+\Z")
#: Of a sequence of the protocol no more is waited for.
_LONGEST: Final = 64


class Up(NamedTuple):
    """A key was let go; the sequence with which it would be pressed."""

    sequence: str


class KeyEvents:
    """Takes event types out of what a terminal sends.

    Attributes:
        tells: it tells when a key comes up.
    """

    def __init__(self) -> None:
        self.tells = False
        self._pending = ""

    @property
    def waits(self) -> bool:
        """Something has come that may be the beginning of more."""
        return bool(self._pending)

    def parts(self, text: str) -> Iterator[str | Up]:
        """What this text is for a parser that knows no event types; nothing: no more has come."""
        text, waited, self._pending = self._pending + text, not text, ""
        at = 0
        for found in _ANY.finditer(text):
            if text[at : found.start()]:
                yield text[at : found.start()]
            at = found.end()
            if found["flags"] is not None:
                self.tells = bool(int(found["flags"] or 0) & _EVENT_TYPES)
            elif found["event"] == _RELEASE:
                yield Up(_pressed(found))
            else:
                yield _pressed(found)
        rest = text[at:]
        part = (_PART if self.tells else _ESCAPES).search(rest)
        if part and not waited and len(part.group()) < _LONGEST:
            self._pending = part.group()
            rest = rest[: part.start()]
        if rest:
            yield rest


def _pressed(found: re.Match[str]) -> str:
    """The same key without an event type, in the shortest form."""
    number, modifiers, final = found["number"], found["modifiers"], found["final"]
    fields = [number, "" if modifiers == "1" else modifiers, found["text"] or ""]
    while len(fields) > 1 and not fields[-1]:
        fields.pop()
    if final not in "u~" and fields == ["1"]:
        fields = []
    return f"\x1b[{';'.join(fields)}{final}"
