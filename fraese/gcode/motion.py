"""Motions: from words and modal state to canonical moves.

Rule 1  ``at`` is where the program believes to be, in mm of the program's coordinates;
        canonical moves get machine coordinates.
Rule 2  A motion method returns its moves; the state behind them holds once they are made.
Rule 3  A feed is in mm/min of the path, whichever of G93 and G94 is in force.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Final, Literal, cast

from fraese.errors import ProgramError
from fraese.gcode import arcs, cycles
from fraese.gcode.canon import (
    PLANE_AXES,
    Arc,
    Dwell,
    Facts,
    Feed,
    Move,
    PathControl,
    PathMode,
    Point,
    Probe,
    Rapid,
    Spindle,
)
from fraese.gcode.cycles import Hole, Sticky, Stroke
from fraese.gcode.modal import CYCLES, Modal, name
from fraese.gcode.offsets import Coordinates
from fraese.gcode.parameters import Parameters
from fraese.gcode.words import Block

LETTERS: Final = "xyz"
OFFSET_LETTERS: Final = "ijk"
PROBE_RESULT: Final = 5061
PROBE_TOUCHED: Final = 5070
# The feed that G93 gives a move of next to no length, in units per minute.
LEAST_FEED: Final = 0.1
MAX_TURNS: Final = 100_000
MAX_REPEATS: Final = 100_000


class Motion:
    """The motion codes, with the position and everything they depend on."""

    def __init__(self, parameters: Parameters, coordinates: Coordinates, modal: Modal) -> None:
        self.modal = modal
        self.coordinates = coordinates
        self.at: Point = (0.0, 0.0, 0.0)
        self.line = 0
        self._parameters = parameters
        # what canned cycles remember; forgotten with any other motion and with G80
        self._sticky: Sticky | None = None
        self.old_height_mm = 0.0

    def move(self, block: Block) -> Iterable[Move]:
        """The moves of the block's motion code.

        Raises:
            ProgramError: the motion is not possible as programmed.
        """
        code = block.motion
        if code is None:
            return ()
        if code not in CYCLES:
            self._sticky = None
        self.modal.motion = code
        if block.codes.get("nonmodal") == 530:
            return self._machine_straight(block, code)
        return _MOTIONS[code](self, block)

    def forget_cycle(self) -> None:
        """G80: the next canned cycle starts a series of its own."""
        self._sticky = None

    # Targets

    def target(self, block: Block) -> Point:
        """Where the axis words lead, in program mm."""
        words = block.words
        x, y, z = self.at
        scale = self.modal.scale_mm
        get = words.get
        if "@" in words or "^" in words:
            x, y = self._polar(words)
        if self.modal.absolute:
            if (word := get("x")) is not None:
                x = word * scale
            if (word := get("y")) is not None:
                y = word * scale
            if (word := get("z")) is not None:
                z = word * scale
            return x, y, z
        return x + get("x", 0.0) * scale, y + get("y", 0.0) * scale, z + get("z", 0.0) * scale

    def _polar(self, words: dict[str, float]) -> tuple[float, float]:
        """X and Y from distance and angle; what is not given stays as it is."""
        if "x" in words or "y" in words:
            raise ProgramError("polar coordinates (@ and ^) cannot be mixed with X or Y")
        x, y, _ = self.at
        radius_mm, angle_deg = math.hypot(x, y), math.degrees(math.atan2(y, x))
        if not self.modal.absolute and radius_mm == 0:
            raise ProgramError("at the origin there is no direction for incremental @ and ^")
        if self.modal.absolute:
            radius_mm = words["@"] * self.modal.scale_mm if "@" in words else radius_mm
            angle_deg = words.get("^", angle_deg)
        else:
            radius_mm += words.get("@", 0.0) * self.modal.scale_mm
            angle_deg += words.get("^", 0.0)
        angle = math.radians(angle_deg)
        return radius_mm * math.cos(angle), radius_mm * math.sin(angle)

    def feed_for(self, block: Block, length_mm: float, code: int) -> float:
        """Feed of this move in mm/min.

        Raises:
            ProgramError: no feed is in force.
        """
        if not self.modal.inverse_time:
            feed_mm_min = self.modal.feed_mm_min
            if feed_mm_min <= 0:
                raise ProgramError(f"{name(code)} needs a feed: give an F word above 0 first")
            return feed_mm_min
        inverse = block.words.get("f")
        if inverse is None or inverse <= 0:
            raise ProgramError(f"{name(code)} needs its own F word above 0 while G93 is in force")
        return max(length_mm * inverse, LEAST_FEED * self.modal.scale_mm)

    # Straight motion

    def _rapid(self, block: Block) -> Iterable[Move]:
        self.at = at = self.target(block)
        return (Rapid(self.line, self.coordinates.to_machine(at)),)

    def _feed(self, block: Block) -> Iterable[Move]:
        to = self.target(block)
        modal = self.modal
        feed_mm_min = modal.feed_mm_min
        if modal.inverse_time or feed_mm_min <= 0:
            feed_mm_min = self.feed_for(block, math.dist(self.at, to), 10)
        self.at = to
        return (Feed(self.line, self.coordinates.to_machine(to), feed_mm_min),)

    def _machine_straight(self, block: Block, code: int) -> Iterable[Move]:
        if code not in (0, 10):
            raise ProgramError("G53 needs G0 or G1")
        if not self.modal.absolute:
            raise ProgramError("G53 needs G90: machine coordinates are absolute")
        coordinates = self.coordinates
        here = coordinates.to_machine(self.at)
        scale = self.modal.scale_mm
        words = block.words
        x, y, z = (
            words[letter] * scale if letter in words else old
            for letter, old in zip(LETTERS, here, strict=True)
        )
        to = (x, y, z)
        self.at = coordinates.to_program(to)
        if code == 0:
            return (Rapid(self.line, to),)
        return (Feed(self.line, to, self.feed_for(block, math.dist(here, to), code)),)

    # Arcs

    def _arc(self, block: Block) -> Iterable[Move]:
        modal = self.modal
        code = cast(int, block.motion)
        first, second, third = PLANE_AXES[modal.plane]
        self._check_arc_words(block.words, (first, second, third))
        to = self.target(block)
        start, end = (self.at[first], self.at[second]), (to[first], to[second])
        turns = self._turns(block.words.get("p"), code)
        if not modal.inverse_time:
            self.feed_for(block, 0.0, code)
        centre = self._centre(block.words, start, end, turns > 0)
        length_mm = arcs.length_mm(start, end, centre, turns, to[third] - self.at[third])
        feed_mm_min = self.feed_for(block, length_mm, code)
        middle = [0.0, 0.0, 0.0]
        middle[first], middle[second] = centre
        machine = self.coordinates.to_machine((middle[0], middle[1], middle[2]))
        self.at = to
        return (
            Arc(
                self.line,
                self.coordinates.to_machine(to),
                (machine[first], machine[second]),
                modal.plane,
                turns,
                feed_mm_min,
            ),
        )

    def _check_arc_words(self, words: dict[str, float], axes: tuple[int, int, int]) -> None:
        first, second, third = axes
        plane = f"G{self.modal.plane}"
        if OFFSET_LETTERS[third] in words:
            raise ProgramError(f"{OFFSET_LETTERS[third].upper()} has no meaning in plane {plane}")
        offsets = OFFSET_LETTERS[first] in words or OFFSET_LETTERS[second] in words
        if "r" in words and offsets:
            raise ProgramError("an arc takes either R or a centre by I, J, K, not both")
        if "r" not in words and not offsets:
            raise ProgramError("an arc needs R or a centre by I, J, K")
        polar = "@" in words or "^" in words
        if "r" in words and not polar:
            ends = LETTERS[first] in words or LETTERS[second] in words
            if not ends:
                both = f"{LETTERS[first].upper()} or {LETTERS[second].upper()}"
                raise ProgramError(f"an arc with R needs its end: {both} in plane {plane}")
        if self.coordinates.rotation_deg and self.modal.plane != 17:
            raise ProgramError("a rotated coordinate system allows arcs in plane G17 only")

    def _turns(self, word: float | None, code: int) -> int:
        turns = 1 if word is None else round(word)
        if word is not None and (abs(word - turns) > 1e-4 or not 1 <= turns <= MAX_TURNS):
            raise ProgramError("the P word of an arc is a whole number of turns, 1 or more")
        return turns if code == 30 else -turns

    def _centre(
        self, words: dict[str, float], start: arcs.Flat, end: arcs.Flat, left: bool
    ) -> arcs.Flat:
        scale = self.modal.scale_mm
        radius = words.get("r")
        if radius is not None:
            return arcs.centre_by_radius(start, end, radius * scale, left)
        first, second, _ = PLANE_AXES[self.modal.plane]
        letters = OFFSET_LETTERS[first], OFFSET_LETTERS[second]
        if self.modal.arc_absolute:
            for letter in letters:
                if letter not in words:
                    raise ProgramError(f"G90.1 needs {letter.upper()} for the centre of an arc")
            centre = words[letters[0]] * scale, words[letters[1]] * scale
        else:
            centre = (
                start[0] + words.get(letters[0], 0.0) * scale,
                start[1] + words.get(letters[1], 0.0) * scale,
            )
        arcs.check_centre(start, end, centre, scale)
        return centre

    # Probing

    def _probe(self, block: Block) -> Iterable[Move]:
        code = cast(int, block.motion)
        if not block.has_axes:
            raise ProgramError(f"{name(code)} needs an X, Y or Z word")
        if self.modal.inverse_time:
            raise ProgramError("probing is not possible in G93; use G94")
        feed_mm_min = self.feed_for(block, 0.0, code)
        to = self.target(block)
        towards, must = code in (382, 383), code in (382, 384)
        # Without a way to go a probe that must touch cannot; the others just do nothing.
        if must and self.at == to:
            raise ProgramError(f"{name(code)} has no way to go: it starts at its target")
        machine = self.coordinates.to_machine(to)
        return (Probe(self.line, machine, feed_mm_min, towards, must),)

    def probed(self, probe: Probe, facts: Facts | None) -> None:
        """Take in how a probe move ended.

        Raises:
            ProgramError: the probe did not touch although it had to.
        """
        if facts is None:
            facts = Facts(probe.to, touched=True)
        contact = facts.position_mm if facts.contact_mm is None else facts.contact_mm
        values = self.coordinates.to_program(contact)
        for index, value in enumerate(values, start=PROBE_RESULT):
            self._parameters.set(index, value / self.modal.scale_mm)
        self._parameters.set(PROBE_TOUCHED, float(facts.touched))
        self.at = self.coordinates.to_program(facts.position_mm)
        if probe.must_touch and not facts.touched:
            wanted = "touch" if probe.until_closed else "open"
            raise ProgramError(f"the probe reached its target but did not {wanted}")

    # Canned cycles

    def _cycle(self, block: Block) -> Iterable[Move]:
        code = cast(int, block.motion)
        _first, _second, third = PLANE_AXES[self.modal.plane]
        if not block.has_axes:
            raise ProgramError(f"{name(code)} needs an axis word")
        if self.modal.inverse_time:
            raise ProgramError("canned cycles are not possible in G93; use G94")
        self.feed_for(block, 0.0, code)
        if self._sticky is None:
            self.old_height_mm = self.at[third]
        if self._sticky is None or self._sticky.code != code:
            self._sticky = Sticky(code)
        self._sticky = sticky = self._sticky.updated(block.words, LETTERS[third])
        hole = self._hole(sticky)
        count = round(block.words.get("l", 1.0))
        if count > MAX_REPEATS:
            raise ProgramError(f"a canned cycle is repeated at most {MAX_REPEATS} times")
        return self._holes(block, hole, code, count)

    def _hole(self, sticky: Sticky) -> Hole:
        """Heights of the hole from the words in force."""
        modal = self.modal
        if sticky.r is None:
            raise ProgramError("the canned cycle needs an R word: the height where drilling starts")
        if sticky.depth is None:
            letter = LETTERS[PLANE_AXES[modal.plane][2]].upper()
            raise ProgramError(f"the canned cycle needs a {letter} word: the bottom of the hole")
        r_mm = sticky.r * modal.scale_mm
        bottom_mm = sticky.depth * modal.scale_mm
        if not modal.absolute:
            r_mm += self.old_height_mm
            bottom_mm += r_mm
        if bottom_mm > r_mm:
            raise ProgramError("the bottom of the canned cycle lies above its R height")
        clear_mm = max(r_mm, self.old_height_mm) if modal.retract_to_start else r_mm
        peck_mm = None if sticky.q is None else sticky.q * modal.scale_mm
        return Hole(r_mm, bottom_mm, clear_mm, peck_mm, sticky.p)

    def _holes(self, block: Block, hole: Hole, code: int, count: int) -> Iterator[Move]:
        _first, _second, third = PLANE_AXES[self.modal.plane]
        spindle = self.modal.spindle
        if self.old_height_mm < hole.r_mm:
            yield self._height(hole.r_mm, third)
            height_mm = hole.r_mm
        elif self.at[third] <= hole.r_mm:
            height_mm = self.old_height_mm if self.modal.retract_to_start else hole.r_mm
        else:
            height_mm = self.at[third]
        restore = self._exact_path()
        yield from restore[:1]
        for _ in range(count):
            across = list(self.target(block))
            across[third] = height_mm
            self.at = (across[0], across[1], across[2])
            yield Rapid(self.line, self.coordinates.to_machine(self.at))
            if height_mm != hole.r_mm:
                yield self._height(hole.r_mm, third)
            if code == 860 and spindle == 0:
                raise ProgramError("G86 needs a turning spindle: start it with M3 or M4")
            for stroke in cycles.STROKES[code](hole):
                yield self._stroke(stroke, third, spindle)
            height_mm = hole.clear_mm
        yield from restore[1:]

    def _exact_path(self) -> tuple[PathControl, ...]:
        """What to say before and after: a hole's corners are never rounded."""
        modal = self.modal
        if modal.path_mode is PathMode.EXACT_PATH:
            return ()
        return (
            PathControl(self.line, PathMode.EXACT_PATH, 0.0),
            PathControl(self.line, modal.path_mode, modal.tolerance_mm),
        )

    def _height(self, height_mm: float, axis: int) -> Rapid:
        at = list(self.at)
        at[axis] = height_mm
        self.at = (at[0], at[1], at[2])
        return Rapid(self.line, self.coordinates.to_machine(self.at))

    def _stroke(self, stroke: Stroke, axis: int, spindle: int) -> Move:
        kind, value = stroke
        if kind == "dwell":
            return Dwell(self.line, value)
        if kind in ("stop", "start"):
            direction = cast(Literal[-1, 0, 1], spindle if kind == "start" else 0)
            return Spindle(self.line, direction, self.modal.rev_min)
        rapid = self._height(value, axis)
        return rapid if kind == "rapid" else Feed(self.line, rapid.to, self.modal.feed_mm_min)


_MOTIONS: Final[dict[int, Callable[[Motion, Block], Iterable[Move]]]] = {
    0: Motion._rapid,
    10: Motion._feed,
    20: Motion._arc,
    30: Motion._arc,
    **dict.fromkeys((382, 383, 384, 385), Motion._probe),
    **dict.fromkeys(CYCLES, Motion._cycle),
}
