"""Codes that shift the program's coordinates: work offsets, G92, tool lengths, homes.

Whatever shifts them leaves the machine where it is, so the position is carried over through
machine coordinates.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.canon import Move, Rapid
from fraese.gcode.expressions import whole
from fraese.gcode.offsets import HOMES
from fraese.gcode.position import Position
from fraese.gcode.words import Block
from fraese.phrases import phrase
from fraese.tooldata import MOST_CHANGED, ToolData, as_parameters, changed_tools
from fraese.workframe import G92_OFFSET, Point

# The system whose offset G10 L11 measures against.
FIXTURE_SYSTEM: Final = 9


class Frames:
    """The coordinates' setters, and the tool table."""

    def __init__(self, position: Position, tools: Mapping[int, ToolData] | None) -> None:
        self._position = position
        self._modal = position.modal
        self._coordinates = position.coordinates
        self._any_tool = tools is None
        self._configured = tools or {}
        changed = changed_tools(self._coordinates.kept, self._configured)
        self._tools = {**self._configured, **changed}
        self._changed = set(changed)

    def nonmodal(self, code: int, block: Block) -> Iterable[Move]:
        """A code of the non-modal group; G4 and G53 are seen to elsewhere.

        Raises:
            ProgramError: a word it needs is missing or wrong.
        """
        handler = _NONMODAL.get(code)
        return () if handler is None else handler(self, code, block)

    def shift(self, change: Callable[[], None]) -> None:
        """Change offsets while the machine stays where it is."""
        position = self._position
        machine = self._coordinates.frame.to_machine(position.at)
        change()
        position.at = self._coordinates.frame.to_work(machine)

    def select(self, number: int) -> None:
        """Put a coordinate system into force, 1 (G54) to 9 (G59.3)."""
        # Selecting what is in force already reads nothing anew, as in LinuxCNC.
        if number != self._coordinates.frame.system:
            self.shift(lambda: self._coordinates.select(number))

    def set_tool_offset(self, offset_mm: Point) -> None:
        """Put a tool offset into force."""
        self.shift(lambda: self._coordinates.set_tool(offset_mm))

    def no_length(self) -> None:
        """G49."""
        self.set_tool_offset(self._coordinates.nothing)

    def length(self, block: Block) -> None:
        """G43: the length of a tool by H, or of the one in the spindle.

        Raises:
            ProgramError: there is no such tool.
        """
        self.set_tool_offset(self._offset_of(block))

    def added_length(self, block: Block) -> None:
        """G43.2: one more length on top.

        Raises:
            ProgramError: there is no H word, or no such tool.
        """
        if "h" not in block.words:
            raise ProgramError(phrase("G43.2 needs an H word"))
        old, more = self._coordinates.frame.tool, self._offset_of(block)
        self.set_tool_offset(tuple(a + b for a, b in zip(old, more, strict=True)))

    def dynamic_length(self, block: Block) -> None:
        """G43.1: the axis words themselves."""
        self.set_tool_offset(self._position.given(block, self._coordinates.frame.tool))

    def _offset_of(self, block: Block) -> Point:
        word = block.words.get("h")
        number = 0 if word is None else whole(word, phrase("the H word"))
        if number < 0:
            raise ProgramError(phrase("the H word must not be negative"))
        # H0 is whatever is in the spindle.
        number = number or self._modal.tool
        self.check_tool(number)
        return self._offset_in_table(number)

    def check_tool(self, number: int) -> None:
        """See that a tool number can be used.

        Raises:
            ProgramError: it is negative, or the tool table does not know it.
        """
        if number < 0:
            raise ProgramError(phrase("a tool number must not be negative"))
        if number and not self._any_tool and number not in self._tools:
            raise ProgramError(phrase("tool {number} is not in the tool table", number=number))

    def put_in(self, number: int) -> None:
        """A tool is in the spindle; so it is for the next program."""
        self._modal.tool = number
        self._coordinates.set_tool_number(number)

    def _offset_in_table(self, number: int) -> Point:
        return self.tool_data(number).offset(self._coordinates.axes)

    def tool_data(self, number: int) -> ToolData:
        """What is known of a tool; nothing is 0."""
        return self._tools.get(number, ToolData())

    def diameter_mm(self, number: int, user: str) -> float:
        """Diameter of a tool, by the tool table.

        Raises:
            ProgramError: it is not in the table, or there is none.
        """
        if self._any_tool and number not in self._tools:
            raise ProgramError(
                phrase(
                    "{user} needs the diameter of a tool, and there is no tool table; give"
                    " the diameter itself by {user}.1 D",
                    user=user,
                )
            )
        self.check_tool(number)
        return self.tool_data(number).diameter_mm

    def _axis_words(self, block: Block) -> dict[str, float]:
        """The axis words in mm by axis."""
        units = self._position.axes.units[self._modal.scale_mm]
        return {
            letter: block.words[letter] * unit
            for letter, (_, unit) in units.items()
            if letter in block.words
        }

    # Non-modal codes

    def _g10(self, code: int, block: Block) -> Iterable[Move]:
        kind = block.words.get("l")
        handler = None if kind is None else _G10.get(whole(kind, "the L word"))
        if handler is None:
            raise ProgramError(phrase("G10 needs L1, L2, L10, L11 or L20"))
        handler(self, block)
        return ()

    def _system_word(self, block: Block) -> int:
        if "i" in block.words or "j" in block.words:
            raise ProgramError(phrase("G10 L2 and L20 take no I and J words"))
        number = whole(block.words.get("p", -1.0), phrase("the P word of G10"))
        if not 0 <= number <= 9:
            raise ProgramError(
                phrase("G10 needs P0 for the active system, or P1 (G54) to P9 (G59.3)")
            )
        return number or self._coordinates.frame.system

    def _set_system(self, block: Block) -> None:
        system = self._system_word(block)
        values = self._axis_words(block)
        rotation = block.words.get("r")
        if rotation:
            # A turn about Z needs both axes that it turns.
            self._position.axes.plane(17, "G10 L2 R")
        self.shift(lambda: self._coordinates.set_system(system, values, rotation))

    def _set_system_here(self, block: Block) -> None:
        if "r" in block.words:
            raise ProgramError(phrase("G10 L20 takes no R word; use G10 L2 to rotate"))
        self._position.depends(100, 20)
        system = self._system_word(block)
        frame = self._coordinates.of_system(system)
        wanted = self._position.given(block, self._position.at)
        offset = frame.offset_for(self._position.machine, wanted)
        moved = frame.moved_with(self._axis_words(block))
        values = {
            letter: value
            for letter, value in zip(frame.axes, offset, strict=True)
            if letter in moved
        }
        self.shift(lambda: self._coordinates.set_system(system, values, None))

    def _tool_word(self, block: Block) -> int:
        number = whole(block.words.get("p", 0.0), phrase("the P word of G10"))
        if number < 1:
            raise ProgramError(phrase("G10 needs a P word: the number of the tool"))
        self.check_tool(number)
        return number

    def _set_tool(self, block: Block, number: int, offset_mm: Point) -> None:
        offsets = dict(zip(self._coordinates.axes, offset_mm, strict=True))
        radius = block.words.get("r")
        diameter_mm = (
            self.tool_data(number).diameter_mm
            if radius is None
            else 2 * radius * self._modal.scale_mm
        )
        self._tools[number] = tool = ToolData(offsets.pop("z", 0.0), diameter_mm, offsets)
        self._changed.add(number)
        if len(self._changed) > MOST_CHANGED:
            raise ProgramError(
                phrase(
                    "programs may change {most} tools of the table, and this is one more: put them"
                    " into the configuration ([tools])",
                    most=MOST_CHANGED,
                )
            )
        configured = self._configured.get(number, ToolData())
        self._coordinates.keep(as_parameters(number, tool, configured))

    def _tool_offset(self, block: Block) -> None:
        number = self._tool_word(block)
        self._set_tool(block, number, self._position.given(block, self._offset_in_table(number)))

    def _tool_here(self, block: Block, fixture: int = 0) -> None:
        """The offset with which the present place reads as the axis words."""
        number = self._tool_word(block)
        self._position.depends(100, 11 if fixture else 10)
        machine = self._position.machine
        offset_mm = self._coordinates.tool_offset_at(
            machine, self._axis_words(block), self._offset_in_table(number), fixture
        )
        self._set_tool(block, number, offset_mm)

    def _tool_at_fixture(self, block: Block) -> None:
        """The same, in the ninth system without G92."""
        self._tool_here(block, FIXTURE_SYSTEM)

    def _home(self, code: int, block: Block) -> Iterator[Move]:
        position = self._position
        coordinates = self._coordinates
        given = [letter in block.words for letter in coordinates.axes]
        homed = self._moved_home(given)
        position.require_reference(homed, code)
        position.at = position.target(block)
        position.fix(homed)
        yield Rapid(position.line, position.machine)
        # Single axes go home along the program's axes, which a rotation has turned.
        stored = coordinates.frame.to_work(coordinates.read(HOMES[code]))
        every = not any(given)
        position.at = tuple(
            home if every or chosen else old
            for home, chosen, old in zip(stored, given, position.at, strict=True)
        )
        yield Rapid(position.line, position.machine, "z" in homed)

    def _moved_home(self, given: Sequence[bool]) -> list[str]:
        """Letters of the machine's axes that G28 and G30 move: those that are given, or all."""
        axes = self._coordinates.axes
        chosen = {letter for letter, is_given in zip(axes, given, strict=True) if is_given}
        return sorted(self._coordinates.frame.moved_with(chosen or axes))

    def _store_home(self, code: int, block: Block) -> Iterable[Move]:
        self._position.depends(code)
        self._coordinates.write(HOMES[code], self._position.machine)
        return ()

    def _g92(self, code: int, block: Block) -> Iterable[Move]:
        if not block.has_axes:
            raise ProgramError(phrase("G92 needs an axis word"))
        self._position.depends(code)
        position = self._position
        at = position.at
        wanted = self._position.given(block, at)
        old = self._coordinates.frame.g92
        offset = tuple(o + a - w for o, a, w in zip(old, at, wanted, strict=True))
        self.shift(lambda: self._coordinates.set_g92(offset, active=True))
        return ()

    def _g52(self, code: int, block: Block) -> Iterable[Move]:
        if not block.has_axes:
            raise ProgramError(phrase("G52 needs an axis word"))
        offset = self._position.given(block, self._coordinates.frame.g92)
        self.shift(lambda: self._coordinates.set_g92(offset, active=True))
        return ()

    def _g92_off(self, code: int, block: Block) -> Iterable[Move]:
        nothing = self._coordinates.nothing
        self.shift(lambda: self._coordinates.set_g92(nothing, active=False, keep=code == 922))
        return ()

    def _g92_on(self, code: int, block: Block) -> Iterable[Move]:
        stored = self._coordinates.read(G92_OFFSET)
        self.shift(lambda: self._coordinates.set_g92(stored, active=True, keep=True))
        return ()


_NONMODAL: Final[dict[int, Callable[[Frames, int, Block], Iterable[Move]]]] = {
    100: Frames._g10,
    280: Frames._home,
    300: Frames._home,
    281: Frames._store_home,
    301: Frames._store_home,
    520: Frames._g52,
    920: Frames._g92,
    921: Frames._g92_off,
    922: Frames._g92_off,
    923: Frames._g92_on,
}
_G10: Final[dict[int, Callable[[Frames, Block], None]]] = {
    1: Frames._tool_offset,
    2: Frames._set_system,
    10: Frames._tool_here,
    11: Frames._tool_at_fixture,
    20: Frames._set_system_here,
}
