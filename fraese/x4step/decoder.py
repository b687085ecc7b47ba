"""From the bytes of a terminal to keys with their make codes.

    bytes --> characters --> ESC?  [ O ...  a sequence: arrow, function key, key of kitty's protocol
                              |    [ ? ...  an answer of the terminal: no key, see ``reports``
                              |    nothing for 25 ms: the ESC key
                              '    anything else: the ESC key, and that

Rule 1: an arrow's sequence is never taken for ESC, and a lone ESC is one 25 ms later. What could
        be both, ESC and a character at once, is ESC: it brakes.
Rule 2: a plain terminal does not tell when a key comes up. It is taken to be up 700 ms after it
        went down if it does not repeat, else 150 ms after the last repeat, or when another goes
        down. Kitty's protocol tells; its keys are not guessed.
Rule 3: the codes of kitty's protocol are places if the terminal names the place, in the layout of
        the United States; else they are found by the layout, as those of characters are.

CSI number:shifted:place ; 1+modifiers:event ; text u, and the same with ~ and letters for arrows:
https://sw.kovidgoyal.net/kitty/keyboard-protocol/.
"""

import codecs
import re
from typing import Final, Literal, NamedTuple

from fraese.x4step.keyboard import (
    BREAK,
    KITTY_CODES,
    MAKE_CODES,
    SEQUENCES,
    SILENT_CODES,
    char_codes,
)

ESC: Final = "\x1b"
#: What belongs to a sequence comes within this time, ns.
_TOGETHER_NS: Final = 25_000_000
#: A key that is held repeats after this time at the latest, ns,
_FIRST_NS: Final = 700_000_000
#: and then so often.
_REPEAT_NS: Final = 150_000_000
#: ESC [ private parameters intermediates final; the console of Linux has ESC [ [ letter.
_CSI: Final = re.compile(r"\x1b\[([<-?]?)([0-9:;]*)([ -/]*)([@-Z\\-~])")
_WHOLE: Final = re.compile(rf"\x1b\[\[[A-E]|\x1bO[0-9;]*[A-Za-z~]|{_CSI.pattern}")
_PART: Final = re.compile(r"\x1b(\[\[|\[[<-?]?[0-9:;]*[ -/]*|O[0-9;]*)?\Z")
_MODIFIERS: Final = re.compile(r"(?<=O)1(?=;)|;[0-9;]*")
_SHIFT, _ALT, _CTRL, _OTHERS = 1, 2, 4, 0b111000
#: A key of the protocol is named without Shift, and "<" without it is a key of its own.
_ITS_OWN: Final = {"<": MAKE_CODES["102ND"]}
_US: Final = {**char_codes("us"), **_ITS_OWN}
#: Numbers in a sequence are no longer than this.
_DIGITS: Final = 7
_LAST_CHAR: Final = 0x10FFFF

#: A terminal without releases typed it; or it went down, repeats, came up.
Phase = Literal["typed", "press", "repeat", "release"]
_PHASES: Final[dict[int, Phase]] = {1: "press", 2: "repeat", 3: "release"}


class Key(NamedTuple):
    """A key that went down.

    Attributes:
        code: its make code; 0: a character that lies nowhere on this keyboard.
        text: what it means to a program: a character; for others NUL and the make code, as DOS;
            nothing for keys that only change what others mean.
    """

    code: int
    text: str


class Stroke(NamedTuple):
    """What happened to a key."""

    key: Key
    phase: Phase


