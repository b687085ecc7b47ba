"""Codes that set something: modes, offsets, homes, tool lengths, saved states.

Whatever moves the program's coordinates leaves the machine where it is, so the position is
carried over through machine coordinates.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Final, Literal, cast

from fraese.errors import ProgramError
from fraese.gcode.canon import Coolant, Move, Overrides, PathControl, Plane, Point, Rapid, Spindle
from fraese.gcode.expressions import whole
from fraese.gcode.modal import Modal
from fraese.gcode.motion import LETTERS, Motion
from fraese.gcode.offsets import G92_OFFSET, HOME, ORIGIN
from fraese.gcode.setup import ToolData
from fraese.gcode.words import Block

# The system whose offset G10 L11 measures against.
FIXTURE_SYSTEM: Final = 9


class Settings:
    """Setters for the modal state, the coordinates and the tool table."""

    def __init__(self, modal: Modal, motion: Motion, tools: Mapping[int, ToolData] | None) -> None:
        self._modal = modal
        self._motion = motion
        self._coordinates = motion.coordinates
        self._any_tool = tools is None
        self._tools = dict(tools or {})
        # M70 and M73 by call level; the levels that M73 restores by itself
        self._saved: dict[int, tuple[Modal, int, Point]] = {}
        self._restore_on_return: set[int] = set()

    def feed(self, value: float) -> None:
        """The F word; in G93 it belongs to its line and is read there.

        Raises:
            ProgramError: it is negative.
        """
        if value < 0:
            raise ProgramError("the F word must not be negative")
        self._modal.feed_word = value
        if not self._modal.inverse_time:
            self._modal.feed_mm_min = value * self._modal.scale_mm

    def set(self, code: int, block: Block) -> None:
        """A code that changes what is in force and nothing else.

        Raises:
            ProgramError: a word it needs is missing or wrong.
        """
        _SETTERS[code](self, block)

    def nonmodal(self, code: int, block: Block) -> Iterable[Move]:
        """A code of the non-modal group; G4 and G53 are seen to elsewhere.

        Raises:
            ProgramError: a word it needs is missing or wrong.
        """
        handler = _NONMODAL.get(code)
        return () if handler is None else handler(self, code, block)

    def reset(self) -> None:
        """What M2 and M30 do: G54, G17, G90, G94, G1, no offset that is not stored."""
        m = self._modal
        m.plane, m.absolute, m.inverse_time, m.motion = 17, True, False, 10
        m.feed_mm_min = 0.0
        self._motion.forget_cycle()
        with_position = self._motion.coordinates.to_machine(self._motion.at)
        self._coordinates.select(1)
        self._motion.at = self._coordinates.to_program(with_position)

    # Modes

    def _feed_mode(self, inverse_time: bool) -> None:
        if inverse_time != self._modal.inverse_time:
            self._modal.inverse_time = inverse_time
            # A number per minute is no feed, and a feed no number per minute.
            self._modal.feed_mm_min = self._modal.feed_word = 0.0

    def _cancel(self, block: Block) -> None:
        if block.motion is None:
            self._modal.motion = None
            self._motion.forget_cycle()

    # Offsets

    def _shift(self, change: Callable[[], None]) -> None:
        """Change offsets while the machine stays where it is."""
        motion = self._motion
        machine = self._coordinates.to_machine(motion.at)
        change()
        self._coordinates.update()
        motion.at = self._coordinates.to_program(machine)

    def _system(self, number: int) -> None:
        # Selecting what is in force already reads nothing anew, as in LinuxCNC.
        if number != self._coordinates.system:
            self._shift(lambda: self._coordinates.select(number))

    def _tool_offset(self, offset_mm: Point) -> None:
        def change() -> None:
            self._coordinates.tool = offset_mm

        self._shift(change)

    def _length(self, block: Block) -> None:
        self._tool_offset((0.0, 0.0, self._length_of(block)))

    def _added_length(self, block: Block) -> None:
        if "h" not in block.words:
            raise ProgramError("G43.2 needs an H word")
        x, y, z = self._coordinates.tool
        self._tool_offset((x, y, z + self._length_of(block)))

    def _dynamic_length(self, block: Block) -> None:
        self._tool_offset(self._given(block, self._coordinates.tool))

    def _length_of(self, block: Block) -> float:
        word = block.words.get("h")
        number = 0 if word is None else whole(word, "the H word")
        if number < 0:
            raise ProgramError("the H word must not be negative")
        # H0 is whatever is in the spindle.
        number = number or self._modal.tool
        self.check_tool(number)
        return self._tools.get(number, ToolData()).length_mm

    def check_tool(self, number: int) -> None:
        """See that a tool number can be used.

        Raises:
            ProgramError: it is negative, or the tool table does not know it.
        """
        if number < 0:
            raise ProgramError("a tool number must not be negative")
        if number and not self._any_tool and number not in self._tools:
            raise ProgramError(f"tool {number} is not in the tool table")

    def tool_data(self, number: int) -> ToolData:
        """What is known of a tool; nothing is 0."""
        return self._tools.get(number, ToolData())

    def _given(self, block: Block, otherwise: Point) -> Point:
        """The axis words in mm, or what holds where there is none."""
        scale = self._modal.scale_mm
        x, y, z = (
            block.words[letter] * scale if letter in block.words else old
            for letter, old in zip(LETTERS, otherwise, strict=True)
        )
        return x, y, z

    # Non-modal codes

    def _g10(self, code: int, block: Block) -> Iterable[Move]:
        kind = block.words.get("l")
        handler = None if kind is None else _G10.get(whole(kind, "the L word"))
        if handler is None:
            raise ProgramError("G10 needs L1, L2, L10, L11 or L20")
        handler(self, block)
        return ()

    def _system_word(self, block: Block) -> int:
        number = whole(block.words.get("p", -1.0), "the P word of G10")
        if not 0 <= number <= 9:
            raise ProgramError("G10 needs P0 for the active system, or P1 (G54) to P9 (G59.3)")
        return number or self._coordinates.system

    def _set_system(self, block: Block) -> None:
        system = self._system_word(block)
        scale = self._modal.scale_mm
        values = {
            axis: block.words[letter] * scale
            for axis, letter in enumerate(LETTERS)
            if letter in block.words
        }
        rotation = block.words.get("r")
        self._shift(lambda: self._coordinates.set_system(system, values, rotation))

    def _set_system_here(self, block: Block) -> None:
        if "r" in block.words:
            raise ProgramError("G10 L20 takes no R word; use G10 L2 to rotate")
        system = self._system_word(block)
        here = self._coordinates.to_machine(self._motion.at)
        given = {i for i, letter in enumerate(LETTERS) if letter in block.words}
        values = self._coordinates.offset_at(
            system, here, self._given(block, self._motion.at), given
        )
        self._shift(lambda: self._coordinates.set_system(system, values, None))

    def _tool_word(self, block: Block) -> int:
        number = whole(block.words.get("p", 0.0), "the P word of G10")
        if number < 1:
            raise ProgramError("G10 needs a P word: the number of the tool")
        self.check_tool(number)
        return number

    def _set_tool(self, block: Block, length_mm: float) -> None:
        number = self._tool_word(block)
        old = self._tools.get(number, ToolData())
        radius = block.words.get("r")
        diameter_mm = old.diameter_mm if radius is None else 2 * radius * self._modal.scale_mm
        self._tools[number] = ToolData(length_mm, diameter_mm)

    def _tool_length(self, block: Block) -> None:
        number = self._tool_word(block)
        old = self._tools.get(number, ToolData()).length_mm
        self._set_tool(block, self._given(block, (0.0, 0.0, old))[2])

    def _tool_here(self, block: Block) -> None:
        """Length that makes the present height read as the Z word."""
        machine = self._coordinates.to_machine(self._motion.at)
        c = self._coordinates
        wanted = self._given(block, (0.0, 0.0, 0.0))[2]
        self._set_tool(block, machine[2] - c.work[2] - c.g92[2] - wanted)

    def _tool_at_fixture(self, block: Block) -> None:
        """The same, in the ninth system without G92."""
        c = self._coordinates
        machine = c.to_machine(self._motion.at)
        fixture = c.read(c.first_parameter(FIXTURE_SYSTEM))
        wanted = self._given(block, (0.0, 0.0, 0.0))[2]
        self._set_tool(block, machine[2] - fixture[2] - wanted)

    def _home(self, code: int, block: Block) -> Iterator[Move]:
        motion = self._motion
        coordinates = self._coordinates
        given = [letter in block.words for letter in LETTERS]
        motion.at = motion.target(block)
        yield Rapid(motion.line, coordinates.to_machine(motion.at))
        # Single axes go home along the program's axes, which a rotation has turned.
        stored = coordinates.to_program(coordinates.read(HOME[code]))
        every = not any(given)
        x, y, z = (
            home if every or chosen else old
            for home, chosen, old in zip(stored, given, motion.at, strict=True)
        )
        motion.at = (x, y, z)
        yield Rapid(motion.line, coordinates.to_machine(motion.at))

    def _store_home(self, code: int, block: Block) -> Iterable[Move]:
        self._coordinates.write(HOME[code], self._coordinates.to_machine(self._motion.at))
        return ()

    def _g92(self, code: int, block: Block) -> Iterable[Move]:
        if not block.has_axes:
            raise ProgramError("G92 needs an axis word")
        motion = self._motion
        at = motion.at
        wanted = self._given(block, at)
        old = self._coordinates.g92
        x, y, z = (o + a - w for o, a, w in zip(old, at, wanted, strict=True))
        self._shift(lambda: self._coordinates.set_g92((x, y, z), active=True))
        return ()

    def _g52(self, code: int, block: Block) -> Iterable[Move]:
        if not block.has_axes:
            raise ProgramError("G52 needs an axis word")
        offset = self._given(block, self._coordinates.g92)
        self._shift(lambda: self._coordinates.set_g92(offset, active=True))
        return ()

    def _g92_off(self, code: int, block: Block) -> Iterable[Move]:
        self._shift(lambda: self._coordinates.set_g92(ORIGIN, active=False, keep=code == 922))
        return ()

    def _g92_on(self, code: int, block: Block) -> Iterable[Move]:
        stored = self._coordinates.read(G92_OFFSET)
        self._shift(lambda: self._coordinates.set_g92(stored, active=True, keep=True))
        return ()

    # M70 to M73

    def state(self, code: int, line: int, level: int) -> Iterator[Move]:
        """Save the modal state (M70, M73), forget it (M71) or take it back (M72).

        Raises:
            ProgramError: nothing was saved.
        """
        if code in (70, 73):
            self._saved[level] = (
                replace(self._modal),
                self._coordinates.system,
                self._coordinates.tool,
            )
            if code == 73:
                self._restore_on_return.add(level)
        elif code == 71:
            self._saved.pop(level, None)
        else:
            if level not in self._saved:
                raise ProgramError("M72 finds no state: save it with M70 first")
            yield from self._restore(line, *self._saved[level])

    def leave(self, line: int, level: int) -> Iterable[Move]:
        """A subroutine at this level returns: what it saved is forgotten, or taken back."""
        saved = self._saved.pop(level, None)
        if saved is None or level not in self._restore_on_return:
            return ()
        self._restore_on_return.remove(level)
        return self._restore(line, *saved)

    def _restore(self, line: int, saved: Modal, system: int, tool_mm: Point) -> Iterator[Move]:
        m = self._modal
        changes = {
            "path": (m.path_mode, m.tolerance_mm) != (saved.path_mode, saved.tolerance_mm),
            "spindle": (m.spindle, m.rev_min) != (saved.spindle, saved.rev_min),
            "coolant": (m.mist, m.flood) != (saved.mist, saved.flood),
            "overrides": m.overrides != saved.overrides,
        }
        for field in _RESTORED:
            setattr(m, field, getattr(saved, field))
        self._system(system)
        self._tool_offset(tool_mm)
        if changes["path"]:
            yield PathControl(line, m.path_mode, m.tolerance_mm)
        if changes["spindle"]:
            yield Spindle(line, cast("Literal[-1, 0, 1]", m.spindle), m.rev_min)
        if changes["coolant"]:
            yield Coolant(line, m.mist, m.flood)
        if changes["overrides"]:
            yield Overrides(line, m.overrides)


# Tools stay what they are: a tool in the spindle is no modal state.
_RESTORED: Final = tuple(
    field for field in Modal.__slots__ if field not in ("tool", "selected_tool", "motion")
)


def _mode(field: str, value: object) -> Callable[[Settings, Block], None]:
    return lambda settings, block: setattr(settings._modal, field, value)


def _plane(plane: Plane) -> Callable[[Settings, Block], None]:
    return _mode("plane", plane)


def _chosen_system(number: int) -> Callable[[Settings, Block], None]:
    return lambda settings, block: settings._system(number)


def _nothing(settings: Settings, block: Block) -> None:
    """A code that confirms what is always the case here."""


_SETTERS: Final[dict[int, Callable[[Settings, Block], None]]] = {
    170: _plane(17),
    180: _plane(18),
    190: _plane(19),
    200: _mode("scale_mm", 25.4),
    210: _mode("scale_mm", 1.0),
    900: _mode("absolute", True),
    910: _mode("absolute", False),
    901: _mode("arc_absolute", True),
    911: _mode("arc_absolute", False),
    930: lambda settings, block: settings._feed_mode(True),
    940: lambda settings, block: settings._feed_mode(False),
    980: _mode("retract_to_start", True),
    990: _mode("retract_to_start", False),
    400: _nothing,
    80: _nothing,
    970: _nothing,
    430: Settings._length,
    431: Settings._dynamic_length,
    432: Settings._added_length,
    490: lambda settings, block: settings._tool_offset(ORIGIN),
    800: Settings._cancel,
    **{code: _chosen_system(i + 1) for i, code in enumerate((540, 550, 560, 570, 580, 590))},
    **{code: _chosen_system(i + 7) for i, code in enumerate((591, 592, 593))},
}
_NONMODAL: Final[dict[int, Callable[[Settings, int, Block], Iterable[Move]]]] = {
    100: Settings._g10,
    280: Settings._home,
    300: Settings._home,
    281: Settings._store_home,
    301: Settings._store_home,
    520: Settings._g52,
    920: Settings._g92,
    921: Settings._g92_off,
    922: Settings._g92_off,
    923: Settings._g92_on,
}
_G10: Final[dict[int, Callable[[Settings, Block], None]]] = {
    1: Settings._tool_length,
    2: Settings._set_system,
    10: Settings._tool_here,
    11: Settings._tool_at_fixture,
    20: Settings._set_system_here,
}
