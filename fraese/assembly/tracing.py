"""Waveforms of a machine: what hangs on which pin, and where the accesses are seen.

    kind         seen
    simulation   between the core and the simulated mill
    ppdev        in the step process, between its core and the port
    devport      likewise
    bridge       nowhere: what a parallel port would see of the blocks that were played

What hangs on which line, the record of the card says: ``kinds/card.py``.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from fraese.config import Config
from fraese.config.wiring import PortConfig
from fraese.kinds.card import card_kind
from fraese.motor.meaning import Meaning
from fraese.motor.ports.traced import TracedPort
from fraese.motor.seams import Clock, Port
from fraese.motor.waveform import Waveform


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


def _meaning(config: Config) -> Meaning:
    kind = card_kind(config)
    return Meaning(kind.pins(config), partial(kind.decoder, config))


def recorded(port: PortConfig) -> Path | None:
    """The waveform file that the configuration wants of every command; None: none."""
    return Path(port.record).expanduser() if port.record else None


def wanted(config: Config, path: Path | None) -> Wanted | None:
    """The waveform of the machine that a configuration describes; None: none is wanted."""
    if path is None:
        return None
    return Wanted(path, "port", _meaning(config))


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