class Decoder:
    """Makes keys of bytes.

    Args:
        layout: "us" or "de": where the characters lie.

    Attributes:
        tells_releases: the terminal was told to speak kitty's protocol.
        reports: what came that was no key: answers of the terminal, change of focus.
    """

    def __init__(self, layout: str) -> None:
        self._layout = layout
        self._codes = char_codes(layout)
        self._utf8 = codecs.getincrementaldecoder("utf-8")("replace")
        self._pending = ""
        self._since_ns = 0
        self.tells_releases = False
        self.reports: list[str] = []

    def take(self, data: bytes, now_ns: int) -> list[Key]:
        """The keys that went down, of these bytes and of what came before and is now whole.

        Args:
            data: what the terminal has sent; may be nothing.
            now_ns: when.
        """
        return [stroke.key for stroke in self.strokes(data, now_ns) if stroke.phase != "release"]

    def strokes(self, data: bytes, now_ns: int) -> list[Stroke]:
        """The same, with what happened to the keys."""
        if data:
            self._pending += self._utf8.decode(data)
            self._since_ns = now_ns
        is_old = now_ns - self._since_ns >= _TOGETHER_NS
        strokes = []
        while self._pending:
            found = _WHOLE.match(self._pending)
            if not found and self._may_grow(is_old):
                break
            text = found.group() if found else self._pending[0]
            self._pending = self._pending[len(text) :]
            stroke = self._sequence(text) if found else Stroke(self._char(text), "typed")
            if stroke:
                strokes.append(stroke)
        return strokes

    def rest(self) -> list[Key]:
        """Nothing more belongs to what has come so far."""
        return self.take(b"", self._since_ns + _TOGETHER_NS)

    def anew(self) -> "Decoder":
        """Another one, that has heard nothing yet."""
        return Decoder(self._layout)

    def _may_grow(self, is_old: bool) -> bool:
        """More may belong to it. In kitty's protocol no key sends ESC and a bracket."""
        wait = not is_old or (self.tells_releases and self._pending != ESC)
        return wait and _PART.match(self._pending) is not None

    def _char(self, char: str) -> Key:
        return Key(self._codes.get(char, 0), char)

    def _sequence(self, text: str) -> Stroke | None:
        parts = _CSI.fullmatch(text)
        if not parts:
            return _named(_MODIFIERS.sub("", text[1:]), "typed")
        private, parameters, between, final = parts.groups()
        if private or between or final in "IO":
            self.reports.append(text)
            return None
        fields = [field.split(":") for field in parameters.split(";")]
        number, modifiers = _number(fields, 0, 0, 1), _number(fields, 1, 0, 1) - 1
        phase = _PHASES.get(_number(fields, 1, 1, 1))
        if phase == "press" and not self.tells_releases and not _has(fields, 1, 1):
            phase = "typed"
        if not phase:
            return None
        if final != "u":
            return _named(f"[{number}~" if final == "~" else f"[{final}", phase)
        key = self._kitty_key(fields, number, modifiers)
        return Stroke(key, phase) if key else None

    def _kitty_key(self, fields: list[list[str]], number: int, modifiers: int) -> Key | None:
        code = KITTY_CODES.get(number)
        meant = "".join(map(_char_of, map(_int, fields[2]))) if _has(fields, 2, 0) else ""
        if code is not None:
            return Key(code, meant or ("" if code in SILENT_CODES else f"\0{chr(code)}"))
        char, place = _char_of(number), _char_of(_number(fields, 0, 2, 0))
        if not char:
            return None
        code = _US.get(place) or _ITS_OWN.get(char) or self._codes.get(char, 0)
        if modifiers & _CTRL and not modifiers & (_SHIFT | _ALT | _OTHERS):
            latin = place or char
            meant = chr(ord(latin) & 0x1F) if "@" <= latin <= "~" else ""
        elif not meant and not modifiers & (_CTRL | _OTHERS):
            shifted = _char_of(_number(fields, 0, 1, 0)) or char.upper()
            meant = (shifted if modifiers & _SHIFT else char).replace("\r", "\n")
        return Key(code, meant)


def _named(sequence: str, phase: Phase) -> Stroke | None:
    code = SEQUENCES.get(sequence)
    return Stroke(Key(code, f"\0{chr(code)}"), phase) if code else None


def _has(fields: list[list[str]], field: int, part: int) -> bool:
    return field < len(fields) and part < len(fields[field]) and bool(fields[field][part])


def _number(fields: list[list[str]], field: int, part: int, default: int) -> int:
    return _int(fields[field][part]) if _has(fields, field, part) else default


def _int(digits: str) -> int:
    return int(digits[:_DIGITS] or 0)


def _char_of(number: int) -> str:
    return chr(number) if 0 < number <= _LAST_CHAR else ""


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
        return [down | BREAK] if down else []


class Held:
    """Which keys are down: by what the terminal tells, and by guessing where it does not."""

    def __init__(self) -> None:
        self.guess = Holding()
        self._down: set[int] = set()

    def codes(self, stroke: Stroke, now_ns: int) -> list[int]:
        """Scan codes of a stroke."""
        code = stroke.key.code
        if not code:
            return []
        if stroke.phase == "typed":
            return self.guess.press(code, now_ns)
        if code == self.guess.down:
            # From here on it is told.
            self.guess.release()
        if stroke.phase == "release":
            self._down.discard(code)
            return [code | BREAK]
        self._down.add(code)
        return [code]

    def all_up(self) -> list[int]:
        """Nobody will tell any more when they come up: break codes of all that are down."""
        down, self._down = sorted(self._down), set()
        return [*(code | BREAK for code in down), *self.guess.release()]

    def forget(self) -> None:
        """What was told holds no longer; what was guessed does."""
        self._down.clear()
