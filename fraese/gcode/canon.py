"""Canonical moves: what a program means, free of modal state, in millimetres of the machine.

Rule 1  Every position has one value for each axis, in machine order, in machine millimetres, or
        degrees of a rotary axis: work offset, G92, rotation and tool length are already in it,
        the unit of the program no longer matters.
Rule 2  A move is an immutable fact. Its ``line`` is the 1-based line that caused it.
Rule 3  Some moves are questions to the outside (``BARRIERS``): whoever consumes the
        generator answers them with ``send(Facts(...))`` once the machine stands still.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

from fraese.workframe import Point

Plane = Literal[17, 18, 19]


class PathMode(StrEnum):
    """How corners are treated."""

    EXACT_PATH = "G61"
    EXACT_STOP = "G61.1"
    BLEND = "G64"


@dataclass(frozen=True, slots=True)
class Rapid:
    """Straight to ``to`` as fast as the axes can.

    ``is_place``: in Z that is a place of the machine (G53, G28, G30), wherever the work lies.
    """

    line: int
    to: Point
    is_place: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Feed:
    """Straight to ``to``; an inverse time feed is already turned into mm/min.

    The feed is along X, Y and Z if any of them moves, else along U, V and W, else along A, B and
    C; in degrees/min where that means rotary axes only. ``is_place``: as of a rapid.
    """

    line: int
    to: Point
    feed_mm_min: float
    is_place: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Arc:
    """A circle, helix or, within the closing tolerance, a slight spiral.

    ``centre`` is given in the order of the plane's axes: G17 (x, y), G18 (z, x), G19 (y, z).
    ``turns`` is positive counter-clockwise as seen from the positive third axis; 1 reaches
    the end point for the first time (a full circle where it is the start), 2 goes round
    once more, and so on. It is never 0.
    """

    line: int
    to: Point
    centre: tuple[float, float]
    plane: Plane
    turns: int
    feed_mm_min: float


@dataclass(frozen=True, slots=True)
class Along:
    """One move that leads along many points, straight from each to the next: a bent one.

    ``points``: in their order, the last one is ``to``; they can be asked for again and again.
    ``feed_mm_min``: None means as fast as the axes can. ``radius_mm``: of the arc in ``plane`` that
    it was; 0 means a straight line. The language itself makes none: see ``heightmap``.
    """

    line: int
    to: Point
    points: Iterable[Point] = field(repr=False)
    feed_mm_min: float | None
    plane: Plane = 17
    radius_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class Dwell:
    """Wait at a standstill."""

    line: int
    duration_s: float


@dataclass(frozen=True, slots=True)
class Probe:
    """Straight towards ``to`` until the probe closes or opens. A barrier.

    ``until_closed``: G38.2 and G38.3 go towards contact, G38.4 and G38.5 away from it.
    ``must_touch``: G38.2 and G38.4 are an error where ``to`` is reached without a change.
    """

    line: int
    to: Point
    feed_mm_min: float
    until_closed: bool
    must_touch: bool


@dataclass(frozen=True, slots=True)
class Spindle:
    """Spindle clockwise (+1), counter-clockwise (-1) or off (0), with its speed.

    ``has_speed``: an S word has said so; without any the speed is the machine's own.
    """

    line: int
    direction: Literal[-1, 0, 1]
    rev_min: float
    has_speed: bool = True

    @property
    def is_on(self) -> bool:
        """It turns, or a beam burns: S0 is off."""
        return self.direction != 0 and (self.rev_min > 0 or not self.has_speed)


@dataclass(frozen=True, slots=True)
class Coolant:
    """State of both coolants from here on."""

    line: int
    mist: bool
    flood: bool


@dataclass(frozen=True, slots=True)
class Output:
    """A free output on or off from here on, by its name in the configuration."""

    line: int
    name: str
    is_on: bool


@dataclass(frozen=True, slots=True)
class Command:
    """At a standstill, a program is carried out; the job goes on when it has ended.

    ``words``: the program and its arguments, as they are.
    """

    line: int
    code: int
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Tool:
    """M6: the tool with this number goes into the spindle. A barrier.

    ``remark``: what the program says beside it, for people.
    """

    line: int
    number: int
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Pause:
    """M0, M60, or M1 (``optional``). A barrier; ``remark`` as for a tool."""

    line: int
    optional: bool
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Message:
    """Text for the operator, parameters already put in; a note is the interpreter's own."""

    line: int
    text: str
    kind: Literal["msg", "debug", "print", "note"]


@dataclass(frozen=True, slots=True)
class PathControl:
    """Treatment of corners from here on; the tolerance belongs to G64 P."""

    line: int
    mode: PathMode
    tolerance_mm: float


@dataclass(frozen=True, slots=True)
class Overrides:
    """M48 and M49: whether the operator's override may act."""

    line: int
    enabled: bool


@dataclass(frozen=True, slots=True)
class Offsets:
    """Work coordinates change here; no line is merged over it. Moves are in machine coordinates."""

    line: int


@dataclass(frozen=True, slots=True)
class End:
    """M2, M30, the closing percent sign, or the end of the file."""

    line: int


@dataclass(frozen=True, slots=True)
class Breath:
    """Nothing yet: many lines went by without a move. Who waits may see to something else first."""

    line: int


Move = (
    Rapid
    | Feed
    | Arc
    | Along
    | Dwell
    | Probe
    | Spindle
    | Coolant
    | Output
    | Command
    | Tool
    | Pause
    | Message
    | PathControl
    | Overrides
    | Offsets
    | End
    | Breath
)
BARRIERS: frozenset[type] = frozenset({Probe, Tool, Pause})
MOTIONS: frozenset[type] = frozenset({Rapid, Feed, Arc, Along, Probe})


@dataclass(frozen=True, slots=True)
class Facts:
    """The outside's answer to a barrier.

    Args:
        position_mm: where the machine stands now.
        touched: whether the probe changed; without meaning for other barriers.
        contact_mm: where it changed; None means at ``position_mm``.
        parameters: persistent parameters that a person has changed meanwhile, by number.
    """

    position_mm: Point
    touched: bool = False
    contact_mm: Point | None = None
    parameters: Mapping[int, float] = field(default_factory=dict)
