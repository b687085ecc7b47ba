"""What whoever stands at the machine is told and asked of a program's moves."""

from collections.abc import Iterable
from textwrap import shorten
from typing import Final

from fraese.gcode import canon
from fraese.phrases import Phrase, joined, phrase

#: A dialog has room for so many letters of a remark.
_REMARK: Final = 80
_DIRECTIONS: Final = {1: phrase("clockwise"), -1: phrase("counter-clockwise")}
_COOLANTS: Final = {"mist": phrase("mist"), "flood": phrase("flood")}


def stop_question(move: canon.Pause) -> Phrase:
    """What M0 and M1 ask."""
    return phrase("Program stop in line {line}: go on?", line=_place(move))


def tool_question(move: canon.Tool) -> Phrase:
    """What M6 asks."""
    return phrase(
        "Tool change in line {line}: put in tool {number}.", line=_place(move), number=move.number
    )


def _place(move: canon.Pause | canon.Tool) -> str:
    """Its line, with what the program says there."""
    remark = shorten(move.remark, _REMARK, placeholder=" …")
    return f"{move.line} ({remark})" if remark else f"{move.line}"


def spindle_in_words(move: canon.Spindle) -> Phrase:
    """What becomes of the spindle."""
    if not move.is_on:
        return phrase("Spindle off, S0") if move.direction else phrase("Spindle off")
    directions = _DIRECTIONS[move.direction]
    if not move.has_speed:
        return phrase("Spindle on, {directions}", directions=directions)
    return phrase(
        "Spindle on, {directions}, {rev_min:g} rev/min",
        directions=directions,
        rev_min=move.rev_min,
    )


def coolant_in_words(move: canon.Coolant) -> Phrase:
    """What becomes of the coolants."""
    kinds = [word for name, word in _COOLANTS.items() if getattr(move, name)]
    state = phrase("{kinds} on", kinds=joined(phrase(" and "), kinds)) if kinds else phrase("off")
    return phrase("coolant {state}", state=state)


def by_hand(move: canon.Move, text: Phrase) -> Phrase:
    """That somebody else has to switch it."""
    return phrase("Line {line}: {text} (switched by hand).", line=move.line, text=text)


def behind_probe(axes: Iterable[str]) -> Phrase:
    """What a look-through cannot know of these axes."""
    return phrase(
        "where the probe touches is not known: behind it {axes} is judged as it comes, and its"
        " bounds are those of a probe that goes all the way",
        axes=" ".join(axes).upper(),
    )
