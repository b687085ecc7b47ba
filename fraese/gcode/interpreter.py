"""The interpreter: lines of a program in, canonical moves out.

Rule 1  Lines are read when moves are asked for; nothing is read ahead but for O-words.
Rule 2  Whatever a line does takes effect in the order of ``modal.ORDER``; each entry there
        has one method here.
Rule 3  Behind a barrier (probe, pause, tool change) the position is what the outside says.
        ``None`` says "as commanded": a probe then touches at its target.
Rule 4  Whatever is wrong with a program ends in a ProgramError with file and line.
"""

from collections.abc import Callable, Generator, Iterable, Iterator
from typing import Final, Literal, cast

from fraese.errors import ProgramError
from fraese.gcode import messages, modal, named, words
from fraese.gcode.canon import (
    BARRIERS,
    Coolant,
    Dwell,
    End,
    Facts,
    Message,
    Move,
    Overrides,
    PathControl,
    PathMode,
    Pause,
    Point,
    Probe,
    Spindle,
    Tool,
)
from fraese.gcode.expressions import whole
from fraese.gcode.modal import M_OFFSET, ORDER, Modal
from fraese.gcode.motion import Motion
from fraese.gcode.offsets import Coordinates
from fraese.gcode.oword import Flow
from fraese.gcode.parameters import Parameters
from fraese.gcode.settings import Settings
from fraese.gcode.setup import ModalState, Setup
from fraese.gcode.source import Source
from fraese.gcode.text import MAX_LINE
from fraese.gcode.words import Block, BlockReader

Moves = Iterable[Move]
MAX_DWELL_S: Final = 1e7


