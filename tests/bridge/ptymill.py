"""The firmware behind a serial port, and the configured mill on its pins: for whole programs.

    fraese --config ... --pty--> simhost: firmware --log--> PtyMill: simulated mill
                                     ^-------- status pins -------'

The mill follows in a thread of its own, a millisecond or two behind: switches close that late. The
firmware waits where the mill is further behind, which it is on a busy machine.
"""

import threading
from pathlib import Path

from fraese.assembly.simulation import simulated_mill
from fraese.config import Config
from fraese.motor.clock import VirtualClock
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.seams import CONTROL, DATA
from rigs.avr.host import SimHost, prefer
from tests.bridge.device import image

_PAUSE_S = 0.001
_BEHIND_CYCLES = 64_000


class PtyMill:
    """A bridge with a mill, on a serial port that other programs can open.

    Args:
        folder: for the port and the log.
        config: the mill, and its card.
        options: of simhost.

    Attributes:
        host: the simulated microcontroller.
        mill: what hangs on it.
    """

    def __init__(self, folder: Path, config: Config, options: tuple[str, ...] = ()) -> None:
        self._clock = VirtualClock()
        self.mill: SimulatedMill = simulated_mill(config, self._clock)
        self.host = SimHost(image(), folder, options)
        self.port = self.host.port
        self._ends = threading.Event()
        self._lock = threading.Lock()
        self.host.set_status(self.mill.read_status())
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self._thread.start()

    def __enter__(self) -> "PtyMill":
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join()
        self.host.stop()

    def _follow(self) -> None:
        prefer(threading.get_native_id())
        while not self._ends.wait(_PAUSE_S):
            with self._lock:
                self._catch_up()

    def _catch_up(self) -> None:
        # The log is complete up to here; the mill must not be ahead of what it is still to be told.
        until_cycle = self.host.cycle
        write = {DATA: self.mill.write_data, CONTROL: self.mill.write_control}
        for access in self.host.accesses():
            self._clock.wait_until(int(access["cycle"]) * 1000 // 16)
            write[int(access["register"])](int(access["value"]))
        self._clock.wait_until(until_cycle * 1000 // 16)
        self.host.set_status(self.mill.read_status())
        self.host.wait_at(until_cycle + _BEHIND_CYCLES)

    def carriages_steps(self) -> tuple[float, ...]:
        """Where they are, from the lower switches."""
        with self._lock:
            self._catch_up()
            return self.mill.look().carriages_steps

    def lost_steps(self) -> tuple[float, ...]:
        """What rotors could not follow."""
        with self._lock:
            return self.mill.look().lost_steps

    def currents(self) -> set[tuple[float, float]]:
        """What a clamp meter shows."""
        with self._lock:
            self._catch_up()
            return {(*pair,) for pair in self.mill.look().currents}
