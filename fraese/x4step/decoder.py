"""From the bytes of a plain terminal to keys with their make codes.

    bytes --> characters --> ESC?  [ O ...  a sequence: arrow, function key
                              |    nothing for 25 ms: the ESC key
                              '    anything else: the ESC key, and that

Rule 1: an arrow's sequence is never taken for ESC, and a lone ESC is one 25 ms later. What could
        be both, ESC and a character at once, is ESC: it brakes.
Rule 2: a terminal does not tell when a key comes up. It is taken to be up 700 ms after it went
        down if it does not repeat, else 150 ms after the last repeat, or when another goes down.
"""

import codecs
import re
from typing import Final, NamedTuple

from fraese.x4step.keyboard import SEQUENCES, char_codes

ESC: Final = "\x1b"
_BREAK: Final = 128
#: What belongs to a sequence comes within this time, ns.
_TOGETHER_NS: Final = 25_000_000
#: A key that is held repeats after this time at the latest, ns,
_FIRST_NS: Final = 700_000_000
#: and then so often.
_REPEAT_NS: Final = 150_000_000
#: ESC [ parameters final, ESC O final; with modifiers, which are dropped.
_WHOLE: Final = re.compile(r"\x1b(\[\[[A-E]|[\[O][0-9;]*[A-Za-z~])")
_PART: Final = re.compile(r"\x1b(\[\[?|[\[O][0-9;]*)?\Z")
_MODIFIERS: Final = re.compile(r"(?<=[\[O])1(?=;)|;[0-9;]*")


class Key(NamedTuple):
    """A key that went down.

    Attributes:
        code: its make code; 0: a character that lies nowhere on this keyboard.
        text: what it means to a program: a character; for others NUL and the make code, as DOS.
    """

    code: int
    text: str


class Decoder:
    """Makes keys of bytes.

    Args:
        layout: "us" or "de": where the characters lie.
    """

    def __init__(self, layout: str) -> None:
        self._layout = layout
        self._codes = char_codes(layout)
        self._utf8 = codecs.getincrementaldecoder("utf-8")("replace")
        self._pending = ""
        self._since_ns = 0

    def take(self, data: bytes, now_ns: int) -> list[Key]:
        """The keys of these bytes, and of what came before and is now known to be whole.

        Args:
            data: what the terminal has sent; may be nothing.
            now_ns: when.
        """
        if data:
            self._pending += self._utf8.decode(data)
            self._since_ns = now_ns
        is_old = now_ns - self._since_ns >= _TOGETHER_NS
        keys = []
        while self._pending:
            found = _WHOLE.match(self._pending)
            if not found and not is_old and _PART.match(self._pending):
                break
            text = found.group() if found else self._pending[0]
            self._pending = self._pending[len(text) :]
            key = self._sequence(text) if found else self._char(text)
            if key:
                keys.append(key)
        return keys

    def rest(self) -> list[Key]:
        """Nothing more belongs to what has come so far."""
        return self.take(b"", self._since_ns + _TOGETHER_NS)

    def anew(self) -> "Decoder":
        """Another one, that has heard nothing yet."""
        return Decoder(self._layout)

    def _char(self, char: str) -> Key:
        return Key(self._codes.get(char, 0), char)

    @staticmethod
    def _sequence(text: str) -> Key | None:
        code = SEQUENCES.get(_MODIFIERS.sub("", text[1:]))
        return Key(code, f"\0{chr(code)}") if code else None


class Holding:
    """Guesses when a key came up.

    Attributes:
        down: make code of the key that is down; 0: none.
    """

    def __init__(self) -> None:
        self.down = 0
        self._up_ns = 0

    def press(self, code: int, now_ns: int) -> list[int]:
        """A key went down, or repeats; the scan codes of that."""
        again = code == self.down
        before = [] if again else self.release()
        self.down, self._up_ns = code, now_ns + (_REPEAT_NS if again else _FIRST_NS)
        return [*before, code]

    def elapsed(self, now_ns: int) -> list[int]:
        """Time has passed; the break code of a key that did not repeat."""
        return self.release() if self.down and now_ns >= self._up_ns else []

    def release(self) -> list[int]:
        """It is up; its break code."""
        down, self.down = self.down, 0
        return [down | _BREAK] if down else []
