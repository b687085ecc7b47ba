"""What a program says to the machine besides motion: spindle, coolant, tools, pauses, its end.

Each method carries out one entry of ``modal.ORDER`` for a block and returns its moves.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Final, Literal, cast

from fraese.errors import ProgramError
from fraese.gcode.canon import (
    Coolant,
    Dwell,
    End,
    Move,
    Overrides,
    PathControl,
    PathMode,
    Pause,
    Spindle,
    Tool,
)
from fraese.gcode.expressions import whole
from fraese.gcode.frames import Frames
from fraese.gcode.messages import Notes
from fraese.gcode.modal import M_OFFSET
from fraese.gcode.motion import Motion
from fraese.gcode.settings import Settings
from fraese.gcode.userwords import Call, Word, carried_out, no_word
from fraese.gcode.words import Block
from fraese.phrases import phrase

Moves = Iterable[Move]
Handler = Callable[[Block, float], Moves]
MAX_DWELL_S: Final = 1e7
_PATHS: Final = {610: PathMode.EXACT_PATH, 611: PathMode.EXACT_STOP, 640: PathMode.BLEND}


class Outputs:
    """The codes that act on the machine without moving it."""

    def __init__(
        self,
        motion: Motion,
        frames: Frames,
        settings: Settings,
        notes: Notes,
        ignored: frozenset[int] = frozenset(),
        user_word: Callable[[int], Word | None] = no_word,
        remark: Callable[[], str] = str,
    ) -> None:
        self._motion = motion
        self._modal = motion.modal
        self._frames = frames
        self._settings = settings
        self._notes = notes
        self._ignored = ignored
        self._user_word = user_word
        # what was asked for already
        self._words: dict[int, Word | None] = {}
        # what is said beside the codes of the line in hand
        self._remark = remark
        # whether the program has come to its end
        self.ended = False

    def handlers(self) -> dict[str, Handler]:
        """What to call for which entry of ``modal.ORDER``."""
        return {
            "s": self._speed,
            "t": self._select_tool,
            "tool_change": self._tool_change,
            "spindle": self._spindle,
            "coolant": self._coolant,
            "override": self._override,
            "user": self._user,
            "path": self._path,
            "stop": self._stop,
        }

    def dwell(self, block: Block) -> Moves:
        """G4.

        Raises:
            ProgramError: it has no time.
        """
        duration_s = block.words.get("p")
        if duration_s is None or not 0 <= duration_s <= MAX_DWELL_S:
            raise ProgramError(
                phrase(
                    "G4 needs a P word: seconds from 0 to {max_dwell_s:g}", max_dwell_s=MAX_DWELL_S
                )
            )
        return (Dwell(self._motion.line, duration_s),)

    def _speed(self, block: Block, value: float) -> Moves:
        if value < 0:
            raise ProgramError(
                phrase("the S word must not be negative; use M4 for the other direction")
            )
        m = self._modal
        m.rev_min, m.has_speed = value, True
        # Where the spindle code is on the same line, it says the new speed itself.
        if m.spindle and "spindle" not in block.codes:
            return (self._spindle_now(),)
        return ()

    def _spindle_now(self) -> Spindle:
        m = self._modal
        direction = cast(Literal[-1, 0, 1], m.spindle)
        return Spindle(self._motion.line, direction, m.rev_min, m.has_speed)

    def _select_tool(self, block: Block, value: float) -> Moves:
        number = whole(value, phrase("the T word"))
        self._frames.check_tool(number)
        self._modal.selected_tool = number
        return ()

    def _tool_change(self, block: Block, value: float) -> Moves:
        m = self._modal
        if value == M_OFFSET + 61:
            number = whole(block.words.get("q", -1.0), phrase("the Q word of M61"))
            self._frames.check_tool(number)
            self._frames.put_in(number)
            return
        if m.spindle:
            m.spindle = 0
            yield self._spindle_now()
        yield Tool(self._motion.line, m.selected_tool, self._remark())
        self._frames.put_in(m.selected_tool)

    def _spindle(self, block: Block, value: float) -> Moves:
        selected = block.words.get("$", 0.0)
        if selected not in (0.0, -1.0):
            raise ProgramError(
                phrase(
                    "there is no spindle ${selected:g}; this mill has one, $0", selected=selected
                )
            )
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

    def _user(self, block: Block, value: float) -> Moves:
        code = int(value) - M_OFFSET
        if code not in self._words:
            self._words[code] = self._user_word(code)
        word = self._words[code]
        if word is not None:
            p, q = block.words.get("p"), block.words.get("q")
            return carried_out(word, Call(self._motion.line, code, p, q))
        if code not in self._ignored:
            raise ProgramError(
                phrase(
                    "M{code} is a user's own code and has no meaning here; to pass it over,"
                    " name {code} in run.ignored_m_codes",
                    code=code,
                )
            )
        return self._notes.once(self._motion.line, phrase("M{code} is passed over", code=code))

    def _path(self, block: Block, value: float) -> Moves:
        m = self._modal
        tolerance = block.words.get("p", 0.0) if value == 640 else 0.0
        m.path_mode = _PATHS[int(value)]
        m.tolerance_mm = max(0.0, tolerance) * m.scale_mm
        return (PathControl(self._motion.line, m.path_mode, m.tolerance_mm),)

    def _stop(self, block: Block, value: float) -> Moves:
        code = int(value) - M_OFFSET
        if code in (2, 30):
            return self.end(self._motion.line)
        return (Pause(self._motion.line, optional=code == 1, remark=self._remark()),)

    def end(self, line: int) -> Iterator[Move]:
        """Everything off and back to the defaults, as M2 does it."""
        self.ended = True
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
