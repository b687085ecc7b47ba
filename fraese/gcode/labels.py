"""What a line with an O-word says: its name, its keyword, and what stands behind."""

import re
from typing import Final, NamedTuple

from fraese.errors import ProgramError
from fraese.gcode.expressions import Reader, whole
from fraese.gcode.parameters import Parameters
from fraese.gcode.subroutines import PROGRAM_NUMBER
from fraese.gcode.words import plain
from fraese.phrases import phrase

# A line that calls a numbered subprogram or ends it.
SUBPROGRAM: Final = re.compile(r"m9[89](?![0-9.])")
# Longer ones first where one starts like another.
_KEYWORD = re.compile(
    r"sub|endsub|call|return|if|elseif|else|endif|endwhile|while|do|endrepeat|repeat"
    r"|break|continue"
)


class OWord(NamedTuple):
    """An O-word line: its name, what to do, and the text behind."""

    name: str
    keyword: str
    rest: str


class LabelReader:
    """Reads O-words; expressions are made out with the parameters."""

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters

    def read(self, text: str) -> OWord:
        """The O-word on a plain line that starts with O, or the M98 or M99 that it starts with.

        Raises:
            ProgramError: it is none.
        """
        if text[0] == "m":
            return OWord("", text[:3], text[3:].replace("(", ""))
        reader = Reader(text, self._parameters, 1)
        if reader.peek() == "<":
            name = reader.name()
        else:
            name = str(whole(reader.value(), phrase("the number of an O-word")))
        if not reader.rest().strip("("):
            return OWord(name, PROGRAM_NUMBER, "")
        match = _KEYWORD.match(text, reader.at)
        if match is None:
            raise ProgramError(
                phrase("o<{name}> needs a known word behind it, such as sub, call or if", name=name)
            )
        return OWord(name, match.group(), text[match.end() :].rstrip("("))

    def expressions(self, word: OWord) -> list[float]:
        """Values of the expressions behind the keyword.

        Raises:
            ProgramError: something else stands there.
        """
        reader = Reader(word.rest, self._parameters)
        values = []
        # In a call comments may stand in between; all that is left of one is its bracket.
        starts = "[(" if word.keyword == "call" else "["
        while (first := reader.peek()) and first in starts:
            if first == "(":
                reader.at += 1
            else:
                values.append(reader.expression())
        if reader.peek():
            raise ProgramError(
                phrase(
                    "{rest} cannot stand behind o<{name}> {keyword}",
                    rest=repr(reader.rest()[:8]),
                    name=word.name,
                    keyword=word.keyword,
                )
            )
        return values

    def number(self, word: OWord) -> float:
        """The one expression that has to stand there.

        Raises:
            ProgramError: it does not.
        """
        values = self.expressions(word)
        if len(values) != 1:
            raise ProgramError(
                phrase("{keyword} needs one expression in square brackets", keyword=word.keyword)
            )
        return values[0]

    def condition(self, word: OWord) -> bool:
        """Whether it is true."""
        return self.number(word) != 0

    def passed(self, text: str) -> OWord | None:
        """The O-word on a line that is only passed over: what is wrong with it is no matter."""
        if "o" not in text and "O" not in text and ":" not in text:
            return None
        try:
            text = plain(text)
            return self.read(text) if text.startswith("o") else None
        except ProgramError:
            return None

    def label(self, text: str) -> tuple[str, str] | None:
        """Name and keyword of the O-word on a line that is only passed over."""
        found = self.passed(text)
        return None if found is None else (found.name, found.keyword)
