"""The interpreter: lines of a program in, canonical moves out.

Rule 1  Lines are read when moves are asked for; nothing is read ahead but for O-words.
Rule 2  Whatever a line does takes effect in the order of ``modal.ORDER``; each entry there
        has one method here.
Rule 3  Behind a barrier (probe, pause, tool change) the position is what the outside says.
        ``None`` says "as commanded": a probe goes to its target, and touches there if it must.
Rule 4  Whatever is wrong with a program ends in a ProgramError with file and line.
"""

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode import cutterwords, messages, named, words
from fraese.gcode.axes import Axes
from fraese.gcode.canon import (
    BARRIERS,
    Arc,
    Breath,
    Facts,
    Feed,
    Message,
    Move,
    Offsets,
    Probe,
    Rapid,
)
from fraese.gcode.cutter import Cutter
from fraese.gcode.foreign import explained
from fraese.gcode.frames import Frames
from fraese.gcode.labels import SUBPROGRAM
from fraese.gcode.modal import CUTTER_ON, M_OFFSET, ORDER, Modal
from fraese.gcode.motion import Motion
from fraese.gcode.offsets import Coordinates
from fraese.gcode.outputs import Handler, Moves, Outputs
from fraese.gcode.oword import Flow
from fraese.gcode.parameters import Parameters
from fraese.gcode.replay import Replay
from fraese.gcode.settings import Settings
from fraese.gcode.setup import Setup
from fraese.gcode.source import NOT_YET, Source
from fraese.gcode.text import MAX_LINE
from fraese.gcode.words import Block, BlockReader
from fraese.phrases import phrase
from fraese.workframe import TOOL_NUMBER, Point, WorkFrame

#: Told of a line that is refused; whether the program is read on behind it.
Refused = Callable[[ProgramError], bool]
#: After so many lines without a move the consumer gets a turn.
_LINES_A_BREATH: Final = 1_000


def _ends_it(_error: ProgramError) -> bool:
    return False


