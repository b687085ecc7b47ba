"""``$J=``: a straight way at a feed, as one line that leaves everything in force as it was.

Rule 1: lengths are in the unit and from the place that are in force, unless the line says others.
        G53 is from machine zero.
Rule 2: what leaves the travel is refused, and nothing moves.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from fraese.control.controller import Controller
from fraese.control.softlimits import require_reachable, to_steps
from fraese.errors import LimitError
from fraese.gcode.axes import Axes
from fraese.gcode.canon import Breath, Feed, Overrides
from fraese.gcode.modal import Modal
from fraese.phrases import phrase
from fraese.program.context import ProgramContext
from fraese.program.stream import NOT_YET, Stream
from fraese.program.translate import Moves
from fraese.serve.codes import Code
from fraese.serve.feeder import Feeder
from fraese.serve.kinds import bare
from fraese.workframe import Point

_WORD: Final = re.compile(r"([a-z])([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))", re.IGNORECASE)
_INCH_MM: Final = 25.4
#: What a jog may say, by its number in tenths, and what that means.
_SAYS: Final[Mapping[int, tuple[str, object]]] = {
    200: ("scale_mm", _INCH_MM),
    210: ("scale_mm", 1.0),
    900: ("absolute", True),
    910: ("absolute", False),
    530: ("of_machine", True),
}


class JogRefused(Exception):
    """A jog is refused.

    Args:
        code: by which number.
        said: why, a sentence; empty: the number says it.
    """

    def __init__(self, code: Code, said: str = "") -> None:
        super().__init__(said)
        self.code = code
        self.said = said


@dataclass
class _Words:
    """What a line says."""

    scale_mm: float
    absolute: bool
    of_machine: bool
    feed: float | None
    places: dict[str, float]


def jog_move(text: str, controller: Controller, modal: Modal, from_mm: Point) -> Feed:
    """The move that a line asks for.

    Args:
        text: the whole line.
        controller: the machine.
        modal: what is in force.
        from_mm: where the jogs before it end, machine coordinates.

    Raises:
        JogRefused: it does not say what a jog has to, or would leave the travel.
    """
    words = _read(bare(text)[3:], controller, modal)
    if not words.places:
        raise JogRefused(Code.NO_AXIS)
    if words.feed is None or words.feed <= 0:
        raise JogRefused(Code.NO_FEED)
    frame, machine = controller.position.frame, controller.machine
    axes = Axes("".join(machine.names), "".join(a.name for a in machine.axes if a.kind == "rotary"))
    start = from_mm if words.of_machine else frame.to_work(from_mm)
    is_absolute = words.absolute or words.of_machine
    reached = axes.reached(
        start if is_absolute else (0.0,) * len(start), words.places, words.scale_mm
    )
    to = reached if is_absolute else tuple(a + b for a, b in zip(start, reached, strict=True))
    to_mm = to if words.of_machine else frame.to_machine(to)
    try:
        require_reachable(controller.position, [to_steps(machine, to_mm)])
    except LimitError as error:
        raise JogRefused(Code.TRAVEL, str(error)) from error
    return Feed(0, to_mm, words.feed * words.scale_mm)


def _read(text: str, controller: Controller, modal: Modal) -> _Words:
    words = _Words(modal.scale_mm, modal.absolute, of_machine=False, feed=None, places={})
    at = 0
    for found in _WORD.finditer(text):
        if found.start() != at:
            break
        at = found.end()
        _take(words, found[1].lower(), float(found[2]), controller)
    if at != len(text):
        raise JogRefused(Code.LETTER if text[at].isdigit() else Code.NUMBER)
    return words


def _take(words: _Words, letter: str, value: float, controller: Controller) -> None:
    if letter == "g":
        field, meaning = _SAYS.get(round(value * 10), ("", None))
        if not field:
            raise JogRefused(Code.JOG)
        setattr(words, field, meaning)
    elif letter == "f":
        words.feed = value
    elif letter in controller.machine.names:
        if letter in words.places:
            raise JogRefused(Code.REPEATED)
        words.places[letter] = value
    elif letter in "xyzabcuvw":
        raise JogRefused(
            Code.UNSUPPORTED,
            phrase("there is no axis {letter} on this machine", letter=letter.upper()),
        )
    elif letter != "n":
        raise JogRefused(Code.JOG)


def jogs(context: ProgramContext, controller: Controller, stream: Stream, feeder: Feeder) -> Moves:
    """Moves of the jogs that come, one behind the other; an override of feeds leaves them alone."""
    yield Overrides(0, False)
    at_mm = context.start_mm
    while True:
        text = feeder.next()
        if text is NOT_YET:
            if feeder.is_over() and stream.at_rest:
                return
            yield Breath(0)
            continue
        try:
            move = jog_move(text, controller, stream.modal, at_mm)
        except JogRefused as refused:
            feeder.close(refused.code, refused.said)
            continue
        at_mm = move.to
        feeder.leads_to(move)
        yield move
