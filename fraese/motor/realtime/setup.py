"""What the child is told once, at its start: the only thing that is pickled."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from fraese.motor.seams import HALF_Q16, Card, Port
from fraese.motor.switches import SwitchInput

#: A gap between two waits in which there is time to sleep, s: a nap, and the spin after it.
SLEEP_GAP_S: Final = 150e-6


@dataclass(frozen=True, slots=True)
class ChargePump:
    """A free output that toggles while the step loop lives; some drives want to see that.

    A parallel port's pins stay as they are when the machine behind it dies.

    Attributes:
        output: bit of the free outputs.
        rate_hz: periods a second, where the step rate leaves time; at most some hundreds.
    """

    output: int
    rate_hz: float = 100.0


@dataclass(frozen=True, slots=True)
class RealtimeOptions:
    """How the child gets its time.

    Attributes:
        top_rate_hz: the highest step rate of any axis: does it leave time to sleep?
        core: the processor to stay on; None: the one that ``cores.core_for_steps`` chooses.
        silent_s: so long may the host call no driver method while the motors run.
        pump: an output that shows that the loop lives.
    """

    top_rate_hz: float = 5000.0
    core: int | None = None
    silent_s: float = 1.0
    pump: ChargePump | None = None


@dataclass(frozen=True, slots=True)
class Meter:
    """Measure how late edges are written.

    Attributes:
        register: a write to this one,
        mask: with any of these bits set, is the edge.
        samples: room for so many.
    """

    register: int
    mask: int
    samples: int


@dataclass(frozen=True, slots=True)
class WordsTo:
    """Where a step process leaves its last words.

    Attributes:
        fd: of a file of the host's; the child has it under the same number.
        token: of the session, 16 bytes.
        base_steps: what the counts of this child are added to; empty: it is the first one.
    """

    fd: int
    token: bytes
    base_steps: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Setup:
    """Everything the child needs; the arguments of ``MotorCore``, and how to open the port."""

    open_port: Callable[[], Port]
    card: Card
    switch: SwitchInput = field(default_factory=SwitchInput)
    settle_s: float = 0.02
    capacity: int = 256
    safe_outputs: int = 0
    options: RealtimeOptions = field(default_factory=RealtimeOptions)
    meter: Meter | None = None
    #: File descriptors that the child keeps, under the same numbers: a lock, say.
    inherited: tuple[int, ...] = ()
    #: Where the child leaves its last words (``lastwords.py``); None: nowhere.
    last_words: WordsTo | None = None

    def kept_fds(self) -> tuple[int, ...]:
        """All file descriptors that the child keeps."""
        return self.inherited + ((self.last_words.fd,) if self.last_words else ())

    def gap_s(self) -> float:
        """Shortest wait at the highest rate: with clock lines there are two waits a tick."""
        duty = self.card.duty_q16 / (2 * HALF_Q16)
        return (min(duty, 1 - duty) if self.card.fall else 1) / self.options.top_rate_hz
