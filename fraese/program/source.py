"""A program file as a source of moves, of whichever kind it is."""

from collections.abc import Iterator
from contextlib import closing

from fraese.gcode.axes import Axes
from fraese.gcode.canon import Move
from fraese.gcode.coordlist import read_points
from fraese.gcode.interpreter import Interpreter, Refused
from fraese.gcode.modal import Modal
from fraese.gcode.replay import Replay
from fraese.heightmap.bend import Bend
from fraese.program.context import ProgramContext
from fraese.program.taken import Taken
from fraese.program.translate import Moves
from fraese.workframe import WorkFrame


class ProgramSource:
    """One reading of one program.

    Args:
        taken: G-code, or a list of coordinates.
        context: the machine as the program finds it.

    Attributes:
        axes: of the machine, as the language sees them.
        lines_read: so far.
        start_mm: where the machine stands before the first move.
        default_feed_mm_min: for straight moves that have none.
    """

    def __init__(self, taken: Taken, context: ProgramContext) -> None:
        self._taken = taken
        self._context = context
        self._setup = context.setup(taken)
        self._interpreter = Interpreter(self._setup)
        self.lines_read = 0
        self._last_read = ""
        self.axes = Axes(self._setup.axes, self._setup.rotary)
        self.start_mm = self._setup.position_mm
        self.default_feed_mm_min = context.config.run.default_feed_mm_min

    def moves(self, refused: Refused | None = None) -> Moves:
        """The canonical moves; barriers want an answer.

        Args:
            refused: see ``Interpreter.run``.

        Raises:
            ProgramError: a file cannot be read, or a line is refused.
        """
        heights = self._context.heights
        with closing(self._taken.main.lines()) as file_lines:
            moves = self._flat(self._counted(file_lines), refused)
            if heights is not None:
                moves = Bend(heights, self._context.site()).through(moves)
            yield from moves

    def _flat(self, lines: Iterator[str], refused: Refused | None) -> Moves:
        """As they are programmed."""
        if self._taken.kind == "gcode":
            yield from self._interpreter.run(lines, refused)
            return
        unit = self._context.config.run.list_unit
        for point in read_points(lines, self._setup, unit, self.default_feed_mm_min):
            yield point

    def only_read(self, line: int) -> Replay:
        """What comes before this line is read, and not carried out; before the first move."""
        return self._interpreter.only_read(line)

    def has_come_to(self, line: int, move: Move) -> bool:
        """Whether a move just read belongs to this line of the program, or to one behind it."""
        if self._taken.kind != "gcode":
            return move.line >= line
        return self._interpreter.has_come_to(line, move.line)

    def parameters(self) -> dict[int, float]:
        """What the program left of the persistent parameters."""
        return self._interpreter.parameters.persistent()

    @property
    def frame(self) -> WorkFrame:
        """The work frame in force behind the last line read."""
        return self._interpreter.frame

    def complaint(self, line: int, message: str) -> tuple[int, str]:
        """Line and message of what is wrong with a move just read, as seen from the program."""
        return self._interpreter.refusal(message, line).in_program(self._setup.file)

    @property
    def called_in(self) -> int:
        """The program's line that called it; 0: it was not called."""
        return self._interpreter.called_in

    @property
    def text(self) -> str:
        """That line, of whichever file it is."""
        return (self._interpreter.text or self._last_read).strip()

    @property
    def modal(self) -> Modal:
        """What else is in force there; changes with the next line."""
        return self._interpreter.modal

    def _counted(self, lines: Iterator[str]) -> Iterator[str]:
        for line in lines:
            self.lines_read += 1
            self._last_read = line
            yield line
