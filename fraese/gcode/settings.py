"""Codes that change what is in force and nothing else, and M70 to M73 that keep it."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Final, Literal, cast

from fraese.errors import ProgramError
from fraese.gcode.canon import Coolant, Move, Overrides, PathControl, Spindle
from fraese.gcode.frames import Frames
from fraese.gcode.modal import Modal
from fraese.gcode.motion import Motion
from fraese.gcode.words import Block
from fraese.phrases import phrase
from fraese.workframe import Point


class Settings:
    """Setters for the modal state."""

    def __init__(self, motion: Motion, frames: Frames) -> None:
        self._modal = motion.modal
        self._motion = motion
        self._frames = frames
        # M70 and M73 by call level; the levels that M73 restores by itself
        self._saved: dict[int, tuple[Modal, int, Point]] = {}
        self._restore_on_return: set[int] = set()

    def feed(self, value: float) -> None:
        """The F word; in G93 it belongs to its line and is read there.

        Raises:
            ProgramError: it is negative.
        """
        if value < 0:
            raise ProgramError(phrase("the F word must not be negative"))
        if not self._modal.inverse_time:
            self._modal.feed_word = value
            self._modal.feed_mm_min = value * self._modal.scale_mm

    def set(self, code: int, block: Block) -> None:
        """A code that changes what is in force and nothing else.

        Raises:
            ProgramError: a word it needs is missing or wrong.
        """
        _SETTERS[code](self, block)

    def reset(self) -> None:
        """What M2 and M30 do: G54, G17, G90, G94, G1, no offset that is not stored."""
        m = self._modal
        m.plane, m.absolute, m.inverse_time, m.motion = 17, True, False, 10
        m.feed_mm_min = 0.0
        self._motion.forget_cycle()
        self._frames.select(1)

    # Modes

    def _feed_mode(self, inverse_time: bool) -> None:
        if inverse_time != self._modal.inverse_time:
            self._modal.inverse_time = inverse_time
            # A number per minute is no feed, and a feed no number per minute.
            self._modal.feed_mm_min = 0.0
            if not inverse_time:
                self._modal.feed_word = 0.0

    def _cancel(self, block: Block) -> None:
        if block.motion is None:
            self._modal.motion = None
            self._motion.forget_cycle()

    # M70 to M73

    def state(self, code: int, line: int, level: int) -> Iterator[Move]:
        """Save the modal state (M70, M73), forget it (M71) or take it back (M72).

        Raises:
            ProgramError: nothing was saved.
        """
        if code in (70, 73):
            coordinates = self._motion.coordinates
            self._saved[level] = (
                replace(self._modal),
                coordinates.frame.system,
                coordinates.frame.tool,
            )
            if code == 73:
                self._restore_on_return.add(level)
        elif code == 71:
            self._saved.pop(level, None)
        else:
            if level not in self._saved:
                raise ProgramError(phrase("M72 finds no state: save it with M70 first"))
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
        self._frames.select(system)
        self._frames.set_tool_offset(tool_mm)
        if changes["path"]:
            yield PathControl(line, m.path_mode, m.tolerance_mm)
        if changes["spindle"]:
            direction = cast("Literal[-1, 0, 1]", m.spindle)
            yield Spindle(line, direction, m.rev_min, m.has_speed)
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


def _chosen_system(number: int) -> Callable[[Settings, Block], None]:
    return lambda settings, block: settings._frames.select(number)


def _nothing(settings: Settings, block: Block) -> None:
    """A code that confirms what is always the case here."""


_SETTERS: Final[dict[int, Callable[[Settings, Block], None]]] = {
    170: _mode("plane", 17),
    180: _mode("plane", 18),
    190: _mode("plane", 19),
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
    700: _mode("scale_mm", 25.4),
    710: _mode("scale_mm", 1.0),
    80: _nothing,
    970: _nothing,
    430: lambda settings, block: settings._frames.length(block),
    431: lambda settings, block: settings._frames.dynamic_length(block),
    432: lambda settings, block: settings._frames.added_length(block),
    490: lambda settings, block: settings._frames.no_length(),
    800: Settings._cancel,
    **{code: _chosen_system(i + 1) for i, code in enumerate((540, 550, 560, 570, 580, 590))},
    **{code: _chosen_system(i + 7) for i, code in enumerate((591, 592, 593))},
}
