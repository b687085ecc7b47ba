"""What came of opening the configured port, or the bridge, once."""

from dataclasses import dataclass
from enum import IntEnum

from fraese.motor.bridge.codec import Hello
from fraese.motor.bridge.trial import Carried
from fraese.motor.bridge.usb import SerialFacts
from fraese.motor.ports.facts import StatusLines


class Stage(IntEnum):
    """How far it came."""

    NOWHERE = 0
    FOUND = 1
    OPENED = 2
    GREETED = 3
    TOLD = 4
    TRIED = 5


@dataclass(frozen=True, slots=True)
class Board:
    """What was seen of it.

    Attributes:
        stage: how far it came.
        serial: its port from outside; None: it is not known which.
        baud: rate that was spoken.
        hello: what the device said of itself; None: it was not greeted.
        trips_s: how long each of some answers took, s.
        carried: what became of some frames; None: none were sent.
    """

    stage: Stage = Stage.NOWHERE
    serial: SerialFacts | None = None
    baud: int = 0
    hello: Hello | None = None
    trips_s: tuple[float, ...] = ()
    carried: Carried | None = None


@dataclass(frozen=True, slots=True)
class Opening:
    """What came of it.

    Attributes:
        error: why it failed; empty: it did not.
        lines: inputs as they read; None: not read.
        pins: outputs as they were left: DB25 pin, and whether it is high.
        board: the bridge's; None: there is none.
    """

    error: str = ""
    lines: StatusLines | None = None
    pins: tuple[tuple[int, bool], ...] = ()
    board: Board | None = None
