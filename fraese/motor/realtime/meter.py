"""How late edges are, measured at the port: the difference between deadline and write.

    deadline       |
    write               |        <- noted, after it was made
                   |<-->| late

Rule 1: of every deadline the first edge is noted, no other access: the leader's.
Rule 2: no memory is taken while measuring. When the room is full, edges are only counted.
"""

from collections.abc import Callable

from fraese.motor.realtime.clock import RealtimeClock
from fraese.motor.realtime.memory import FIRST_EDGE, LAST_EDGE, SAMPLES, Memory
from fraese.motor.realtime.setup import Meter
from fraese.motor.seams import CONTROL, DATA, Port

_MOST_NS = 0xFFFF_FFFF


class MeteredPort:
    """A port that notes how late edges are; passes everything on.

    Args:
        port: any other.
        clock: whose deadlines count.
        memory: where to note.
        meter: what an edge is.
    """

    def __init__(self, port: Port, clock: RealtimeClock, memory: Memory, meter: Meter) -> None:
        self._port = port
        self._clock = clock
        self._samples = memory.samples
        self._words = memory.words
        self._mask = meter.mask
        self._room = meter.samples
        self._noted = 0
        self._deadline_ns = 0
        # Accesses that are never an edge go past this class.
        self.read_status = port.read_status
        self.write_data: Callable[[int], None] = port.write_data
        self.write_control: Callable[[int], None] = port.write_control
        if meter.register == DATA:
            self.write_data = self._noting(port.write_data)
        elif meter.register == CONTROL:
            self.write_control = self._noting(port.write_control)

    def _noting(self, write: Callable[[int], None]) -> Callable[[int], None]:
        mask, clock, now_ns = self._mask, self._clock, self._clock.now_ns

        def noting(value: int) -> None:
            write(value)
            if value & mask and clock.deadline_ns != self._deadline_ns:
                self._note(now_ns(), clock.deadline_ns)

        return noting

    def _note(self, now_ns: int, deadline_ns: int) -> None:
        self._deadline_ns = deadline_ns
        words = self._words
        if not self._noted:
            words[FIRST_EDGE] = now_ns
        words[LAST_EDGE] = now_ns
        if self._noted < self._room:
            self._samples[self._noted] = min(max(now_ns - deadline_ns, 0), _MOST_NS)
        self._noted += 1
        words[SAMPLES] = self._noted

    def close(self) -> None:
        """Pass on."""
        self._port.close()
