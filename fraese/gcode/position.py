"""Where the program is, where its words lead, and how fast.

Rule 1  ``at`` is where the program believes to be, in mm of the program's coordinates;
        canonical moves get machine coordinates.
Rule 2  A feed is in mm/min of the path, whichever of G93 and G94 is in force; in degrees/min
        where nothing but rotary axes moves.
"""

import math
from collections.abc import Collection, Iterable
from operator import add
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.axes import Axes, Way
from fraese.gcode.modal import Modal, name
from fraese.gcode.offsets import Coordinates
from fraese.gcode.replay import Replay
from fraese.gcode.words import Block
from fraese.phrases import phrase
from fraese.workframe import Point

# The feed that G93 gives a move of next to no length, in units per minute.
LEAST_FEED: Final = 0.1


class Position:
    """Place, modal state and coordinates, shared by everything that moves or shifts."""

    def __init__(
        self, axes: Axes, coordinates: Coordinates, modal: Modal, unreferenced: str = ""
    ) -> None:
        self.axes = axes
        self.modal = modal
        self.coordinates = coordinates
        self.at: Point = coordinates.nothing
        self._unreferenced = unreferenced
        # where a program is only read, to be begun at a place of it
        self.replay: Replay | None = None
        # the line that is being carried out
        self.line = 0

    @property
    def machine(self) -> Point:
        """The place in machine mm."""
        return self.coordinates.frame.to_machine(self.at)

    def stands(self, machine_mm: Point, unreferenced: str) -> None:
        """The machine is here by now, and of these axes nobody knows the place."""
        self.at = self.coordinates.frame.to_work(machine_mm)
        self._unreferenced = unreferenced

    def target(self, block: Block) -> Point:
        """Where the axis words lead, in program mm."""
        words = block.words
        modal = self.modal
        at = self.at
        if self.replay is not None:
            self.replay.goes(words, self.line, absolute=modal.absolute)
        if "@" in words or "^" in words:
            at = self._by_polar(words)
        if modal.absolute:
            return self.axes.reached(at, words, modal.scale_mm)
        by = self.axes.reached(self.coordinates.nothing, words, modal.scale_mm)
        return tuple(map(add, at, by))

    def given(self, block: Block, otherwise: Point) -> Point:
        """The axis words in mm and degrees, or what holds where there is none."""
        return self.axes.reached(otherwise, block.words, self.modal.scale_mm)

    def _by_polar(self, words: dict[str, float]) -> Point:
        """X and Y from distance and angle; what is not given stays as it is."""
        if "x" in words or "y" in words:
            raise ProgramError(phrase("polar coordinates (@ and ^) cannot be mixed with X or Y"))
        if self.modal.plane != 17:
            raise ProgramError(phrase("polar coordinates (@ and ^) are of the plane G17"))
        first, second, _ = self.axes.plane(17, phrase("@ or ^"))
        to = list(self.at)
        x, y = to[first], to[second]
        radius_mm, angle_deg = math.hypot(x, y), math.degrees(math.atan2(y, x))
        if not self.modal.absolute and radius_mm == 0:
            raise ProgramError(
                phrase("at the origin there is no direction for incremental @ and ^")
            )
        if self.modal.absolute:
            radius_mm = words["@"] * self.modal.scale_mm if "@" in words else radius_mm
            angle_deg = words.get("^", angle_deg)
        else:
            radius_mm += words.get("@", 0.0) * self.modal.scale_mm
            angle_deg += words.get("^", 0.0)
        angle = math.radians(angle_deg)
        to[first], to[second] = radius_mm * math.cos(angle), radius_mm * math.sin(angle)
        return tuple(to)

    def depends(self, code: int, kind: float = 0.0) -> None:
        """What is carried out means the place where the machine stands.

        Raises:
            ProgramError: the line is only read.
        """
        if self.replay is not None:
            self.replay.refuse(code, kind)

    def fix(self, letters: Collection[str]) -> None:
        """These axes go to places of the machine."""
        if self.replay is not None:
            self.replay.fix(letters)

    def require_reference(self, letters: Iterable[str], code: int) -> None:
        """See that these axes can go to a place of the machine.

        Raises:
            ProgramError: nobody knows where one of them is.
        """
        lost = [letter.upper() for letter in letters if letter in self._unreferenced]
        if lost:
            said = (
                phrase("axis {letters} is", letters=lost[0])
                if len(lost) == 1
                else phrase("axes {letters} are", letters=" ".join(lost))
            )
            raise ProgramError(
                phrase(
                    "{code} goes to a place of the machine, and {axes} not referenced: nobody"
                    " knows where that is; reference first",
                    code=name(code),
                    axes=said,
                )
            )

    def feed_for(self, block: Block, way: Way, code: int) -> float:
        """Feed of this move along what it counts along, in mm/min or degrees/min.

        Raises:
            ProgramError: no feed is in force.
        """
        modal = self.modal
        if not modal.inverse_time:
            if modal.feed_mm_min <= 0:
                raise ProgramError(
                    phrase("{name} needs a feed: give an F word above 0 first", name=name(code))
                )
            # An angle is no length: G20 leaves it alone.
            return modal.feed_word if way.is_angle else modal.feed_mm_min
        inverse = block.words.get("f")
        if inverse is None or inverse <= 0:
            raise ProgramError(
                phrase("{name} needs its own F word above 0 while G93 is in force", name=name(code))
            )
        unit = 1.0 if way.is_angle else modal.scale_mm
        feed = max(way.length * inverse, LEAST_FEED * unit)
        # What a program may ask for is the feed that came of it.
        modal.feed_word = feed / unit
        return feed
