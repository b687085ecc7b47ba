"""What a line is, before anybody reads it: to whom it goes, and whether it may be given to him."""

import re
from enum import Enum
from typing import Final

from fraese.phrases import phrase

_REMARKS: Final = re.compile(r"\([^()]*\)|;.*")
_LOOKS_AHEAD: Final = re.compile(r"(?:n[0-9.]+)?(?:o|.*m9[89](?![0-9]))", re.IGNORECASE)
_SAYS: Final = re.compile(r"\(\s*(?:msg|debug|print|abort)", re.IGNORECASE)
_BESIDE: Final = re.compile(r"g4[12](?![0-9])", re.IGNORECASE)


class Kind(Enum):
    """Who a line is for."""

    EMPTY = "nothing is left without its remarks"
    CODE = "a line of G-code"
    JOG = "a jog"
    SYSTEM = "another command of grbl's own"


def bare(text: str) -> str:
    """A line without blanks and remarks."""
    return "".join(_REMARKS.sub("", text).split())


def kind_of(text: str) -> Kind:
    """What a line is; one that marks the ends of a tape is nothing."""
    if text.lstrip().startswith("$"):
        return Kind.JOG if bare(text)[:3].upper() == "$J=" else Kind.SYSTEM
    said = bare(text)
    return Kind.EMPTY if said in ("", "%") and not _SAYS.search(text) else Kind.CODE


def why_not(text: str) -> str:
    """Why a line cannot be one of a stream, a sentence; empty: it can."""
    said = bare(text)
    if _LOOKS_AHEAD.match(said):
        return phrase(
            "O-words, M98 and M99 need the whole program: run it from its file (fraese run)."
        )
    if _BESIDE.search(said):
        return phrase(
            "Cutter compensation (G41, G42) needs the lines to come: run it from its file"
            " (fraese run)."
        )
    return ""
