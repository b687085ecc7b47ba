"""Where the program is, where its words lead, and how fast.

Rule 1  ``at`` is where the program believes to be, in mm of the program's coordinates;
        canonical moves get machine coordinates.
Rule 2  A feed is in mm/min of the path, whichever of G93 and G94 is in force.
"""

import math
from typing import Final

from fraese.errors import ProgramError
from fraese.gcode.modal import Modal, name
from fraese.gcode.offsets import Coordinates
from fraese.gcode.words import Block
from fraese.workframe import Point

LETTERS: Final = "xyz"
# The feed that G93 gives a move of next to no length, in units per minute.
LEAST_FEED: Final = 0.1


class Position:
    """Place, modal state and coordinates, shared by everything that moves or shifts."""

    def __init__(self, coordinates: Coordinates, modal: Modal) -> None:
        self.modal = modal
        self.coordinates = coordinates
        self.at: Point = (0.0, 0.0, 0.0)
        # the line that is being carried out
        self.line = 0

    @property
    def machine(self) -> Point:
        """The place in machine mm."""
        return self.coordinates.frame.to_machine(self.at)

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
