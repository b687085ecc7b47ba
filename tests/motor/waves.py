"""What a drive sees: the lines of a recorded run, as levels over time.

Rule 1: writes at one moment are one change: what is there for no time is not there, but told of in
        ``blips``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final, NamedTuple

from fraese.motor.pins import CONTROL_PINS, levels
from fraese.motor.ports.recorder import Access
from fraese.motor.seams import CONTROL, DATA

CYCLE_NS: Final = 62.5
BOOST: Final = 16
ACTIVE: Final = 17
MOTORS: Final = 4
_FOR_EVER_NS: Final = 1 << 62


class Edge(NamedTuple):
    """A change of a line."""

    at_ns: int
    high: bool


@dataclass
class Wave:
    """One line.

    Attributes:
        edges: its changes, alternating; it began low.
        blips: moments at which it went there and back.
    """

    edges: list[Edge] = field(default_factory=list)
    blips: list[int] = field(default_factory=list)

    def take(self, at_ns: int, high: bool) -> None:
        """The line has this level now."""
        if self.high == high:
            return
        if self.edges and self.edges[-1].at_ns == at_ns:
            self.edges.pop()
            self.blips.append(at_ns)
        else:
            self.edges.append(Edge(at_ns, high))

    @property
    def high(self) -> bool:
        """Its last level."""
        return bool(self.edges) and self.edges[-1].high

    def at(self, at_ns: float) -> bool:
        """Its level at a moment, after what changes then."""
        level = False
        for edge in self.edges:
            if edge.at_ns > at_ns:
                break
            level = edge.high
        return level

    def stretches(self) -> list[tuple[int, int]]:
        """From when to when it was high; it ended low."""
        assert not self.high
        times = [edge.at_ns for edge in self.edges]
        return list(zip(times[::2], times[1::2], strict=True))


class Waves:
    """All lines of a step/direction card.

    Args:
        accesses: from before the first move on, all lines low.

    Attributes:
        clocks: one a motor,
        directions: likewise.
        active, boost: pins 17 and 16.
    """

    def __init__(self, accesses: Sequence[Access]) -> None:
        self.clocks = [Wave() for _ in range(MOTORS)]
        self.directions = [Wave() for _ in range(MOTORS)]
        control = {pin: Wave() for pin in CONTROL_PINS}
        self.active, self.boost = control[ACTIVE], control[BOOST]
        for at_ns, register, value in accesses:
            if register == DATA:
                for motor in range(MOTORS):
                    self.directions[motor].take(at_ns, bool(value >> 2 * motor & 1))
                    self.clocks[motor].take(at_ns, bool(value >> 2 * motor & 2))
            elif register == CONTROL:
                for pin, high in levels(value, CONTROL_PINS).items():
                    control[pin].take(at_ns, high)

    def leader(self) -> Wave:
        """The clock with most pulses."""
        return max(self.clocks, key=lambda wave: len(wave.edges))

    def pulses(self) -> list[tuple[int, int]]:
        """Rise and fall of every pulse of the leader."""
        return self.leader().stretches()

    def pauses_ns(self) -> list[int]:
        """Between the leader's pulses."""
        return [after[0] - before[1] for before, after in pairwise(self.pulses())]

    def shortest_ns(self) -> int:
        """The shortest pulse or pause of any clock."""
        gaps = (
            after.at_ns - before.at_ns
            for wave in self.clocks
            for before, after in pairwise(wave.edges)
        )
        return min(gaps, default=_FOR_EVER_NS)

    def lead_ns(self) -> int:
        """The shortest time for which a direction stood before a step of its motor."""
        leads = [
            rise
            - max((edge.at_ns for edge in turns.edges if edge.at_ns <= rise), default=-_FOR_EVER_NS)
            for clock, turns in zip(self.clocks, self.directions, strict=True)
            for rise, _ in clock.stretches()
        ]
        return min(leads, default=_FOR_EVER_NS)

    def steps(self) -> tuple[int, ...]:
        """Signed steps that drives make of it: the direction counts at the rising edge."""
        return tuple(
            sum(1 if turns.at(rise) else -1 for rise, _ in clock.stretches())
            for clock, turns in zip(self.clocks, self.directions, strict=True)
        )
