"""Canned cycles at their places: what ``cycles`` describes, as canonical moves."""

from collections.abc import Iterable, Iterator
from typing import Final, Literal, cast

from fraese.errors import ProgramError
from fraese.gcode import cycles
from fraese.gcode.axes import Way, third_letter
from fraese.gcode.canon import (
    Dwell,
    Feed,
    Move,
    Overrides,
    PathControl,
    PathMode,
    Rapid,
    Spindle,
)
from fraese.gcode.cycles import Hole, Sticky, Stroke
from fraese.gcode.modal import name
from fraese.gcode.position import Position
from fraese.gcode.words import Block
from fraese.phrases import phrase

MAX_REPEATS: Final = 100_000
# What a stroke does to the spindle's direction.
_SPINDLE: Final = {"stop": 0, "start": 1, "reverse": -1}


class Drilling:
    """The canned cycles, with what they remember from line to line."""

    def __init__(self, position: Position) -> None:
        self._position = position
        self._modal = position.modal
        self._sticky: Sticky | None = None
        # where the third axis stood when the present series of cycles began
        self._old_height_mm = 0.0

    def forget(self) -> None:
        """Another motion, or G80: the next cycle starts a series of its own."""
        self._sticky = None

    def drill(self, block: Block) -> Iterable[Move]:
        """The moves of a canned cycle.

        Raises:
            ProgramError: a word is missing or makes no sense.
        """
        code = cast(int, block.motion)
        third = self._position.axes.third(self._modal.plane, name(code))
        if not block.has_axes:
            raise ProgramError(phrase("{name} needs an axis word", name=name(code)))
        for letter in "abcuvw":
            if letter in block.words:
                raise ProgramError(
                    phrase(
                        "{name} is of X, Y and Z; move {letter} before",
                        name=name(code),
                        letter=letter.upper(),
                    )
                )
        if self._modal.inverse_time:
            raise ProgramError(phrase("canned cycles are not possible in G93; use G94"))
        self._position.feed_for(block, Way(0.0, False), code)
        if self._sticky is None:
            self._old_height_mm = self._position.at[third]
        if self._sticky is None or self._sticky.code != code:
            self._sticky = Sticky(code)
        self._sticky = sticky = self._sticky.updated(block.words, third_letter(self._modal.plane))
        hole = self._hole(sticky)
        count = round(block.words.get("l", 1.0))
        if count > MAX_REPEATS:
            raise ProgramError(
                phrase(
                    "a canned cycle is repeated at most {max_repeats} times",
                    max_repeats=MAX_REPEATS,
                )
            )
        return self._holes(block, hole, third, count)

    def _hole(self, sticky: Sticky) -> Hole:
        """Heights of the hole from the words in force."""
        modal = self._modal
        if sticky.r is None:
            raise ProgramError(
                phrase("the canned cycle needs an R word: the height where drilling starts")
            )
        if sticky.depth is None:
            letter = third_letter(modal.plane).upper()
            raise ProgramError(
                phrase(
                    "the canned cycle needs a {letter} word: the bottom of the hole", letter=letter
                )
            )
        r_mm = sticky.r * modal.scale_mm
        bottom_mm = sticky.depth * modal.scale_mm
        if not modal.absolute:
            r_mm += self._old_height_mm
            bottom_mm += r_mm
        if bottom_mm > r_mm:
            raise ProgramError(phrase("the bottom of the canned cycle lies above its R height"))
        clear_mm = max(r_mm, self._old_height_mm) if modal.retract_to_start else r_mm
        peck_mm = None if sticky.q is None else sticky.q * modal.scale_mm
        return Hole(r_mm, bottom_mm, clear_mm, peck_mm, sticky.p)

    def _holes(self, block: Block, hole: Hole, third: int, count: int) -> Iterator[Move]:
        code = cast(int, block.motion)
        spindle = self._modal.spindle
        if self._old_height_mm < hole.r_mm:
            yield self._height(hole.r_mm, third)
            height_mm = hole.r_mm
        elif self._position.at[third] <= hole.r_mm:
            height_mm = self._old_height_mm if self._modal.retract_to_start else hole.r_mm
        else:
            height_mm = self._position.at[third]
        restore = self._exact_path()
        yield from restore[:1]
        for _ in range(count):
            across = list(self._position.target(block))
            across[third] = height_mm
            self._position.at = tuple(across)
            yield Rapid(self._position.line, self._position.machine)
            if height_mm != hole.r_mm:
                yield self._height(hole.r_mm, third)
            if code in cycles.TURNS and spindle not in cycles.TURNS[code][0]:
                raise ProgramError(cycles.TURNS[code][1])
            for stroke in cycles.STROKES[code](hole):
                yield from self._stroke(stroke, third, spindle)
            height_mm = hole.clear_mm
        yield from restore[1:]

    def _exact_path(self) -> tuple[PathControl, ...]:
        """What to say before and after: a hole's corners are never rounded."""
        modal = self._modal
        if modal.path_mode is PathMode.EXACT_PATH:
            return ()
        return (
            PathControl(self._position.line, PathMode.EXACT_PATH, 0.0),
            PathControl(self._position.line, modal.path_mode, modal.tolerance_mm),
        )

    def _height(self, height_mm: float, axis: int) -> Rapid:
        at = list(self._position.at)
        at[axis] = height_mm
        self._position.at = tuple(at)
        return Rapid(self._position.line, self._position.machine)

    def _stroke(self, stroke: Stroke, axis: int, spindle: int) -> Iterator[Move]:
        kind, value = stroke
        line = self._position.line
        if kind == "rapid":
            yield self._height(value, axis)
        elif kind == "feed":
            yield Feed(line, self._height(value, axis).to, self._modal.feed_mm_min)
        elif kind == "dwell":
            yield Dwell(line, value)
        elif kind in _SPINDLE:
            direction = cast(Literal[-1, 0, 1], spindle * _SPINDLE[kind])
            yield Spindle(line, direction, self._modal.rev_min, self._modal.has_speed)
        elif self._modal.overrides:
            # M49 holds the feed already, and goes on to do so.
            yield Overrides(line, kind == "free feed")
