"""Programs that use X4Step, tried without a machine: pins by hand, keys, and recorded lines.

    from fraese.x4step import X4GetState, X4Init, X4Load, X4ReInit, X4Start
    from fraese.x4step.testing import simulation

    with simulation() as lab:
        X4Init(2)
        X4Load(1000, 0, 0, 0, 1000, 50)
        X4Start()
        lab.at_ms(300, lambda: lab.press(1))      # ESC, in the middle of it
        while X4GetState():
            pass
        X4ReInit()
    assert len(lab.lines().rises(clock_pin(1))) < 500

Time is virtual, unless wanted otherwise: it passes by a millisecond when the program asks the same
question again, as a loop that waits does, and while X4ReInit waits. So a test takes no time, and
sees the same every time.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Final, Literal, NamedTuple

from fraese.config import Config
from fraese.motor.cards import stepdir
from fraese.motor.clock import PacedClock, VirtualClock
from fraese.motor.pins import CONTROL_PINS, DATA_PINS, levels
from fraese.motor.ports.recorder import Access, Recorder
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import CONTROL, DATA, Clock
from fraese.x4step import lpt as ports
from fraese.x4step.codes import INPUT_PINS
from fraese.x4step.decoder import Key
from fraese.x4step.keyboard import BREAK, char_codes
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.lpt import Opened
from fraese.x4step.surroundings import Surroundings, in_place, made

BOOST_PIN: Final = stepdir.BOOST_PIN
ACTIVE_PIN: Final = stepdir.ACTIVE_PIN
#: Input pins, and how ``X4GetIn`` counts them: its bit.
INPUT_BITS: Final[Mapping[int, int]] = {pin: bit for bit, pin in enumerate(reversed(INPUT_PINS))}

_PINS_OF: Final = {DATA: DATA_PINS, CONTROL: CONTROL_PINS}
_CODES: Final = char_codes("us")
_NS_PER_MS: Final = 1_000_000


def direction_pin(axis: int) -> int:
    """The pin with the direction of an axis, 1 to 4."""
    return 2 * axis


def clock_pin(axis: int) -> int:
    """The pin with the clock of an axis, 1 to 4."""
    return 2 * axis + 1


class Edge(NamedTuple):
    """A pin that changed."""

    at_ns: int
    high: bool


class Lines:
    """What was on the output pins of a port, from its opening on.

    Args:
        accesses: as recorded.
    """

    def __init__(self, accesses: Iterable[Access]) -> None:
        self._edges: dict[int, list[Edge]] = {pin: [] for pin in (*DATA_PINS, *CONTROL_PINS)}
        for at_ns, register, value in accesses:
            for pin, high in levels(value, _PINS_OF.get(register, {})).items():
                edges = self._edges[pin]
                if not edges or edges[-1].high != high:
                    edges.append(Edge(at_ns, high))

    def edges(self, pin: int) -> list[Edge]:
        """All changes of a pin; the first entry is the level that it was given at first."""
        return list(self._edges[pin])

    def rises(self, pin: int) -> list[int]:
        """When it went high, ns; not at the first write."""
        return [edge.at_ns for edge in self._edges[pin][1:] if edge.high]

    def falls(self, pin: int) -> list[int]:
        """When it went low, ns; not at the first write."""
        return [edge.at_ns for edge in self._edges[pin][1:] if not edge.high]

    def level(self, pin: int, at_ns: int | None = None) -> bool:
        """Its level at that moment, or in the end; False before the first write."""
        edges = self._edges[pin]
        count = len(edges)
        if at_ns is not None:
            count = bisect_right(edges, at_ns, key=lambda edge: edge.at_ns)
        return bool(count) and edges[count - 1].high

    def steps(self, axis: int) -> int:
        """Signed steps of an axis: rising edges of its clock, by the level of its direction."""
        direction = direction_pin(axis)
        return sum(
            1 if self.level(direction, at_ns) else -1 for at_ns in self.rises(clock_pin(axis))
        )


class StageClock(VirtualClock):
    """A virtual clock that does things at given moments."""

    def __init__(self) -> None:
        super().__init__()
        self._plan: list[tuple[int, Callable[[], object]]] = []

    def plan(self, at_ns: int, action: Callable[[], object]) -> None:
        """Do that when somebody waits beyond this moment."""
        self._plan.append((at_ns, action))
        self._plan.sort(key=lambda item: item[0])

    def wait_until(self, deadline_ns: int) -> int:
        """Jump to the deadline; stop on the way for what was planned."""
        while self._plan and self._plan[0][0] <= deadline_ns:
            at_ns, action = self._plan.pop(0)
            super().wait_until(at_ns)
            action()
        return super().wait_until(deadline_ns)


class Lab:
    """What a person at the simulated ports sees and does.

    Attributes:
        keys: what is pressed.
        opened: every port that was opened, with its number, in order.
    """

    def __init__(self) -> None:
        self.keys = HandKeys()
        self.opened: list[tuple[int, Opened]] = []
        self._plans: list[tuple[float, Callable[[], object]]] = []

    def take(self, lpt: int, opened: Opened) -> None:
        """A port was opened."""
        self.opened.append((lpt, opened))
        plans, self._plans = self._plans, []
        for ms, action in plans:
            self.at_ms(ms, action)

    def port(self, lpt: int | None = None) -> Opened:
        """The port that was opened last, or last under that number."""
        return next(
            opened for number, opened in reversed(self.opened) if lpt is None or number == lpt
        )

    def mill(self, lpt: int | None = None) -> SimulatedMill:
        """What hangs on it."""
        mill = self.port(lpt).mill
        assert mill is not None
        return mill

    def recorder(self, lpt: int | None = None) -> Recorder:
        """Every access to it."""
        recorder = self.port(lpt).recorder
        assert recorder is not None
        return recorder

    def lines(self, lpt: int | None = None) -> Lines:
        """What was on its output pins so far."""
        return Lines(self.recorder(lpt).accesses)

    def now_ns(self, lpt: int | None = None) -> int:
        """Its time."""
        return self.port(lpt).clock.now_ns()

    def set_pin(self, pin: int, high: bool, lpt: int | None = None) -> None:
        """Put a level on an input pin: 10, 11, 12, 13 or 15.

        Raises:
            ValueError: if it is no input.
        """
        ports.set_pin(self.mill(lpt), pin, high)

    def set_inputs(self, value: int, lpt: int | None = None) -> None:
        """Put levels on all inputs, counted as ``X4GetIn`` does."""
        for pin, bit in INPUT_BITS.items():
            self.set_pin(pin, bool(value >> bit & 1), lpt)

    def press(self, code: int) -> None:
        """A key goes down, by its make code."""
        self.keys.press(code)

    def type(self, text: str) -> None:
        """Characters are typed at standstill, for ``getch``."""
        self.keys.type(*(Key(_CODES.get(char, 0), char) for char in text))

    def release(self, code: int) -> None:
        """It comes up."""
        self.keys.press(code | BREAK)

    def at_ms(self, ms: float, action: Callable[[], object], lpt: int | None = None) -> None:
        """Do something so many ms of virtual time from now, or from the next opening of a port.

        Raises:
            TypeError: if time is not virtual.
        """
        if not self.opened:
            self._plans.append((ms, action))
            return
        clock = self.port(lpt).clock
        if not isinstance(clock, StageClock):
            raise TypeError("things can be planned on a virtual clock only")
        clock.plan(clock.now_ns() + round(ms * _NS_PER_MS), action)


_CLOCKS: Final[Mapping[str, Callable[[], Clock]]] = {"virtual": StageClock, "paced": PacedClock}


@contextmanager
def simulation(
    clock: Literal["virtual", "paced"] = "virtual",
    *,
    config: Config | None = None,
    pins: Mapping[int, bool] | None = None,
) -> Iterator[Lab]:
    """Have X4Init and X4Step open simulated ports, recorded, with keys of the test.

    Args:
        clock: virtual, or in step with the wall.
        config: what else would stand in the configuration.
        pins: levels of inputs at the opening; the others are high.
    """
    lab = Lab()
    inner = made(
        config or Config(),
        _CLOCKS[clock],
        pins or {},
        Keyboard(lab.keys),
        is_lockstep=clock == "virtual",
        record=True,
    )

    def opened(lpt: int) -> Opened:
        port = inner.open(lpt)
        lab.take(lpt, port)
        return port

    with in_place(Surroundings(opened, inner.keyboard, inner.is_lockstep)):
        yield lab
