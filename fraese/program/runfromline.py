"""A program from a place on: what lies before is read, and a way there is put in front.

before the place    read; of what it commands the last word of each kind is repeated
the way there       up to the safe height | over to where the program would be | outputs on, with
                    the time that they need | down with its feed | a laser on, M49
from there on       the program

Rule 1: a line of the program is come to when it is carried out, or what it calls: the interpreter
        knows call level, file and repeat count.
Rule 2: what depends on where the machine stood or on what a probe found (G92, G10 L20, G28.1, G91
        from the start) is never made out anew from another place. It is taken from the run of this
        program that was cut short, or refused with its line.
"""

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.phrases import phrase
from fraese.program.context import ProgramContext
from fraese.program.numbers import Numbers
from fraese.program.source import ProgramSource
from fraese.program.translate import Moves
from fraese.workframe import TOOL_NUMBER, Point

#: After so many moves that are only read, the consumer gets a turn.
_MOVES_A_BREATH: Final = 500
_Way = Generator[canon.Move, canon.Facts | None, None]
_REPEATED = (canon.Spindle, canon.Coolant, canon.PathControl, canon.Tool, canon.Overrides)
_MOTIONS = (canon.Rapid, canon.Feed, canon.Arc, canon.Along, canon.Probe)


@dataclass(frozen=True, slots=True)
class Place:
    """Where a program is begun.

    Attributes:
        line: at the first move that belongs to this line or a later one.
        move: at the move of this number, counted from 1; 0: the line counts.
    """

    line: int
    move: int = 0

    def is_reached(self, move: canon.Move, number: int, source: ProgramSource) -> bool:
        """Whether this move, just read, is to be made."""
        return number >= self.move if self.move else source.has_come_to(self.line, move)


@dataclass(frozen=True)
class Beginning:
    """How a program is begun.

    Attributes:
        source: a reading of it.
        found: the machine as that finds it.
        now: the machine as it stands.
        place: where to begin; None: at its start, wherever the machine stands.
        answers: what barriers before the place are answered, by the number of their move.
    """

    source: ProgramSource
    found: ProgramContext
    now: ProgramContext
    place: Place | None = None
    answers: Mapping[int, canon.Facts] = field(default_factory=dict)

    def moves(self, numbers: Numbers) -> Moves:
        """The moves from the place on, with the way there in front.

        Args:
            numbers: told what is passed by.

        Raises:
            ProgramError: if there is no such place.
        """
        moves = self.source.moves()
        return moves if self.place is None else self._from(self.place, moves, numbers)

    def _from(self, place: Place, moves: Moves, numbers: Numbers) -> Moves:
        """What lies before is read for what it leaves in force."""
        kept: dict[type, canon.Move] = {}
        left: dict[str, canon.Message | None] = {}
        replay = self.source.only_read(place.line) if self.found is self.now else None
        # Gone on with, it begins where it stood then; else nothing says where it would be.
        at = None if self.found is self.now else self.found.start_mm
        facts, number = None, 0
        while True:
            try:
                move = moves.send(facts)
            except StopIteration:
                raise _nothing_there(place) from None
            if isinstance(move, canon.Breath):
                facts = yield move
                continue
            number += 1
            if not number % _MOVES_A_BREATH:
                yield canon.Breath(move.line)
            if isinstance(move, canon.End):
                raise _nothing_there(place, move.line)
            if place.is_reached(move, number, self.source):
                break
            numbers.pass_by()
            facts = self.answers.get(number)
            if isinstance(move, canon.Probe) and facts is None:
                raise _nothing_found(self.source, move)
            if isinstance(move, _MOTIONS):
                at = facts.position_mm if facts else move.to
            elif isinstance(move, _REPEATED):
                kept[type(move)] = move
                at = facts.position_mm if facts else at
            elif isinstance(move, canon.Output | canon.Command):
                left.update(_left_out(move))
        if replay is not None:
            replay.require_place()
        numbers.leave()
        yield from filter(None, left.values())
        yield canon.Offsets(move.line)
        yield from self._way_to(at, kept, move.line)
        yield from _repeated(kept, canon.Overrides)
        numbers.come_back()
        facts = yield move
        yield from _rest(moves, facts)

    def _way_to(self, at: Point | None, kept: dict[type, canon.Move], line: int) -> _Way:
        """From wherever the machine stands to where the program would be, with its outputs on."""
        self._drop_what_is_in(kept)
        yield from _repeated(kept, canon.Tool, canon.PathControl)
        over, down = self._legs(at, line)
        yield from over
        # A spindle is to turn before the tool goes down; a beam would cut on the way.
        if self.now.has_laser:
            yield from _repeated(kept, canon.Coolant)
            yield from down
            yield from _repeated(kept, canon.Spindle)
        else:
            yield from _repeated(kept, canon.Spindle, canon.Coolant)
            yield from down

    def _drop_what_is_in(self, kept: dict[type, canon.Move]) -> None:
        """A tool that is in the spindle is not asked for again."""
        tool = kept.get(canon.Tool)
        if isinstance(tool, canon.Tool) and tool.number == self.now.parameters.get(TOOL_NUMBER):
            del kept[canon.Tool]

    def _legs(self, at: Point | None, line: int) -> tuple[list[canon.Move], list[canon.Move]]:
        """The way above the work, and the way down."""
        if at is None:
            return [], []
        height = self.now.safe_height()
        if height is None:
            return [canon.Rapid(line, at)], []
        top = height.at_least(at[height.axis])
        feed_mm_min = self.source.modal.feed_mm_min or self.source.default_feed_mm_min
        over: list[canon.Move] = [
            canon.Rapid(line, top.at(self.now.start_mm)),
            canon.Rapid(line, top.at(at)),
        ]
        return over, [canon.Feed(line, at, feed_mm_min)]


def _nothing_there(place: Place, end_line: int = 0) -> ProgramError:
    ends = phrase("; the program ends in line {end_line}", end_line=end_line) if end_line else ""
    return ProgramError(
        phrase("there is nothing to run from line {line} on{ends}.", line=place.line, ends=ends),
        place.line,
    )


def _nothing_found(source: ProgramSource, probe: canon.Probe) -> ProgramError:
    said = phrase(
        "what the probe found is not known, and it is not probed again from another place: begin"
        " before it, or go on with the run that was cut short"
    )
    line, message = source.complaint(probe.line, said)
    return ProgramError(message, line)


def _left_out(move: canon.Output | canon.Command) -> dict[str, canon.Message | None]:
    """What is to be said of a word that is not carried out again; None: it left nothing behind."""
    if isinstance(move, canon.Command):
        said = phrase("M{code} is not carried out again", code=move.code)
        return {f"M{move.code}": canon.Message(move.line, said, "note")}
    said = phrase("the output {name} is not switched on again", name=move.name)
    return {move.name: canon.Message(move.line, said, "note") if move.is_on else None}


def _rest(moves: Moves, facts: canon.Facts | None) -> Moves:
    while True:
        try:
            move = moves.send(facts)
        except StopIteration:
            return
        facts = yield move


def _repeated(kept: dict[type, canon.Move], *kinds: type[canon.Move]) -> _Way:
    for kind in kinds:
        if kind in kept:
            yield kept[kind]
