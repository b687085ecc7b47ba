"""Waveforms of a machine: what hangs on which pin, and where the accesses are seen.

    kind         seen
    simulation   between the core and the simulated mill
    ppdev        in the step process, between its core and the port
    devport      likewise
    bridge       nowhere: what a parallel port would see of the blocks that were played

Another card is a row in ``MEANINGS``.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

from fraese.config import Config
from fraese.motor.cards.stepdir import ACTIVE_PIN, BOOST_PIN
from fraese.motor.meaning import CoilCurrents, Decoder, Meaning
from fraese.motor.phases import LEVEL_MAPS
from fraese.motor.pins import STATUS_PINS
from fraese.motor.ports.traced import TracedPort
from fraese.motor.seams import Clock, Port
from fraese.motor.waveform import Waveform

#: The bits of a phase card's data byte, from pin 2 on.
_PHASE_BITS: Final = ("a_code0", "a_code1", "a_negative", "b_code0", "b_code1", "b_negative")
_SOCKET_BITS: Final = ("socket0", "socket1")


class Trace(Protocol):
    """A waveform in the making.

    Attributes:
        waveform: its file.
    """

    waveform: Waveform

    def close(self) -> None:
        """The driver is closed: the file is whole. Safe to call twice."""


@dataclass(frozen=True)
class Wanted:
    """A waveform that is wanted.

    Attributes:
        path: of the file.
        scope: what the lines belong to, one word.
        meaning: what hangs on them.
    """

    path: Path
    scope: str
    meaning: Meaning

    def begin(self) -> Waveform:
        """Its file.

        Raises:
            TraceError: if it cannot be written.
        """
        return Waveform(self.path, self.scope, self.meaning)


def step_direction_pins(names: Mapping[int, str]) -> dict[int, str]:
    """What hangs on the pins of step/direction drives.

    Args:
        names: of the axis in each socket; empty: none.
    """
    pins = {BOOST_PIN: "boost", ACTIVE_PIN: "active"}
    for socket, name in names.items():
        pins |= {2 + 2 * socket: _word(name, "direction"), 3 + 2 * socket: _word(name, "clock")}
    return pins | dict.fromkeys(STATUS_PINS, "input")


def _word(name: str, line: str) -> str:
    return f"{name}_{line}"


def _phase_pins() -> dict[int, str]:
    data = {2 + bit: word for bit, word in enumerate((*_PHASE_BITS, *_SOCKET_BITS))}
    return data | {1: "nstrobe"} | dict.fromkeys(STATUS_PINS, "input")


def _names(config: Config) -> dict[int, str]:
    return dict(zip(config.axes.sockets, config.axes.names, strict=True))


def _wired(config: Config) -> dict[int, str]:
    """What the configuration says of outputs and inputs."""
    pins: dict[int, str] = {output.pin: name for name, output in config.outputs.configured()}
    if config.probe.pin is not None:
        pins[config.probe.pin] = "probe"
    return pins | {config.switches.pin: "switches"}


def _phases(config: Config) -> Meaning:
    def decoder() -> Decoder:
        return CoilCurrents(_names(config), LEVEL_MAPS[config.card.levels])

    return Meaning(_phase_pins() | _wired(config), decoder)


def _step_direction(config: Config) -> Meaning:
    return Meaning(step_direction_pins(_names(config)) | _wired(config))


MEANINGS: Final[Mapping[str, Callable[[Config], Meaning]]] = {
    "smc1500": _phases,
    "stepdir": _step_direction,
}


def wanted(config: Config, path: Path | None) -> Wanted | None:
    """The waveform of the machine that a configuration describes; None: none is wanted."""
    if path is None:
        return None
    return Wanted(path, "port", MEANINGS[config.card.kind](config))


@contextmanager
def closed_on_failure(waveform: Waveform | None) -> Iterator[None]:
    """What is driven cannot be opened: then there is no waveform of it."""
    try:
        yield
    except BaseException:
        if waveform is not None:
            waveform.close(0)
        raise


class LocalTrace:
    """Of a port that is written in this thread.

    Args:
        waveform: its file.
        clock: of the driver.
    """

    def __init__(self, waveform: Waveform, clock: Clock) -> None:
        self.waveform = waveform
        self._clock = clock

    def on(self, port: Port) -> Port:
        """That port, with everything noted."""
        return TracedPort(port, self._clock.now_ns, self.waveform.note)

    def close(self) -> None:
        """The last moment."""
        self.waveform.close(self._clock.now_ns())
