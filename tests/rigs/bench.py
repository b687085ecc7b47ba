"""Small firmwares on a simulated ATmega328P, and what is read off their pins."""

from pathlib import Path

import numpy as np

from rigs.avr.binding import Repair
from rigs.avr.build import firmware
from rigs.avr.simavr import Avr

FIRMWARES = Path(__file__).parent / "avr"
#: All self-test firmwares have shown what they show by then.
LONG_ENOUGH_CYCLES = 8_000


def powered(name: str, repairs: Repair = Repair.ALL, flags: tuple[str, ...] = ()) -> Avr:
    """A microcontroller with one of the small firmwares, not yet running."""
    return Avr(firmware(FIRMWARES / f"{name}.c", flags=flags), repairs)


def ran(name: str, repairs: Repair = Repair.ALL, flags: tuple[str, ...] = ()) -> Avr:
    """The same, after all it has to show."""
    avr = powered(name, repairs, flags)
    avr.run(LONG_ENOUGH_CYCLES)
    return avr


def cycles(avr: Avr, port: str) -> list[int]:
    """When a port was written."""
    return [int(cycle) for cycle in avr.writes(port)["cycle"]]


def values(avr: Avr, port: str) -> list[int]:
    """What was written to it."""
    return [int(value) for value in avr.writes(port)["value"]]


def gaps(avr: Avr, port: str) -> list[int]:
    """Cycles from one write to the next."""
    return [int(gap) for gap in np.diff(avr.writes(port)["cycle"].astype(np.int64))]
