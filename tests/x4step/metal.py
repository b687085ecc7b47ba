"""A parallel port in the step process that writes everything down, for programs in real time.

program --X4Step--> owner's thread --> RealtimeDriver --> child --> LoggedPort --> log
"""

import time
from functools import partial
from pathlib import Path
from typing import Final

from fraese.config import Config
from fraese.config.x4step import LptConfig
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.recorder import Access
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.seams import CONTROL, DATA
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.lpt import METAL_IDLE_S, Opened, Wanted, realtime_setup
from fraese.x4step.surroundings import Surroundings
from fraese.x4step.testing import Lines
from tests.helpers import configured
from tests.motor.distantmill import Log

#: All pins high; 11 is inverted.
AT_REST: Final = 0x78


class LoggedPort:
    """A port without anything behind it. Opened in the child.

    Args:
        path: of the log.
    """

    def __init__(self, path: Path) -> None:
        self._log = Log(path)

    def write_data(self, value: int) -> None:
        self._log.note(time.monotonic_ns(), DATA, value)

    def write_control(self, value: int) -> None:
        self._log.note(time.monotonic_ns(), CONTROL, value)

    def read_status(self) -> int:
        return AT_REST

    def close(self) -> None:
        pass


class Metal:
    """Surroundings with a step process.

    Attributes:
        around: to open an ``X4Step`` in.
        keys: what is pressed.
    """

    def __init__(self, folder: Path, silent_s: float = 2.0) -> None:
        self._log = Log.create(folder / "port.log")
        self._path = folder / "port.log"
        self._config: Config = configured(realtime={"silent_s": silent_s})
        self.keys = HandKeys()
        self.driver: RealtimeDriver | None = None
        self.around = Surroundings(self._open, Keyboard(self.keys), is_lockstep=False)

    def _open(self, lpt: int) -> Opened:
        wanted = Wanted(lpt, self._config, LptConfig(kind="ppdev"), MonotonicClock)
        setup = realtime_setup(wanted, partial(LoggedPort, self._path))
        self.driver = RealtimeDriver(setup)
        return Opened(self.driver, MonotonicClock(), 0.004, METAL_IDLE_S)

    def lines(self) -> Lines:
        """What was written so far."""
        return Lines(Access(*entry) for entry in self._log.entries(0))
