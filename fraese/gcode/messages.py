"""Comments that speak: (MSG, ...), (DEBUG, ...) and (PRINT, ...), and (ABORT, ...).

ABORT ends the program with its text as the reason. All but MSG put in parameters: ``#5`` and
``#<name>`` become their value with six decimals, or in the format that an earlier ``%d``,
``%f`` (four decimals) or ``%.3f`` asks for. Any other comment is silent, including those
that write or open log files.
"""

import re
from typing import Final, Literal

from fraese.errors import ProgramError
from fraese.gcode.canon import Message
from fraese.gcode.parameters import Parameters
from fraese.phrases import phrase

Kind = Literal["msg", "debug", "print"]
# 0 in this parameter silences DEBUG.
DEBUG_SWITCH: Final = 5599
UNKNOWN: Final = "######"

_ACTIVE = re.compile(
    r"\s*(m\s*s\s*g|d\s*e\s*b\s*u\s*g|p\s*r\s*i\s*n\s*t)\s*,(.*)", re.I | re.DOTALL
)
_ABORT = re.compile(r"\s*abort,(.*)", re.I | re.DOTALL)
_PARTS = re.compile(r"%(d|f|\.[0-9]f)|#(?:<([^<>]+)>|([0-9]{1,9}))")
_COMMENTS = re.compile(r"\(([^)]*)\)|;(.*)")
#: Words of the language in comments, all but MSG.
_COMMANDS = re.compile(
    r"\s*(debug|print|abort|log|logopen|logappend|probeopen)\s*,|\s*(log|probe)close", re.I
)
_FORMATS: Final = {"d": ".0f", "f": ".4f"}


class Notes:
    """What the interpreter itself tells of a program, each sentence once."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def once(self, line: int, text: str) -> tuple[Message, ...]:
        """A message, or none where it was said already."""
        if text in self._said:
            return ()
        self._said.add(text)
        return (Message(line, text, "note"),)


def read(comment: str, parameters: Parameters) -> tuple[Kind, str] | None:
    """Kind and text of a comment that speaks, None for any other.

    Raises:
        ProgramError: it aborts the program.
    """
    abort = _ABORT.match(comment)
    if abort is not None:
        raise ProgramError(
            phrase(
                "the program aborts itself: {filled}", filled=_filled(abort[1], parameters).strip()
            )
        )
    match = _ACTIVE.match(comment)
    if match is None:
        return None
    kind = "".join(match.group(1).lower().split())
    text = match.group(2)
    if kind == "msg":
        return "msg", text
    if kind == "print":
        return "print", _filled(text, parameters)
    return ("debug", _filled(text, parameters)) if parameters.get(DEBUG_SWITCH) else None


def remark(text: str) -> str:
    """What the comments of a line say to whoever stands at the machine; empty: nothing."""
    comments = map("".join, _COMMENTS.findall(text))
    said = (_ACTIVE.sub(r"\2", each).strip() for each in comments if not _COMMANDS.match(each))
    return ", ".join(filter(None, said))


def _filled(text: str, parameters: Parameters) -> str:
    style = ".6f"

    def part(match: re.Match[str]) -> str:
        nonlocal style
        asked, name, index = match.groups()
        if asked:
            style = _FORMATS.get(asked, asked)
            return ""
        value = _value(name, index, parameters)
        return UNKNOWN if value is None else format(value, style)

    return _PARTS.sub(part, text)


def _value(name: str | None, index: str | None, parameters: Parameters) -> float | None:
    if name is not None:
        return parameters.find("".join(name.lower().split()))
    try:
        return parameters.get(int(index or 0))
    except ProgramError:
        return None
