"""One line of text to one block: its words, codes, comment and parameter settings.

There is one parser. ``_WORDS`` cuts a line into plain words (a letter and a number) and, at
the first thing that is anything else, the whole rest of the line; the rest's first item is
then read character by character and the cutting starts anew behind it. So a plain line
costs one pass of a compiled expression, and an involved one costs what it has to.
"""

import re
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode import modal
from fraese.gcode.axes import ALL, Axes
from fraese.gcode.expressions import Reader, number
from fraese.gcode.modal import AXIS_USERS, CYCLES, HOMES, M_OFFSET, SAME, STRAIGHT, WORD_USERS
from fraese.gcode.parameters import Parameters
from fraese.phrases import phrase

_WORDS = re.compile(r"([a-z])([-+]?[0-9.]{1,40}(?![0-9.]))|(.+)", re.DOTALL)
_LINE_NUMBER = re.compile(r"n[0-9]+(?:\.[0-9]*)?")
# The other spelling of an O-number that stands alone.
_COLON: Final = re.compile(r":(?=[0-9]+\(?$)")
# Stands for a comment inside a line, so that what it divides is not joined.
_MARK: Final = "("

_PARAMETER: Final = phrase("the parameter")

AXES: Final = ALL | frozenset("@^")
OFFSETS: Final = frozenset("ijk")
# Letters of words that are no axes.
ROTARY: Final = frozenset("abc")
LETTERS: Final = frozenset("dfhijklpqrst@^$")
# What is done once a line says it: two of them on one line may mean two things.
_ONCE: Final = frozenset({"nonmodal", "stop", "tool_change", "state", "user"})
# G50 ends scaling, which is never on; with these it means something else.
_SCALING: Final = AXES | {"s"}
# With these G70 and G71 are no units.
_LATHE: Final = frozenset("pq")
# Words that any block may have; all others need a code that uses them.
PLAIN: Final = AXES | frozenset("fst")


class Block:
    """A line that has been read, every expression in it already evaluated."""

    __slots__ = ("absent", "assignments", "codes", "comment", "has_axes", "motion", "words")

    def __init__(self) -> None:
        self.words: dict[str, float] = {}
        # group -> code, for all groups but the motions
        self.codes: dict[str, int] = {}
        # the motion code on this line, or the one in force where the line needs one
        self.motion: int | None = None
        self.has_axes = False
        self.comment = ""
        # rotary axes that the machine has not and that are told to be at zero
        self.absent = ""
        self.assignments: list[tuple[int | str, float]] = []


def strip_comments(text: str) -> tuple[str, str]:
    """Text with every comment replaced by a mark, and the last bracketed comment.

    Raises:
        ProgramError: a comment is not closed, or holds another.
    """
    kept: list[str] = []
    comment = ""
    at = 0
    while True:
        opening = text.find("(", at)
        semicolon = text.find(";", at)
        if semicolon >= 0 and (opening < 0 or semicolon < opening):
            return "".join((*kept, text[at:semicolon])), comment
        if opening < 0:
            return "".join((*kept, text[at:])), comment
        closing = text.find(")", opening)
        if closing < 0:
            raise ProgramError(phrase("the comment is not closed: ')' is missing"))
        comment = text[opening + 1 : closing]
        if "(" in comment:
            raise ProgramError(phrase("a comment must not hold another '('"))
        kept += (text[at:opening], _MARK)
        at = closing + 1


def squeeze(text: str) -> str:
    """Lower case, without blanks."""
    return "".join(text.lower().split())


def plain(text: str) -> str:
    """A line as the parser wants it: no block delete, no line number, comments marked.

    Raises:
        ProgramError: a comment or the line number is malformed.
    """
    if "(" in text or ";" in text:
        text = strip_comments(text)[0]
    return strip_line_number(squeeze(text).removeprefix("/"))


