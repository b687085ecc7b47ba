"""How good a line to a greeted device is: questions answered, frames carried."""

import time
from typing import Final, NamedTuple

from fraese.motor.bridge.constants import KIND_PING
from fraese.motor.bridge.session import Session

_QUESTIONS: Final = 50
#: Half a second at 250,000 baud; every byte value that is no command.
_FRAMES: Final = 200
_PAYLOAD: Final = bytes(range(0x50, 0xB0, 2))


class Carried(NamedTuple):
    """What became of some frames.

    Attributes:
        frames: that were to be carried.
        resent: how many had to be sent again.
        damaged: frames and bytes that the device found damaged.
    """

    frames: int
    resent: int
    damaged: int


def round_trips_s(session: Session) -> list[float]:
    """How long it takes to be answered, some times over, s.

    Raises:
        PortError: if it is not.
    """
    trips_s = []
    for _ in range(_QUESTIONS):
        since_s = time.perf_counter()
        session.ask()
        trips_s.append(time.perf_counter() - since_s)
    return trips_s


def carry(session: Session) -> Carried:
    """Send frames that do nothing, as fast as it goes.

    Raises:
        PortError: if the line is lost.
    """
    link, before = session.link, session.ask()
    resent = link.resent
    for _ in range(_FRAMES):
        link.command(KIND_PING, _PAYLOAD)
    session.pump_until(lambda: link.done >= link.last_command)
    damaged = (session.ask().line_errors - before.line_errors) & 0xFF
    return Carried(_FRAMES, link.resent - resent, damaged)
