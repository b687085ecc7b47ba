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
from fraese.program.runfromline import Beginning
from fraese.program.source import ProgramSource
from fraese.program.translate import Numbers


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
    """

    line: int
    text: str
    legs: tuple[Leg, ...]
    height: str
    in_force: str

    def lines(self, name: str) -> list[str]:
        """All of it, for a program of this name."""
        legs = [f"  {', '.join(filter(None, leg[:2]))}" for leg in self.legs]
        return [
            f"{name} from line {self.line}:",
            *legs,
            f"  then the program, with {self.in_force}",
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
                raise Cancelled("Given up; nothing has moved.")
            continue
        if isinstance(move, canon.Offsets):
            continue
        goes_down = goes_down or isinstance(move, canon.Feed)
        legs.append(_leg(move, here, source, now.machine))
        if isinstance(move, canon.Rapid | canon.Feed):
            here = move.to
        if isinstance(move, canon.Spindle) and not is_over:
            legs += _run_up(begun, move)
        if is_over:
            break
    return Way(line, source.text, tuple(legs), _height(begun), _in_force(source))


def _leg(move: canon.Move, here: Millimetres, source: ProgramSource, machine: Machine) -> Leg:
    """A move on that way; its feed counts along mm or degrees."""
    if isinstance(move, canon.Rapid | canon.Feed):
        unit = "°" if source.axes.way(here, move.to).is_angle else "mm"
        how = f"feed {move.feed_mm_min:g} {unit}/min" if isinstance(move, canon.Feed) else "rapid"
        place, work = machine.in_words(move.to), machine.in_words(source.frame.to_work(move.to))
        also = f"{work} (work)" if work != place else ""
        return Leg(f"{how} to {place} (machine)", also, is_move=True)
    return Leg(_switched(move))


def _switched(move: canon.Move) -> str:
    """What moves nothing."""
    if isinstance(move, canon.Spindle):
        return f"spindle {'on' if move.direction else 'off'}, {move.rev_min:g} rev/min"
    if isinstance(move, canon.Coolant):
        return f"coolant {'on' if move.mist or move.flood else 'off'}"
    if isinstance(move, canon.Tool):
        return f"tool {move.number}"
    if isinstance(move, canon.PathControl):
        return f"corners as with {move.mode.value}"
    return type(move).__name__.lower()


def _run_up(begun: Beginning, move: canon.Spindle) -> list[Leg]:
    """How long it is waited for."""
    config = begun.now.config
    waits = move.direction and config.outputs.mask("spindle") and not begun.now.has_laser
    spin_up_s = config.run.spin_up_s
    return [Leg(f"wait {spin_up_s:g} s for it")] if waits and spin_up_s else []


def _height(begun: Beginning) -> str:
    height, machine = begun.now.safe_height(), begun.now.machine
    if height is None:
        return ""
    axis = machine.axes[height.axis]
    return f"{axis.name.upper()} {axis.with_unit(f'{height.mm:.3f}')} (machine)"


def _in_force(source: ProgramSource) -> str:
    modal, frame = source.modal, WorkFacts.of(source.frame, 0)
    return (
        f"feed {_feed_in_words(source)}, tool {modal.tool}, plane G{modal.plane},"
        f" work offset {frame.system}{frame.more()}, {'mm' if modal.scale_mm == 1 else 'inches'},"
        f" {'absolute' if modal.absolute else 'incremental'}"
    )


def _feed_in_words(source: ProgramSource) -> str:
    """The feed in force; where there are rotary axes, it is one of degrees for them."""
    modal = source.modal
    said = f"{modal.feed_mm_min:g} mm/min"
    return said if source.axes.only_linear else f"{said} or {modal.feed_word:g} °/min"
