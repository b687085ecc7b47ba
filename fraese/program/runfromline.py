"""A program from a place on: what lies before is read, and a way there is put in front.

before the place    read; of what it commands the last word of each kind is repeated
the way there       up to the safe height | over to where the program would be | outputs on, with
                    the time that they need | down with its feed | a laser on
from there on       the program
"""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.machine import Machine
from fraese.program.context import ProgramContext
from fraese.program.source import ProgramSource
from fraese.program.translate import Moves, Numbers
from fraese.workframe import Point

#: After so many moves that are only read, the consumer gets a turn.
_MOVES_A_BREATH: Final = 500
_Way = Generator[canon.Move, canon.Facts | None, None]


@dataclass(frozen=True, slots=True)
class Place:
    """Where a program is begun.

    Attributes:
        line: at the first move of this line or a later one.
        move: at the move of this number, counted from 1; 0: the line counts.
    """

    line: int = 0
    move: int = 0

    def is_reached(self, move: canon.Move, number: int) -> bool:
        """Whether this move is to be made."""
        return number >= self.move if self.move else move.line >= self.line


def skip_to(
    moves: Moves,
    place: Place,
    context: ProgramContext,
    source: ProgramSource,
    numbers: Numbers | None = None,
) -> Moves:
    """The moves from a place on, with the way there in front.

    What lies before is read for what it leaves in force; of what it commands the last word of
    each kind (path mode, spindle, coolant) is repeated.

    Args:
        moves: from the source.
        place: where to begin.
        context: knows the safe height, and what hangs on outputs.
        source: knows what the moves before leave in force.
        numbers: told what is passed by; None: nobody counts.

    Raises:
        ProgramError: if there is no such place.
    """
    numbers = numbers or Numbers()
    kept: dict[type, canon.Move] = {}
    number = 0
    for move in moves:
        if isinstance(move, canon.Breath):
            yield move
            continue
        number += 1
        if not number % _MOVES_A_BREATH:
            yield canon.Breath(move.line)
        if place.is_reached(move, number) and not isinstance(move, canon.End):
            break
        if isinstance(move, canon.End):
            raise ProgramError(
                f"there is nothing to run from line {place.line} on; the program ends in line"
                f" {move.line}.",
                place.line,
            )
        numbers.pass_by()
        if isinstance(move, canon.Rapid | canon.Feed | canon.Arc | canon.Probe):
            kept[canon.Rapid] = move
        elif isinstance(move, canon.Spindle | canon.Coolant | canon.PathControl | canon.Tool):
            kept[type(move)] = move
    else:
        raise ProgramError(f"there is nothing to run from line {place.line} on.", place.line)
    numbers.leave()
    yield from _way_to(kept, context, source, place.line)
    numbers.come_back()
    facts = yield move
    yield from _rest(moves, facts)


def _rest(moves: Moves, facts: canon.Facts | None) -> Moves:
    while True:
        try:
            move = moves.send(facts)
        except StopIteration:
            return
        facts = yield move


def _way_to(
    kept: dict[type, canon.Move], context: ProgramContext, source: ProgramSource, line: int
) -> _Way:
    """From wherever the machine stands to where the program would be, with its outputs on."""
    yield from _repeated(kept, canon.Tool, canon.PathControl)
    over, down = _legs(kept.get(canon.Rapid), context, source, line)
    yield from over
    # A spindle is to turn before the tool goes down; a beam would cut on the way.
    if context.has_laser:
        yield from _repeated(kept, canon.Coolant)
        yield from down
        yield from _repeated(kept, canon.Spindle)
    else:
        yield from _repeated(kept, canon.Spindle, canon.Coolant)
        yield from down


def _legs(
    last: canon.Move | None, context: ProgramContext, source: ProgramSource, line: int
) -> tuple[list[canon.Move], list[canon.Move]]:
    """The way above the work, and the way down."""
    if last is None:
        return [], []
    to: Point = last.to  # type: ignore[union-attr]
    height = context.safe_height()
    if height is None:
        return [canon.Rapid(line, to)], []
    top = height.at_least(to[height.axis])
    feed_mm_min = source.modal.feed_mm_min or source.default_feed_mm_min
    over: list[canon.Move] = [
        canon.Rapid(line, top.at(source.start_mm)),
        canon.Rapid(line, top.at(to)),
    ]
    return over, [canon.Feed(line, to, feed_mm_min)]


def _repeated(kept: dict[type, canon.Move], *kinds: type[canon.Move]) -> _Way:
    for kind in kinds:
        if kind in kept:
            yield kept[kind]


def in_words(move: canon.Move, machine: Machine, unit: str) -> str:
    """A move on that way, for people; its feed counts along mm or degrees."""
    if isinstance(move, canon.Rapid | canon.Feed):
        where = machine.in_words(move.to)
        how = f"feed {move.feed_mm_min:g} {unit}/min" if isinstance(move, canon.Feed) else "rapid"
        return f"{how} to {where} (machine)"
    if isinstance(move, canon.Spindle):
        return f"spindle {'on' if move.direction else 'off'}, {move.rev_min:g} rev/min"
    if isinstance(move, canon.Coolant):
        return f"coolant {'on' if move.mist or move.flood else 'off'}"
    if isinstance(move, canon.Tool):
        return f"tool {move.number}"
    return type(move).__name__.lower()
