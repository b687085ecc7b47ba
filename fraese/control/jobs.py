"""Jobs: what the run loop works off.

A job is a generator. It yields blocks, which are pushed as the queue has room, and waits by
yielding one of the classes below; what it gets back is the driver's report at that moment.

    report = yield block        taken by the queue (not yet played)
    report = yield STANDSTILL   everything pushed so far has been played
    ... Standstill(cut=...)     or was braked and dropped, because that said so
    report = yield Ask("...")   the operator has answered
    report = yield Doing("...") at once: what comes next is this
    report = yield TURN         the run loop has been round: who computes for long is no hindrance

So homing is written as it is read, a program streams, and both are stopped in one place.
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from typing import Any, Final, Protocol

from fraese.blocks import Block
from fraese.motor.seams import Report


@dataclass(frozen=True, slots=True)
class Standstill:
    """Wait until everything pushed has been played.

    Attributes:
        cut: brake, and drop what has not been played, as soon as this says so; None: never.
    """

    cut: Callable[[], bool] | None = None


@dataclass(frozen=True, slots=True)
class Ask:
    """Wait for standstill, then for the operator.

    Attributes:
        question: what he is asked.
        admits: he may move by hand meanwhile; whoever asks sees to the way back.
        tag: of the move that asks, as blocks have it; 0: it is no move.
        waits_for: in a word, such as "tool 2"; empty: him.
    """

    question: str
    admits: bool = True
    tag: int = 0
    waits_for: str = ""


@dataclass(frozen=True, slots=True)
class Doing:
    """Wait for nothing: for people, what is done from here on."""

    what: str


@dataclass(frozen=True, slots=True)
class Turn:
    """Wait for nothing: let the run loop look after the driver, the keys and the display."""


STANDSTILL: Final = Standstill()
TURN: Final = Turn()


class Plan(Protocol):
    """When a job comes to which of its moves."""

    def progress(
        self, move: int, in_move_s: float, *, feed: float, rapid: float
    ) -> tuple[float, float]:
        """The share that is done, 0 to 1, and how long the rest takes, s.

        Args:
            move: number of the move in hand; 0: none yet.
            in_move_s: so much of it was made, as planned at 100 %.
            feed: override, a factor.
            rapid: of rapids, likewise.
        """


#: Says what must be known to go on with a job: of the tag in hand and the parameters in force.
Note = Callable[[int, Mapping[int, float]], Mapping[str, Any]]

#: A block's tag names the move that it belongs to: its number in the program, above so many bits of
#: its line.
MOVE_BITS: Final = 32
_LINE: Final = (1 << MOVE_BITS) - 1


def line_of(tag: int) -> int:
    """The line that a block belongs to; 0: none."""
    return tag & _LINE


def move_of(tag: int) -> int:
    """The number of the move that a block belongs to, from 1; 0: none."""
    return tag >> MOVE_BITS


Demand = Block | Standstill | Ask | Doing | Turn
Job = Generator[Demand, Report, None]
