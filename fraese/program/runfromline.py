"""A program from a line on: what lies before is read, and a way there is put in front.

before the line    read; of what it commands the last word of each kind is repeated
the way there      up to the safe height | over to where the program would be | down with its feed
from the line on   the program
"""

from collections.abc import Generator

from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.machine import Machine
from fraese.program.context import Height
from fraese.program.source import ProgramSource
from fraese.program.translate import Moves
from fraese.workframe import Point


def skip_to(moves: Moves, from_line: int, height: Height | None, source: ProgramSource) -> Moves:
    """The moves from a line on, with the way there in front.

    What lies before is read for what it leaves in force; of what it commands the last word of
    each kind (path mode, spindle, coolant) is repeated. Then: up to the safe height, over to where
    the program would be, and down with its feed.

    Args:
        moves: from the source.
        from_line: where to begin.
        height: for the way over; None: nothing lifts the tool, it goes straight there.
        source: knows what the lines before leave in force.

    Raises:
        ProgramError: if there is no such line.
    """
    kept: dict[type, canon.Move] = {}
    for move in moves:
        if move.line >= from_line and not isinstance(move, canon.End):
            break
        if isinstance(move, canon.End):
            raise ProgramError(
                f"there is nothing to run from line {from_line} on; the program ends in line"
                f" {move.line}.",
                from_line,
            )
        if isinstance(move, canon.Rapid | canon.Feed | canon.Arc | canon.Probe):
            kept[canon.Rapid] = move
        elif isinstance(move, canon.Spindle | canon.Coolant | canon.PathControl | canon.Tool):
            kept[type(move)] = move
    else:
        raise ProgramError(f"there is nothing to run from line {from_line} on.", from_line)
    yield from _way_to(kept, height, source, from_line)
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
    kept: dict[type, canon.Move], height: Height | None, source: ProgramSource, line: int
) -> Generator[canon.Move, canon.Facts | None, None]:
    """From wherever the machine stands to where the program would be."""
    for kind in (canon.Tool, canon.Spindle, canon.Coolant, canon.PathControl):
        if kind in kept:
            yield kept[kind]
    last = kept.get(canon.Rapid)
    if last is None:
        return
    to: Point = last.to  # type: ignore[union-attr]
    if height is None:
        yield canon.Rapid(line, to)
        return
    top = height.at_least(to[height.axis])
    yield canon.Rapid(line, top.at(source.start_mm))
    yield canon.Rapid(line, top.at(to))
    yield canon.Feed(line, to, source.modal.feed_mm_min or source.default_feed_mm_min)


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