class Interpreter:
    """One run of one program.

    Args:
        setup: what the program finds.
    """

    def __init__(self, setup: Setup | None = None) -> None:
        self.setup = setup = setup or Setup()
        self.parameters = Parameters(setup.parameters)
        self._modal = Modal(tool=setup.tool, scale_mm=25.4 if setup.inches else 1.0)
        self._coordinates = Coordinates(self.parameters)
        self._motion = Motion(self.parameters, self._coordinates, self._modal)
        self._motion.at = self._coordinates.to_program(setup.position_mm)
        self._settings = Settings(self._modal, self._motion, setup.tools)
        self._reader = BlockReader(self.parameters)
        self._flow = Flow(Source((), setup.file), self.parameters, setup.folders, 0)
        self._ended = False
        # what was in force before the first line that was not skipped
        self.start_state: ModalState | None = None
        named.install(self)

    def run(self, lines: Iterable[str], start_line: int = 1) -> Generator[Move, Facts | None, None]:
        """Yield the program's moves; answer each barrier with ``send``.

        Args:
            lines: the program's lines, with or without their ends.
            start_line: where to begin. The lines before it are carried out as commanded, but
                their moves are not yielded; ``start_state`` then says what is in force there.

        Raises:
            ProgramError: a line is refused.
        """
        source = Source(lines, self.setup.file)
        self._flow = Flow(source, self.parameters, self.setup.folders, self.setup.max_idle_lines)
        try:
            yield from self._lines(start_line)
        except ProgramError as error:
            now = self._flow.source
            line = error.line or max(now.line, 1)
            raise ProgramError(error.message, line, error.file or now.file) from error

    def modal_state(self) -> ModalState:
        """What is in force behind the last line that was read."""
        m, c = self._modal, self._coordinates
        return ModalState(
            line=self._flow.source.line,
            motion="" if m.motion is None else modal.name(m.motion),
            plane=m.plane,
            inches=m.scale_mm != 1.0,
            absolute=m.absolute,
            arc_absolute=m.arc_absolute,
            inverse_time=m.inverse_time,
            feed_mm_min=m.feed_mm_min,
            spindle=m.spindle,
            rev_min=m.rev_min,
            mist=m.mist,
            flood=m.flood,
            tool=m.tool,
            selected_tool=m.selected_tool,
            tool_offset_mm=c.tool,
            work_offset=c.system,
            work_offset_mm=c.work,
            rotation_deg=c.rotation_deg,
            g92_offset_mm=c.g92,
            retract_to_start=m.retract_to_start,
            path_mode=m.path_mode,
            tolerance_mm=m.tolerance_mm,
            overrides=m.overrides,
            position_mm=self.position_mm,
        )

    @property
    def position_mm(self) -> Point:
        """Where the machine stands after the moves so far."""
        return self._coordinates.to_machine(self._motion.at)

    # Line by line

    def _lines(self, start_line: int) -> Generator[Move, Facts | None, None]:
        flow = self._flow
        motion = self._motion
        started = False
        percent = False
        blank = True
        while not self._ended:
            text = flow.next()
            if text is None:
                break
            motion.line = line = flow.source.line
            if not started and line >= start_line and not flow.call_level:
                started = True
                self.start_state = self.modal_state()
            if blank and text.strip():
                blank = False
                text = text.removeprefix("\ufeff")
                if text.strip() == "%":
                    percent = True
                    continue
            if percent and text.strip() == "%":
                break
            for move in self._line(text):
                facts = (yield move) if started else None
                if type(move) in BARRIERS:
                    self._answer(move, facts)
                flow.idle_lines = 0
        if not started and start_line > 1:
            raise ProgramError(f"the program ends before line {start_line}")
        if not self._ended:
            yield from self._end(max(flow.source.line, 1))

    def _line(self, text: str) -> Moves:
        """Read a line and carry it out; nothing for an empty one."""
        if len(text) > MAX_LINE:
            raise ProgramError(f"the line is longer than {MAX_LINE} characters")
        comment = ""
        if "(" in text or ";" in text:
            text, comment = words.strip_comments(text)
        text = words.squeeze(text)
        if text[:1] == "/":
            if self.setup.block_delete:
                return ()
            text = text[1:]
        if text[:1] == "n":
            text = words.strip_line_number(text)
        if text[:1] == "o":
            return self._o_word(text)
        if not text and not comment:
            return ()
        return self._execute(self._reader.read(text, comment))

    def _o_word(self, text: str) -> Moves:
        flow = self._flow
        level = flow.call_level
        flow.do(flow.read(text))
        if flow.call_level < level:
            return self._settings.leave(self._motion.line, level)
        return ()

    def _execute(self, block: Block) -> Moves:
        """Carry out a block."""
        words.complete(block, self._modal.motion)
        given = block.words
        if block.codes or block.comment or "s" in given or "t" in given:
            return self._in_order(block)
        if "f" in given:
            self._settings.feed(given["f"])
        return self._motion.move(block)

    def _in_order(self, block: Block) -> Iterator[Move]:
        if block.comment:
            yield from self._message(block.comment)
        present = {**block.words, **block.codes}
        for entry in ORDER:
            if entry in present:
                yield from _PHASES[entry](self, block, present[entry])
            elif entry == "motion":
                yield from self._motion.move(block)
            elif entry == "dwell" and present.get("nonmodal") == 40:
                yield from self._dwell(block)

    def _answer(self, move: Move, facts: Facts | None) -> None:
        if isinstance(move, Probe):
            self._motion.probed(move, facts)
        elif facts is not None:
            self._motion.at = self._coordinates.to_program(facts.position_mm)

    def _message(self, comment: str) -> Moves:
        found = messages.read(comment, self.parameters)
        return () if found is None else (Message(self._motion.line, found[1], found[0]),)

    # Phases: what a line's entries do, in the order of modal.ORDER

    def _dwell(self, block: Block) -> Moves:
        duration_s = block.words.get("p")
        if duration_s is None or not 0 <= duration_s <= MAX_DWELL_S:
            raise ProgramError(f"G4 needs a P word: seconds from 0 to {MAX_DWELL_S:g}")
        return (Dwell(self._motion.line, duration_s),)

    def _feed(self, block: Block, value: float) -> Moves:
        self._settings.feed(value)
        return ()

    def _speed(self, block: Block, value: float) -> Moves:
        if value < 0:
            raise ProgramError("the S word must not be negative; use M4 for the other direction")
        m = self._modal
        m.rev_min = value
        # Where the spindle code is on the same line, it says the new speed itself.
        if m.spindle and "spindle" not in block.codes:
            return (self._spindle_now(),)
        return ()

    def _spindle_now(self) -> Spindle:
        m = self._modal
        return Spindle(self._motion.line, cast(Literal[-1, 0, 1], m.spindle), m.rev_min)

    def _select_tool(self, block: Block, value: float) -> Moves:
        number = whole(value, "the T word")
        self._settings.check_tool(number)
        self._modal.selected_tool = number
        return ()

    def _tool_change(self, block: Block, value: float) -> Moves:
        m = self._modal
        if value == M_OFFSET + 61:
            number = whole(block.words.get("q", -1.0), "the Q word of M61")
            self._settings.check_tool(number)
            m.tool = number
            return
        if m.spindle:
            m.spindle = 0
            yield self._spindle_now()
        yield Tool(self._motion.line, m.selected_tool)
        m.tool = m.selected_tool

    def _spindle(self, block: Block, value: float) -> Moves:
        selected = block.words.get("$", 0.0)
        if selected not in (0.0, -1.0):
            raise ProgramError(f"there is no spindle ${selected:g}; this mill has one, $0")
        self._modal.spindle = {3: 1, 4: -1, 5: 0}[int(value) - M_OFFSET]
        return (self._spindle_now(),)

    def _coolant(self, block: Block, value: float) -> Moves:
        m = self._modal
        code = int(value) - M_OFFSET
        m.mist = code == 7 or (code == 8 and m.mist)
        m.flood = code == 8 or (code == 7 and m.flood)
        return (Coolant(self._motion.line, m.mist, m.flood),)

    def _override(self, block: Block, value: float) -> Moves:
        code = int(value) - M_OFFSET
        if code in (48, 49):
            enabled = code == 48
        elif code == 50:
            enabled = block.words.get("p", 1.0) != 0
        else:
            # M51 to M53: there is no spindle override, adaptive feed or stop input here.
            return ()
        self._modal.overrides = enabled
        return (Overrides(self._motion.line, enabled),)

    def _path(self, block: Block, value: float) -> Moves:
        m = self._modal
        tolerance = block.words.get("p", 0.0) if value == 640 else 0.0
        m.path_mode = {610: PathMode.EXACT_PATH, 611: PathMode.EXACT_STOP, 640: PathMode.BLEND}[
            int(value)
        ]
        m.tolerance_mm = max(0.0, tolerance) * m.scale_mm
        return (PathControl(self._motion.line, m.path_mode, m.tolerance_mm),)

    def _state(self, block: Block, value: float) -> Moves:
        return self._settings.state(int(value) - M_OFFSET, self._motion.line, self._flow.call_level)

    def _set(self, block: Block, value: float) -> Moves:
        """A code that changes what is in force and nothing else."""
        self._settings.set(int(value), block)
        return ()

    def _nonmodal(self, block: Block, value: float) -> Moves:
        return self._settings.nonmodal(int(value), block)

    def _stop(self, block: Block, value: float) -> Moves:
        code = int(value) - M_OFFSET
        if code in (2, 30):
            return self._end(self._motion.line)
        return (Pause(self._motion.line, optional=code == 1),)

    def _end(self, line: int) -> Iterator[Move]:
        """Everything off and back to the defaults, as M2 does it."""
        self._ended = True
        m = self._modal
        if not m.overrides:
            m.overrides = True
            yield Overrides(line, True)
        if m.spindle:
            m.spindle = 0
            yield Spindle(line, 0, m.rev_min)
        if m.mist or m.flood:
            m.mist = m.flood = False
            yield Coolant(line, False, False)
        self._settings.reset()
        yield End(line)


Phase = Callable[[Interpreter, Block, float], Moves]
_PHASES: Final[dict[str, Phase]] = {
    "f": Interpreter._feed,
    "s": Interpreter._speed,
    "t": Interpreter._select_tool,
    "state": Interpreter._state,
    "tool_change": Interpreter._tool_change,
    "spindle": Interpreter._spindle,
    "coolant": Interpreter._coolant,
    "override": Interpreter._override,
    "path": Interpreter._path,
    "nonmodal": Interpreter._nonmodal,
    "stop": Interpreter._stop,
    **dict.fromkeys(
        (
            "feed_mode",
            "spindle_mode",
            "plane",
            "units",
            "cutter",
            "length",
            "system",
            "distance",
            "arc_distance",
            "retract",
            "cancel",
            "lathe",
        ),
        Interpreter._set,
    ),
}


def interpret(
    lines: Iterable[str], setup: Setup | None = None
) -> Generator[Move, Facts | None, None]:
    """Yield the canonical moves of a program; see ``Interpreter``.

    Raises:
        ProgramError: a line is refused.
    """
    return Interpreter(setup).run(lines)