def strip_line_number(text: str) -> str:
    """Squeezed text without its leading N word.

    Raises:
        ProgramError: N is not followed by a number.
    """
    if text.startswith("n"):
        match = _LINE_NUMBER.match(text)
        if match is None:
            raise ProgramError(phrase("N has to be followed by a line number"))
        text = text[match.end() :]
    return _COLON.sub("o", text) if text.startswith(":") else text


class BlockReader:
    """Reads blocks; keeps the parameters, a memory of spellings of codes, and knows the axes."""

    def __init__(self, parameters: Parameters, axes: Axes) -> None:
        self._parameters = parameters
        self._axes = axes
        self._letters = LETTERS | frozenset(axes.letters)
        self._g_codes: dict[str, tuple[int, str]] = {}

    def read(self, text: str, comment: str = "") -> Block:
        """Read squeezed text that has neither block delete nor line number.

        Raises:
            ProgramError: the text is not a line of G-code.
        """
        block = Block()
        block.comment = comment
        words = block.words
        letters = self._letters
        while text:
            rest = ""
            for letter, digits, rest in _WORDS.findall(text):  # noqa: B007 rest is used below
                if letter == "g":
                    self._add_g(block, digits)
                elif letter in letters and letter not in words:
                    try:
                        words[letter] = float(digits)
                    except ValueError:
                        raise ProgramError(
                            phrase("{digits} is not a number", digits=repr(digits))
                        ) from None
                elif letter:
                    self._add_word(block, letter, number(digits))
            text = self._item(block, rest) if rest else ""
        for key, value in block.assignments:
            self._assign(key, value)
        return block

    def _add_g(self, block: Block, digits: str) -> None:
        known = self._g_codes.get(digits)
        if known is None:
            code = modal.g_code(number(digits))
            known = (code, modal.G_GROUP[code])
            if len(digits) <= 4:
                self._g_codes[digits] = known
        self._add_code(block, *known)

    def _add_code(self, block: Block, code: int, group: str) -> None:
        if group == "motion":
            before = block.motion
            # Behind a place the same code again may mean a second move.
            if before is not None and (before != code or not AXES.isdisjoint(block.words)):
                raise ProgramError(_conflict(modal.name(before), modal.name(code)))
            block.motion = code
            return
        before = block.codes.get(group)
        if before is not None and not _agree(before, code, group):
            raise ProgramError(_conflict(modal.name(before), modal.name(code)))
        block.codes[group] = code

    def _add_m(self, block: Block, value: float) -> None:
        code = modal.m_code(value)
        group = modal.M_GROUP.get(code, "user")
        before = block.codes.get(group)
        if before is not None and not _agree(before, code + M_OFFSET, group):
            raise ProgramError(_conflict(f"M{before - M_OFFSET}", f"M{code}"))
        block.codes[group] = code + M_OFFSET

    def _add_word(self, block: Block, letter: str, value: float) -> None:
        if letter == "g":
            code = modal.g_code(value)
            self._add_code(block, code, modal.G_GROUP[code])
        elif letter == "m":
            self._add_m(block, value)
        elif letter in block.words:
            raise ProgramError(
                phrase("there are two {letter} words on one line", letter=letter.upper())
            )
        elif letter in self._letters:
            block.words[letter] = value
        elif letter in ROTARY and value == 0:
            # It stands where it always stands.
            block.absent += letter
        elif letter in ALL:
            self._axes.require(letter)
        else:
            raise ProgramError(phrase("{letter} cannot be used here", letter=repr(letter.upper())))

    def _item(self, block: Block, text: str) -> str:
        """Read the first item of ``text`` whatever it is; returns what follows it."""
        first = text[0]
        if first == _MARK:
            return text[1:]
        reader = Reader(text, self._parameters, 1)
        if first == "#":
            reader.at = 0
            key = reader.parameter_key()
            reader.take("=", _PARAMETER)
            block.assignments.append((key, reader.value()))
        elif first.isascii() and (first.isalpha() or first in "@^$"):
            self._add_word(block, first, reader.value())
        else:
            raise ProgramError(phrase("{first} cannot be used here", first=repr(first)))
        return reader.rest()

    def _assign(self, key: int | str, value: float) -> None:
        if isinstance(key, int):
            self._parameters.set(key, value)
        else:
            self._parameters.set_name(key, value)


