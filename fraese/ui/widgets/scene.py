"""What there is to be seen of a program and the machine, from whichever side."""

import math
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np

from fraese.control.state import MachineState

_SPACE: Final = "xyz"


class Way(Protocol):
    """An outline: each point but the first is the end of a straight line."""

    @property
    def points(self) -> Any:
        """(n, 3) in machine mm."""

    @property
    def moves(self) -> Any:
        """(n) number of the move that leads there, ascending."""

    @property
    def rapid(self) -> Any:
        """(n) whether it is a rapid."""


Spot = tuple[float, float, float]


@dataclass
class Scene:
    """What there is to be seen; machine mm.

    Attributes:
        way: the program's outline; None: none is known.
        box: lowest and highest corner of the travel; None: nobody knows it.
        zero: of the work.
        tool: where it is.
        first: the move with which the job began; 0: none has.
        last: the move to which it has come.
        move: in hand; 0: none.
    """

    way: Way | None = None
    box: tuple[Spot, Spot] | None = None
    zero: Spot | None = None
    tool: Spot | None = None
    first: int = 0
    last: int = 0
    move: int = 0

    @classmethod
    def of(cls, state: MachineState, way: Way | None) -> "Scene":
        """A program on the machine as it stands."""
        return cls(
            way, travel_box(state), spot(state, state.offset_mm), spot(state, state.position_mm)
        )

    def span(self, move: int) -> tuple[int, int]:
        """First line of a move and the one behind its last, as numbers of their end points."""
        if self.way is None:
            return 0, 0
        low, high = np.searchsorted(self.way.moves, (move, move + 1))
        return max(1, int(low)), max(1, int(high))

    def done(self) -> tuple[int, int]:
        """The lines that were made in this job."""
        if not self.first:
            return 1, 1
        return self.span(self.first)[0], self.span(self.last)[0]


def spot(state: MachineState, values: tuple[float, ...]) -> Spot:
    """X, Y and Z of these; an axis that is not there is 0."""
    at = dict(zip(state.axes, values, strict=True))
    return at.get("x", 0.0), at.get("y", 0.0), at.get("z", 0.0)


def travel_box(state: MachineState) -> tuple[Spot, Spot] | None:
    """The travel of X, Y and Z; None: of one of them nobody knows where it ends."""
    axes = zip(state.axes, state.referenced, strict=True)
    low, high = spot(state, state.low_mm), spot(state, state.high_mm)
    known = all(known for name, known in axes if name in _SPACE)
    return (low, high) if known and all(map(math.isfinite, (*low, *high))) else None
