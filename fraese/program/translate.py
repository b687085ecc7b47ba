"""Canonical moves to blocks: the interpreter's words in the planner's hands.

Rule 1: one row a kind of move, in ``_ROWS``; each gives blocks, waits, or both, as a job does.
Rule 2: a barrier is planned to rest, waited for, and answered with what the machine found.
        Without a controller (a check) nothing waits: everything goes as commanded.
Rule 3: outputs that hang on nothing are switched by hand: the operator is told, never refused.
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import replace
from typing import Any, Final

from fraese.blocks import Block
from fraese.control.controller import Controller
from fraese.control.jobs import STANDSTILL, TURN, Ask, Doing, Job, move_of
from fraese.errors import ProgramError
from fraese.gcode import canon
from fraese.motor.seams import Report
from fraese.phrases import phrase
from fraese.planner.planner import Planner
from fraese.program.context import ProgramContext
from fraese.program.laser import Laser
from fraese.program.numbers import Numbers
from fraese.program.sentences import (
    by_hand,
    coolant_in_words,
    spindle_in_words,
    stop_question,
    tool_question,
)
from fraese.program.touch import Part, Touch, each
from fraese.program.userwords import execute
from fraese.program.visit import Visit

Moves = Generator[canon.Move, canon.Facts | None, None]

#: Blocks of what is only looked through are at most so long: no override has to act on them.
_LOOKED_BLOCK_S: Final = 1.0
#: And so much of it is planned in one pass: nothing waits for the first of it.
_LOOKED_BATCH_S: Final = 0.5


class Translation:
    """Plans the moves of one program.

    Args:
        context: the machine as the program finds it.
        controller: told, asked and watched; None for a check.

    Attributes:
        planner: what makes blocks of moves.
        numbers: of the move in hand.
        answers: what barriers were answered, by the number of their move.
        visited: what a person has changed since the program asked for him last, and
        visited_at: the number of the move that did so.
    """

    def __init__(self, context: ProgramContext, controller: Controller | None) -> None:
        self._context = context
        self._controller = controller
        self._handling = None if controller is None else controller.handling
        # Overrides that the planner knows: of feeds, of rapids.
        self._factors = (1.0, 1.0)
        # Feed of the last motion that has one; 0: none yet.
        self._feed_mm_min = 0.0
        # Line of the last motion; 0: none yet.
        self._line = 0
        self._has_turned = False
        # A relay as it was switched last; None: not yet.
        self._spins: bool | None = None
        self._laser = Laser(context.config.outputs)
        self.numbers = Numbers()
        self.answers: dict[int, canon.Facts] = {}
        self.visited: Callable[[], Mapping[int, float]] = dict
        self.visited_at = 0
        options = context.options()
        if controller is None:
            # Nobody changes an override, and nothing waits, while it is only looked through.
            longest_s = max(options.max_block_s, _LOOKED_BLOCK_S)
            options = replace(options, max_block_s=longest_s, batch_s=_LOOKED_BATCH_S)
        self.planner = Planner(context.machine, context.start_steps, options, context.slack_steps)
        self._touch = Touch(context, controller, self.planner)

    def blocks(self, moves: Moves) -> Job:
        """A job of all moves; ends at rest, everything pushed but not yet played.

        Raises:
            ProgramError: a line is refused, from the interpreter.
            ProbeError: a probe touches never, or already.
        """
        line, rows, numbers, laser = self.planner.line, _ROWS, self.numbers, self._laser.mask
        feed, rapid = canon.Feed, canon.Rapid
        facts: canon.Facts | None = None
        self._follow_override()
        while True:
            try:
                move: Any = moves.send(facts)
            except StopIteration:
                break
            facts = None
            high = numbers.high = numbers.high + numbers.stride
            kind = type(move)
            if move.line != self._line and kind in canon.MOTIONS:
                yield from self._wait_for_line(move)
            if laser and kind in canon.MOTIONS:
                yield from each(self._laser.along(move, self.planner))
            if kind is not feed and kind is not rapid:
                facts = yield from rows[kind](self, move)
                if facts is not None:
                    self.answers[move_of(high)] = facts
            elif self._touch.is_closed:
                yield from self._touch.leave(move, high | move.line)
            else:
                feed_mm_min = move.feed_mm_min if kind is feed else None
                if kind is feed and feed_mm_min != self._feed_mm_min:
                    self._note_feed(move.feed_mm_min)
                for block in line(move.to, feed_mm_min, high | move.line):
                    yield block
                    self._follow_override()
            self._follow_override()
        yield from each(self.planner.finish())

    def _wait_for_line(self, move: canon.Move) -> Part:
        """A line that moves begins: one by one, if that is wanted."""
        before, self._line = self._line, move.line
        if before and self._handling is not None and self._handling.single_block:
            yield from each(self.planner.drain())
            yield Ask(
                phrase("Single block: line {line} comes next.", line=move.line),
                admits=False,
                waits_for=phrase("line {line}", line=move.line),
            )
        return None

    def _note_feed(self, feed_mm_min: float) -> None:
        """From the move in hand on it is this."""
        self._feed_mm_min = feed_mm_min
        self._note(feed_mm_min=feed_mm_min)

    def _note(self, **changes: Any) -> None:
        controller = self._controller
        if controller is not None:
            played = controller.move_played()
            controller.cutting.note(move_of(self.numbers.high), played, **changes)

    def _note_spindle(self, move: canon.Spindle, *, by_hand: bool) -> None:
        direction = move.direction if move.is_on else 0
        self._note(
            direction=direction,
            rev_min=move.rev_min,
            by_hand=by_hand,
            is_laser=bool(self._laser.mask),
            power_percent=self._laser.percent(move),
        )

    def _tag(self, move: canon.Move) -> int:
        """Names the move in the driver's reports."""
        return self.numbers.high | move.line

    def _follow_override(self) -> None:
        handling = self._handling
        if handling is not None:
            wanted = (handling.feed, handling.rapid)
            if wanted != self._factors:
                self._factors = wanted
                self.planner.set_override(*wanted)

    # --- moves ---------------------------------------------------------------------------------

    def _arc(self, move: canon.Arc) -> Part:
        if move.feed_mm_min != self._feed_mm_min:
            self._note_feed(move.feed_mm_min)
        for block in self.planner.arc(
            move.to, move.centre, move.plane, move.turns, move.feed_mm_min, self._tag(move)
        ):
            yield block
            self._follow_override()
        return None

    def _along(self, move: canon.Along) -> Part:
        if self._touch.is_closed:
            return (yield from self._touch.leave(move, self._tag(move)))
        feed_mm_min = move.feed_mm_min
        if feed_mm_min is not None and feed_mm_min != self._feed_mm_min:
            self._note_feed(feed_mm_min)
        course = self.planner.along(
            move.points, move.to, feed_mm_min, self._tag(move),
            plane=move.plane, radius_mm=move.radius_mm,
        )  # fmt: skip
        for block in course:
            yield block
            self._follow_override()
        return None

    def _dwell(self, move: canon.Dwell) -> Part:
        yield from each(self.planner.dwell(move.duration_s, self._tag(move)))
        return None

    def _path_control(self, move: canon.PathControl) -> Part:
        yield from each(self.planner.path_control(move.mode.value, move.tolerance_mm))
        return None

    def _overrides(self, move: canon.Overrides) -> Part:
        yield from each(self.planner.allow_override(move.enabled))
        return None

    def _offsets(self, _move: canon.Offsets) -> Part:
        yield from each(self.planner.end_line())
        return None

    def _end(self, move: canon.End) -> Part:
        yield from each(self.planner.drain())
        return None

    # --- what hangs on outputs -----------------------------------------------------------------

    def _spindle(self, move: canon.Spindle) -> Part:
        on, outputs = move.is_on, self._context.config.outputs
        if outputs.mask("laser", "spindle"):
            self._note_spindle(move, by_hand=False)
        if self._laser.mask:
            yield from each(self._laser.switch(move, self.planner))
            return None
        if outputs.mask("spindle"):
            if on is not self._spins:
                self._spins = on
                yield from self._switch("spindle", on)
                if on:
                    spin_up_s = self._context.config.run.spin_up_s
                    yield from each(self.planner.dwell(spin_up_s, self._tag(move)))
            return None
        text, facts = spindle_in_words(move), None
        if self._is_to_be_confirmed(on):
            question = phrase("{text}: confirm.", text=text)
            facts = yield from self._ask(question, move, phrase("spindle"))
        else:
            self._say(by_hand(move, text))
        # Before it was confirmed nobody says that it turns.
        self._note_spindle(move, by_hand=True)
        return facts

    def _is_to_be_confirmed(self, on: bool) -> bool:
        """Nobody but the operator knows whether a spindle that is switched by hand turns."""
        when = self._context.config.run.confirm_spindle
        is_first, self._has_turned = on and not self._has_turned, self._has_turned or on
        return when == "every" or (when == "first" and is_first)

    def _coolant(self, move: canon.Coolant) -> Part:
        if not (yield from self._switch("coolant", move.mist or move.flood)):
            self._say(by_hand(move, coolant_in_words(move)))
        return None

    def _output(self, move: canon.Output) -> Part:
        if not (yield from self._switch(move.name, move.is_on)):
            raise ProgramError(
                phrase(
                    "the output {name} is to be switched, and there is none: [outputs.own.{name}]"
                    " names its pin",
                    name=move.name,
                ),
                line=move.line,
            )
        return None

    def _command(self, move: canon.Command) -> Part:
        yield from each(self.planner.drain())
        if self._controller is None:
            return None
        yield STANDSTILL
        yield Doing(f"M{move.code}")
        yield from execute(move)
        yield Doing("")
        return None

    def _switch(self, name: str, on: bool) -> Generator[Block, Report, bool]:
        """Switch a configured output, at rest; False if there is none."""
        mask = self._context.config.outputs.mask(name)
        if not mask:
            return False
        yield from each(self.planner.drain())
        self.planner.outputs(mask, mask if on else 0)
        yield from each(self.planner.dwell(0))
        return True

    # --- barriers ------------------------------------------------------------------------------

    def _pause(self, move: canon.Pause) -> Part:
        if move.optional and not (self._handling and self._handling.optional_stop):
            return None
        word = "M1" if move.optional else "M0"
        return (yield from self._ask(stop_question(move), move, word))

    def _tool(self, move: canon.Tool) -> Part:
        word = phrase("tool {number}", number=move.number)
        return (yield from self._ask(tool_question(move), move, word))

    def _ask(self, question: str, move: canon.Move, waits_for: str) -> Part:
        yield from each(self.planner.drain())
        controller = self._controller
        if controller is None:
            return None
        yield STANDSTILL
        visit = Visit(controller, self._context)
        self.visited, self.visited_at = (lambda: visit.changed), move_of(self.numbers.high)
        tag = self._tag(move)
        yield Ask(question, tag=tag, waits_for=waits_for)
        while (back := visit.show()) is not None:
            yield Ask(back.question, tag=tag, waits_for=phrase("way back"))
        if visit.is_nothing:
            return None
        at = controller.position
        self.planner.reset(at.position_steps, at.slack_steps)
        for point, feed_mm_min in visit.way().legs:
            yield from each(self.planner.line(point, feed_mm_min, tag))
        yield from each(self.planner.drain())
        yield STANDSTILL
        return visit.facts()

    def _probe(self, move: canon.Probe) -> Part:
        return (yield from self._touch.probe(move, self._tag(move)))

    def _message(self, move: canon.Message) -> Part:
        self._say(
            phrase("Line {line}: {text}.", line=move.line, text=move.text)
            if move.kind == "note"
            else move.text
        )
        return None
        yield

    def _breath(self, _move: canon.Breath) -> Part:
        # It is no move of the program, and has no number.
        self.numbers.high -= self.numbers.stride
        yield TURN
        return None

    def _say(self, text: str) -> None:
        if self._controller is not None:
            self._controller.say(text)


_ROWS: Final[dict[type, Callable[[Translation, Any], Part]]] = {
    canon.Arc: Translation._arc,
    canon.Along: Translation._along,
    canon.Dwell: Translation._dwell,
    canon.PathControl: Translation._path_control,
    canon.Overrides: Translation._overrides,
    canon.Offsets: Translation._offsets,
    canon.Spindle: Translation._spindle,
    canon.Coolant: Translation._coolant,
    canon.Output: Translation._output,
    canon.Command: Translation._command,
    canon.Pause: Translation._pause,
    canon.Tool: Translation._tool,
    canon.Probe: Translation._probe,
    canon.Message: Translation._message,
    canon.End: Translation._end,
    canon.Breath: Translation._breath,
}