class Interpreter:
    """One run of one program.

    Args:
        setup: what the program finds.
    """

    def __init__(self, setup: Setup | None = None) -> None:
        self.setup = setup = setup or Setup()
        self.parameters = parameters = Parameters(setup.parameters)
        self._modal = Modal(tool=setup.tool, scale_mm=25.4 if setup.inches else 1.0)
        axes = Axes(setup.axes, setup.rotary)
        coordinates = Coordinates(parameters, setup.axes)
        self._motion = Motion(axes, parameters, coordinates, self._modal, setup.unreferenced)
        self._motion.at = coordinates.frame.to_work(setup.position_mm or coordinates.nothing)
        self._frames = Frames(self._motion, setup.tools)
        self._settings = Settings(self._motion, self._frames)
        self._notes = messages.Notes()
        self._outputs = Outputs(
            self._motion,
            self._frames,
            self._settings,
            self._notes,
            setup.ignored_m_codes,
            setup.user_word,
            remark=lambda: messages.remark(self._text),
        )
        # where the last move inside a loop or subroutine went
        self._last_to: Point | None = None
        self._cutter = Cutter(self._motion)
        self._reader = BlockReader(parameters, axes)
        self._flow = Flow(Source((), setup.file), parameters, setup)
        self._text = ""
        # whether anything of the program was carried out
        self._begun = False
        self._handlers: dict[str, Handler] = dict.fromkeys(ORDER, self._set)
        self._handlers.update(self._outputs.handlers())
        self._handlers.update(f=self._feed, state=self._state, nonmodal=self._nonmodal)
        self._handlers["cutter"] = self._compensate
        named.install(parameters, self._motion, self._frames, self._cutter, lambda: self._flow)

    def run(
        self, lines: Iterable[str], refused: Refused | None = None
    ) -> Generator[Move, Facts | None, None]:
        """Yield the program's moves; answer each barrier with ``send``.

        Args:
            lines: the program's lines, with or without their ends.
            refused: told of a line that is refused; if it answers True, the program is read on
                behind it, as if it were not there. What branches ends it all the same.

        Raises:
            ProgramError: a line is refused.
        """
        source = Source(lines, self.setup.file)
        self._flow = Flow(source, self.parameters, self.setup)
        try:
            yield from self._lines(refused or _ends_it)
        except ProgramError as error:
            raise self._with_place(error) from error

    def _with_place(self, error: ProgramError) -> ProgramError:
        now = self.refusal(error.message, error.line)
        if error.file in ("", now.file):
            return now
        # Of a file that is not carried out yet: the line that asked for it calls it.
        calls = (now.file, self.refusal("").line), *now.calls
        return ProgramError(error.message, error.line, error.file, calls)

    def refusal(self, message: str, line: int = 0) -> ProgramError:
        """An error in the file that is carried out now, with where it was called.

        Args:
            message: what is wrong.
            line: of that file; 0: the one that was read last.
        """
        now = self._flow.source
        return ProgramError(message, line or max(now.line, 1), now.file, self._flow.calls())

    def only_read(self, line: int) -> Replay:
        """What comes before this line is read, and not carried out."""
        replay = Replay(self.setup.axes, lambda: self.has_come_to(line, self._motion.line))
        self._motion.replay = replay
        return replay

    def has_come_to(self, wanted: int, line: int) -> bool:
        """See ``Flow.has_come_to``."""
        return self._flow.has_come_to(wanted, line)

    @property
    def called_in(self) -> int:
        """The program's line that called what is carried out; 0: it stands in the program."""
        calls = self._flow.calls()
        return calls[-1][1] if calls else 0

    @property
    def modal(self) -> Modal:
        """What is in force behind the last line that was read; changes with the next."""
        return self._modal

    @property
    def text(self) -> str:
        """That line itself."""
        return self._text

    @property
    def frame(self) -> WorkFrame:
        """The work frame in force there; replaced whole when it changes."""
        return self._motion.coordinates.frame

    def stands(self, position_mm: Point, kept: Mapping[int, float], unreferenced: str) -> None:
        """So the machine stands by now; while there is no line (``NOT_YET``).

        Args:
            position_mm: machine coordinates.
            kept: persistent parameters.
            unreferenced: as in ``Setup``.
        """
        self.parameters.take_up(kept)
        self._motion.coordinates.read_anew()
        self._motion.stands(position_mm, unreferenced)
        self._modal.tool = int(kept.get(TOOL_NUMBER, 0.0))

    @property
    def position_mm(self) -> Point:
        """Where the machine stands after the moves so far."""
        return self._motion.machine

    # Line by line

    def _lines(self, refused: Refused) -> Generator[Move, Facts | None, None]:
        flow = self._flow
        motion, parameters = self._motion, self.parameters
        changes = parameters.changes
        quiet = 0
        while not self._outputs.ended:
            text = flow.next()
            if text is None:
                break
            if text is NOT_YET:
                yield Breath(motion.line)
                changes, quiet = parameters.changes, 0
                continue
            motion.line = flow.source.line
            self._text = text
            if not self._begun:
                text = text.removeprefix("\ufeff")
            if "%" in text and text.strip() == "%" and not flow.call_level:
                if self._begun or flow.source.is_framed:
                    flow.end_of_tape()
                    break
                flow.source.is_framed = True
                continue
            quiet += 1
            if quiet > _LINES_A_BREATH:
                quiet = 0
                yield Breath(motion.line)
            try:
                for move in self._line(text):
                    quiet = 0
                    if parameters.changes != changes:
                        changes = parameters.changes
                        yield Offsets(motion.line)
                    facts = yield move
                    if facts is not None or type(move) in BARRIERS:
                        self._answer(move, facts)
                    if flow.idle_lines and self._gets_on(move):
                        flow.idle_lines = 0
            except ProgramError as error:
                if self._branches(text) or not refused(self._with_place(error)):
                    raise
        if not self._outputs.ended:
            yield from self._cutter.through(self._outputs.end(max(flow.source.line, 1)))

    def _gets_on(self, move: Move) -> bool:
        """Whether a loop that makes this move gets somewhere: it goes to another place."""
        if isinstance(move, Rapid | Feed | Probe):
            before, self._last_to = self._last_to, move.to
            return before != move.to
        return isinstance(move, Arc) or type(move) in BARRIERS

    def _line(self, text: str) -> Moves:
        """Read a line and carry it out; nothing for an empty one."""
        if len(text) > MAX_LINE:
            raise ProgramError(
                phrase("the line is longer than {max_line} characters", max_line=MAX_LINE)
            )
        comment = ""
        if "(" in text or ";" in text:
            text, comment = words.strip_comments(text)
        text = words.squeeze(text)
        first = text[:1]
        if first == "/":
            if self.setup.block_delete:
                return ()
            text = text[1:]
            first = text[:1]
        if first == "n" or first == ":":
            text = words.strip_line_number(text)
            first = text[:1]
        if first == "o" or (first == "m" and SUBPROGRAM.match(text)):
            return self._o_word(text)
        if not text and not comment:
            return ()
        return self._execute(text, comment)

    @staticmethod
    def _branches(text: str) -> bool:
        """Without this line nobody knows where the program goes on."""
        squeezed = words.squeeze(text).lstrip("/")
        return squeezed.startswith("o") or SUBPROGRAM.match(squeezed) is not None

    def _o_word(self, text: str) -> Moves:
        self._begun = True
        flow = self._flow
        level = flow.call_level
        word = flow.take(text)
        if flow.over:
            return self._cutter.through(self._outputs.end(self._motion.line))
        # M99 leaves even where it begins the next repetition.
        if flow.call_level < level or word.keyword == "m99":
            return self._cutter.through(self._settings.leave(self._motion.line, level))
        return ()

    def _execute(self, text: str, comment: str) -> Moves:
        """Carry out a line."""
        self._begun = self._begun or bool(text.strip("("))
        try:
            block = self._reader.read(text, comment)
            words.complete(block, self._modal.motion)
        except ProgramError as error:
            raise explained(self._text, error) from error
        if self._cutter.acts or "cutter" in block.codes:
            return self._beside(block)
        if block.absent:
            return self._in_order(block)
        given = block.words
        if block.codes or block.comment or "s" in given or "t" in given:
            return self._in_order(block)
        if "f" in given:
            self._settings.feed(given["f"])
        return self._motion.move(block)

    def _beside(self, block: Block) -> Moves:
        """Carry out a block whose moves are compensated, or begin or end to be."""
        code = block.codes.get("cutter", 0)
        if code in CUTTER_ON or (self._cutter.side is not None and code != 400):
            system = self._motion.coordinates.frame.system
            cutterwords.check(block, self._modal, system)
        return self._cutter.through(self._in_order(block))

    def _in_order(self, block: Block) -> Iterator[Move]:
        if block.comment:
            yield from self._message(block.comment)
        for letter in block.absent.upper():
            said = phrase(
                "{letter}0 is passed over: this machine has no axis {letter}", letter=letter
            )
            yield from self._notes.once(self._motion.line, said)
        present = {**block.words, **block.codes}
        for entry in ORDER:
            if entry in present:
                yield from self._handlers[entry](block, present[entry])
            elif entry == "motion":
                yield from self._motion.move(block)
            elif entry == "dwell" and present.get("nonmodal") == 40:
                yield from self._outputs.dwell(block)

    def _answer(self, move: Move, facts: Facts | None) -> None:
        if isinstance(move, Probe):
            self._motion.probed(move, facts)
        elif facts is not None:
            if facts.parameters and self._cutter.acts:
                # A move that was read already waits with the offsets of before.
                raise ProgramError(
                    phrase(
                        "work offsets were changed by hand while cutter compensation was on:"
                        " end it (G40) before a stop at which a tool is touched off"
                    )
                )
            self._motion.coordinates.take_up(facts.parameters)
            if not self._cutter.acts:
                self._motion.at = self._motion.coordinates.frame.to_work(facts.position_mm)

    def _message(self, comment: str) -> Moves:
        found = messages.read(comment, self.parameters)
        return () if found is None else (Message(self._motion.line, found[1], found[0]),)

    # Entries of modal.ORDER

    def _compensate(self, block: Block, value: float) -> Moves:
        code = int(value)
        if code == 400:
            self._cutter.switch_off()
            return ()
        self._cutter.switch_on(cutterwords.side_of(code, block, self._frames, self._modal))
        return ()

    def _feed(self, block: Block, value: float) -> Moves:
        self._settings.feed(value)
        return ()

    def _state(self, block: Block, value: float) -> Moves:
        code = int(value) - M_OFFSET
        return self._settings.state(code, self._motion.line, self._flow.call_level)

    def _set(self, block: Block, value: float) -> Moves:
        self._settings.set(int(value), block)
        return ()

    def _nonmodal(self, block: Block, value: float) -> Moves:
        return self._frames.nonmodal(int(value), block)


def interpret(
    lines: Iterable[str], setup: Setup | None = None
) -> Generator[Move, Facts | None, None]:
    """Yield the canonical moves of a program; see ``Interpreter``.

    Raises:
        ProgramError: a line is refused.
    """
    return Interpreter(setup).run(lines)