def _agree(one: int, other: int, group: str) -> bool:
    """Whether two codes of a group on one line say the same."""
    return group not in _ONCE and SAME.get(one, one) == SAME.get(other, other)


def _conflict(one: str, other: str) -> str:
    if one == other:
        return phrase("{one} is given twice on one line", one=one)
    return phrase(
        "{one} and {other} contradict each other on one line; use two lines", one=one, other=other
    )


def complete(block: Block, motion: int | None) -> None:
    """Find the motion that the block asks for, and check that every word has a user.

    Args:
        block: the block as read; its ``motion`` and ``has_axes`` are set here.
        motion: modal motion code in force, None after G80.

    Raises:
        ProgramError: codes contradict each other, or a word has no code that uses it.
    """
    words = block.words
    codes = block.codes
    has_axes = block.has_axes = not AXES.isdisjoint(words)
    if codes:
        _check_codes(block)
        has_axes = _shared_axes(block)
    if block.motion is None and "cancel" not in codes:
        # The centre alone is enough to go round a full circle once more.
        circle = motion in modal.ARCS and not OFFSETS.isdisjoint(words)
        if has_axes or circle:
            if motion is None:
                raise ProgramError(
                    phrase("axis words need a motion code such as G0 or G1 in force")
                )
            block.motion = motion
    if not PLAIN.issuperset(words):
        _check_words(block)


def _check_codes(block: Block) -> None:
    """Codes that are taken as what they most often mean, on a line that means something else."""
    codes, given = block.codes, block.words
    if block.absent and codes.get("nonmodal") in AXIS_USERS and not block.has_axes:
        raise ProgramError(
            phrase(
                "{modal} with {absent} alone has nothing to do on this machine, which has no"
                " such axis",
                modal=modal.name(codes["nonmodal"]),
                absent=block.absent[0].upper(),
            )
        )
    if codes.get("units") in SAME and not _LATHE.isdisjoint(given):
        raise ProgramError(
            phrase(
                "{modal} is refused: with P or Q it is a lathe's cycle; alone it is the"
                " unit, inch (G70) or mm (G71)",
                modal=modal.name(codes["units"]),
            )
        )
    if "no G50" in codes and not _SCALING.isdisjoint(given) and block.motion is None:
        raise ProgramError(phrase("G50 ends scaling here and takes no words; G92 sets coordinates"))


def _shared_axes(block: Block) -> bool:
    """Whether axis words are there and left for the motion."""
    codes = block.codes
    users = [code for code in codes.values() if code in AXIS_USERS]
    if block.motion in STRAIGHT and codes.get("nonmodal") in HOMES:
        # The words are of the way home; the motion is only put into force.
        return False
    # A tool offset by axis words shares them with the motion; what is non-modal does not.
    if block.motion is not None:
        users = [code for code in users if code != 431]
    if users and block.motion is not None:
        codes_said = phrase(
            "{modal} and {modal_2}", modal=modal.name(users[0]), modal_2=modal.name(block.motion)
        )
        raise ProgramError(
            phrase("{codes_said} both use axis words; use two lines", codes_said=codes_said)
        )
    if "cancel" in codes:
        if block.has_axes and not users and block.motion is None:
            raise ProgramError(phrase("G80 takes no axis words"))
        return False
    return block.has_axes and not users


def _check_words(block: Block) -> None:
    present = {code for code in (*block.codes.values(), block.motion) if code is not None}
    for letter in block.words:
        users = WORD_USERS.get(letter)
        if users is not None and users[0].isdisjoint(present):
            raise ProgramError(
                phrase(
                    "the {letter} word needs {users} on its line",
                    letter=letter.upper(),
                    users=users[1],
                )
            )
    count = block.words.get("l")
    if count is not None and block.motion in CYCLES and count < 1:
        raise ProgramError(phrase("a canned cycle cannot be repeated less than once"))
