"""What a start in the middle will do, said before anything moves.

Rule 1: what is said is what the start does: both read the same ``Beginning``.
Rule 2: reading may take long, and gives turns: whoever waits can give it up at each.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from fraese.control.state import WorkFacts
from fraese.errors import Cancelled
from fraese.gcode import canon
from fraese.machine import Machine, Millimetres
from fraese.phrases import joined, phrase
from fraese.program.numbers import Numbers
from fraese.program.runfromline import Beginning
from fraese.program.source import ProgramSource


class Leg(NamedTuple):
    """One thing that is done on the way.

    Attributes:
        words: what it is; of a move with the place in machine coordinates.
        work: the same place in work coordinates; empty: they are no others.
        is_move: the machine moves.
    """

    words: str
    work: str = ""
    is_move: bool = False


@dataclass(frozen=True, slots=True)
class Way:
    """The way to a place in a program.

    Attributes:
        line: of the move that comes first,
        text: and what stands there.
        legs: what is done on the way: tools, outputs, moves.
        height: at which it goes over, with its axis; empty: nothing lifts the tool.
        in_force: what is in force at the place.
        called_in: the program's line that called it; 0: it was not called.
    """

    line: int
    text: str
    legs: tuple[Leg, ...]
    height: str
    in_force: str
    called_in: int = 0

    def lines(self, name: str) -> list[str]:
        """All of it, for a program of this name."""
        legs = ["  " + joined(", ", filter(None, leg[:2])) for leg in self.legs]
        head = (
            phrase(
                "{name} from line {line}, called in line {called_in}:",
                name=name,
                line=self.line,
                called_in=self.called_in,
            )
            if self.called_in
            else phrase("{name} from line {line}:", name=name, line=self.line)
        )
        return [
            head,
            *legs,
            phrase("  then the program, with {in_force}", in_force=self.in_force),
        ]


def way_of(begun: Beginning, given_up: Callable[[], bool] = lambda: False) -> Way:
    """What a start would do.

    Args:
        begun: how the program is begun.
        given_up: asked at every turn whether nobody wants to know any more.

    Raises:
        ProgramError: if there is nothing to run there, or a line before it is refused.
        Cancelled: if it was given up.
    """
    source, numbers, now = begun.source, Numbers(), begun.now
    legs: list[Leg] = []
    here, line, goes_down = now.start_mm, 1, False
    for move in begun.moves(numbers):
        line = move.line
        is_over = not numbers.is_on_a_way
        if is_over and goes_down:
            break
        if isinstance(move, canon.Breath):
            if given_up():
                raise Cancelled(phrase("Given up; nothing has moved."))
            continue
        if isinstance(move, canon.Offsets):
            continue
        if isinstance(move, canon.Along):
            move = _straight(move)
        goes_down = goes_down or isinstance(move, canon.Feed)
        if isinstance(move, canon.Rapid | canon.Feed) and move.to == here and not is_over:
            # The machine stands there already.
            continue
        legs.append(_leg(move, here, source, now.machine))
        if isinstance(move, canon.Rapid | canon.Feed):
            here = move.to
        if isinstance(move, canon.Spindle) and not is_over:
            legs += _run_up(begun, move)
        if is_over:
            break
    height, in_force = _height(begun), _in_force(source)
    return Way(line, source.text, tuple(legs), height, in_force, source.called_in)


def _straight(move: canon.Along) -> canon.Rapid | canon.Feed:
    """Of a bent move it is told where it leads."""
    if move.feed_mm_min is None:
        return canon.Rapid(move.line, move.to)
    return canon.Feed(move.line, move.to, move.feed_mm_min)


def _leg(move: canon.Move, here: Millimetres, source: ProgramSource, machine: Machine) -> Leg:
    """A move on that way; its feed counts along mm or degrees."""
    if isinstance(move, canon.Rapid | canon.Feed | canon.Arc | canon.Probe):
        unit = "°" if source.axes.way(here, move.to).is_angle else "mm"
        how = (
            "rapid"
            if isinstance(move, canon.Rapid)
            else phrase("feed {feed_mm_min:g} {unit}/min", feed_mm_min=move.feed_mm_min, unit=unit)
        )
        if isinstance(move, canon.Arc | canon.Probe):
            what = phrase("arc") if isinstance(move, canon.Arc) else phrase("probe")
            how = joined(", ", (what, how))
        place, work = machine.in_words(move.to), machine.in_words(source.frame.to_work(move.to))
        also = phrase("{work} (work)", work=work) if work != place else ""
        return Leg(phrase("{how} to {place} (machine)", how=how, place=place), also, is_move=True)
    return Leg(_switched(move))


def _switched(move: canon.Move) -> str:
    """What moves nothing."""
    if isinstance(move, canon.Spindle):
        word = phrase("on") if move.is_on else phrase("off")
        if not move.has_speed:
            return phrase("spindle {word}", word=word)
        return phrase("spindle {word}, {rev_min:g} rev/min", word=word, rev_min=move.rev_min)
    if isinstance(move, canon.Coolant):
        return phrase(
            "coolant {word}", word=phrase("on") if move.mist or move.flood else phrase("off")
        )
    if isinstance(move, canon.Tool):
        return phrase("tool {number}", number=move.number)
    if isinstance(move, canon.PathControl):
        return phrase("corners as with {value}", value=move.mode.value)
    if isinstance(move, canon.Overrides):
        word = phrase("on") if move.enabled else phrase("off")
        return phrase("overrides {word}", word=word)
    if isinstance(move, canon.Message):
        return phrase("line {line}: {text}", line=move.line, text=move.text)
    if isinstance(move, canon.Dwell):
        return phrase("wait {duration_s:g} s", duration_s=move.duration_s)
    return phrase("a stop") if isinstance(move, canon.Pause) else type(move).__name__.lower()


def _run_up(begun: Beginning, move: canon.Spindle) -> list[Leg]:
    """How long it is waited for."""
    config = begun.now.config
    waits = move.is_on and config.outputs.mask("spindle") and not begun.now.has_laser
    spin_up_s = config.run.spin_up_s
    return (
        [Leg(phrase("wait {spin_up_s:g} s for it", spin_up_s=spin_up_s))]
        if waits and spin_up_s
        else []
    )


def _height(begun: Beginning) -> str:
    height, machine = begun.now.safe_height(), begun.now.machine
    if height is None:
        return ""
    axis = machine.axes[height.axis]
    return phrase(
        "{name} {with_unit} (machine)",
        name=axis.name.upper(),
        with_unit=axis.with_unit(f"{height.mm:.3f}"),
    )


def _in_force(source: ProgramSource) -> str:
    modal, frame = source.modal, WorkFacts.of(source.frame, 0)
    return phrase(
        "feed {feed_in_words}, tool {tool}, plane G{plane}, work offset {system}{more},"
        " {word}, {word_2}",
        feed_in_words=_feed_in_words(source),
        tool=modal.tool,
        plane=modal.plane,
        system=frame.system,
        more=frame.more(),
        word=phrase("mm") if modal.scale_mm == 1 else phrase("inches"),
        word_2=phrase("absolute") if modal.absolute else phrase("incremental"),
    )


def _feed_in_words(source: ProgramSource) -> str:
    """The feed in force; where there are rotary axes, it is one of degrees for them."""
    modal = source.modal
    if not modal.feed_mm_min and not modal.feed_word:
        return phrase("none yet")
    said = phrase("{feed_mm_min:g} mm/min", feed_mm_min=modal.feed_mm_min)
    return (
        said
        if source.axes.only_linear
        else phrase("{said} or {feed_word:g} °/min", said=said, feed_word=modal.feed_word)
    )
