"""What a program asks of the machine, and of whoever stands at it."""

import math
from dataclasses import dataclass, replace
from typing import Final

from fraese.gcode import canon

#: What else than a motion may ask for something.
WANTING: Final = frozenset({canon.Tool, canon.Spindle, canon.Pause, canon.Probe})


@dataclass(frozen=True, slots=True)
class Wants:
    """What a program asks of the machine and of whoever stands at it.

    Attributes:
        tools: numbers, in the order in which they are first put in.
        spindle_rev_min: lowest and highest speed that it is switched on with; None: never.
        stops: so often it waits for a person, M0 and tools; M1 is counted apart.
        optional_stops: so often at M1.
        probes: so often it probes.
    """

    tools: tuple[int, ...] = ()
    spindle_rev_min: tuple[float, float] | None = None
    stops: int = 0
    optional_stops: int = 0
    probes: int = 0

    def taking(self, move: canon.Move) -> "Wants":
        """With one more move that may want something."""
        if isinstance(move, canon.Tool):
            new = move.number not in self.tools
            tools = (*self.tools, move.number) if new else self.tools
            return replace(self, tools=tools, stops=self.stops + 1)
        if isinstance(move, canon.Spindle) and move.is_on:
            low, high = self.spindle_rev_min or (math.inf, 0.0)
            speeds = min(low, move.rev_min), max(high, move.rev_min)
            return replace(self, spindle_rev_min=speeds)
        if isinstance(move, canon.Pause):
            if move.optional:
                return replace(self, optional_stops=self.optional_stops + 1)
            return replace(self, stops=self.stops + 1)
        if isinstance(move, canon.Probe):
            return replace(self, probes=self.probes + 1)
        return self
