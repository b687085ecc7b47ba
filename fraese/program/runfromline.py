"""A program from a line on: what lies before is read, and a way there is put in front.

before the line    read; of what it commands the last word of each kind is repeated
the way there      up to the safe height | over to where the program would be | down with its feed
from the line on   the program
"""

from collections.abc import Generator

from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.program.context import ProgramContext
from fraese.program.source import ProgramSource
from fraese.program.translate import Moves


def safe_z(context: ProgramContext) -> float:
    """Height for the way to a line: the top, or where it stands if nobody knows the top."""
    if context.referenced[2] or context.config.run.safe_z_mm is not None:
        return context.safe_z_mm()
    return context.machine.to_mm(context.start_steps)[2]


def skip_to(moves: Moves, from_line: int, safe_z_mm: float, source: ProgramSource) -> Moves:
    """The moves from a line on, with the way there in front.

    What lies before is read for what it leaves in force; of what it commands the last word of
    each kind (path mode, spindle, coolant) is repeated. Then: up to the safe height, over to where
    the program would be, and down with its feed.

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
    yield from _way_to(kept, safe_z_mm, source, from_line)
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
    kept: dict[type, canon.Move], safe_z_mm: float, source: ProgramSource, line: int
) -> Generator[canon.Move, canon.Facts | None, None]:
    """From wherever the machine stands to where the program would be."""
    for kind in (canon.Tool, canon.Spindle, canon.Coolant, canon.PathControl):
        if kind in kept:
            yield kept[kind]
    last = kept.get(canon.Rapid)
    if last is None:
        return
    x_mm, y_mm, z_mm = last.to  # type: ignore[union-attr]
    here_x, here_y, _ = source.start_mm
    top_mm = max(safe_z_mm, z_mm)
    yield canon.Rapid(line, (here_x, here_y, top_mm))
    yield canon.Rapid(line, (x_mm, y_mm, top_mm))
    feed_mm_min = source.modal_state().feed_mm_min or source.default_feed_mm_min
    yield canon.Feed(line, (x_mm, y_mm, z_mm), feed_mm_min)


def in_words(move: canon.Move) -> str:
    """A move on that way, for people."""
    if isinstance(move, canon.Rapid | canon.Feed):
        where = " ".join(f"{name}{value:.3f}" for name, value in zip("XYZ", move.to, strict=True))
        how = f"feed {move.feed_mm_min:g} mm/min" if isinstance(move, canon.Feed) else "rapid"
        return f"{how} to {where} (machine)"
    if isinstance(move, canon.Spindle):
        return f"spindle {'on' if move.direction else 'off'}, {move.rev_min:g} rev/min"
    if isinstance(move, canon.Coolant):
        return f"coolant {'on' if move.mist or move.flood else 'off'}"
    if isinstance(move, canon.Tool):
        return f"tool {move.number}"
    return type(move).__name__.lower()
