"""A simulated mill in the child's process, and a person who stands beside it, here.

    here                                     the child
    ChildBench --hands: press, place-------> DistantMill (Port) --> simulated mill
        |                                        |  every access, with its time
        twin mill <--replayed------------------- log

The child drives its own simulated mill, which closes its own switches. What it did is looked at by
replaying every access into a twin of that mill: both saw the same registers at the same times.
"""

import mmap
import struct
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Final

from fraese.motor.clock import MonotonicClock, VirtualClock
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.setup import RealtimeOptions, Setup
from fraese.motor.seams import CONTROL, DATA, STATUS, End
from fraese.motor.switches import SwitchInput
from tests.motor.workbench import AXES, TIRELESS, Workbench

_HEADER: Final = struct.Struct("=4q")
_ENTRY: Final = struct.Struct("=3q")
_BYTES: Final = 1 << 22
_ENTRIES: Final = (_BYTES - _HEADER.size) // _ENTRY.size

#: In the log, beside the registers: what a person did.
_PRESS: Final = 16
_LET_GO: Final = 17
_PLACE: Final = 18

_PATIENCE_S: Final = 5.0


class Log:
    """Accesses in a file that both processes map; one writer a word.

    Words: entries written; hands wanted, and their kind and argument.
    """

    def __init__(self, path: Path) -> None:
        with path.open("r+b") as file:
            self._map = mmap.mmap(file.fileno(), _BYTES)
        self.words = memoryview(self._map)[: _HEADER.size].cast("q")
        self._count = self.words[0]

    @staticmethod
    def create(path: Path) -> "Log":
        path.write_bytes(bytes(_BYTES))
        return Log(path)

    def note(self, at_ns: int, register: int, value: int) -> None:
        if self._count == _ENTRIES:
            raise MemoryError("the log of the distant mill is full")
        _ENTRY.pack_into(
            self._map, _HEADER.size + self._count * _ENTRY.size, at_ns, register, value
        )
        self._count += 1
        self.words[0] = self._count

    def entries(self, since: int) -> list[tuple[int, int, int]]:
        at = [_HEADER.size + number * _ENTRY.size for number in range(since, self.words[0])]
        return [_ENTRY.unpack_from(self._map, offset) for offset in at]


class DistantMill:
    """A Port in the child: a simulated mill that writes everything down, and obeys hands.

    Args:
        path: of the log.
        wiring: as the workbench's.
    """

    def __init__(self, path: Path, wiring: str) -> None:
        self._log = Log(path)
        self._bench = Workbench(wiring, limits=TIRELESS, outputs=True, clock=MonotonicClock())
        self._port = self._bench.simulated
        self._hands = 0

    def write_data(self, value: int) -> None:
        self._log.note(time.monotonic_ns(), DATA, value)
        self._port.write_data(value)

    def write_control(self, value: int) -> None:
        self._log.note(time.monotonic_ns(), CONTROL, value)
        self._port.write_control(value)

    def read_status(self) -> int:
        if self._log.words[1] != self._hands:
            self._hands, kind, value = self._log.words[1:4]
            self._log.note(time.monotonic_ns(), kind, value)
            do_by_hand(self._bench, kind, value)
        status = self._port.read_status()
        self._log.note(time.monotonic_ns(), STATUS, status)
        return status

    def close(self) -> None:
        self._port.close()


def do_by_hand(bench: Workbench, kind: int, value: int) -> None:
    """What a person does at a mill."""
    if kind == _PLACE:
        bench.place(AXES[value % len(AXES)], value // len(AXES))
    else:
        pressed = End(value // 2, 1 if value % 2 else -1)
        (bench.simulated.press if kind == _PRESS else bench.simulated.let_go)(pressed)


class Spectator:
    """Looks at a distant mill through its log.

    Attributes:
        twin: a workbench whose mill has seen what the distant one saw.
    """

    def __init__(self, path: Path, wiring: str) -> None:
        self._log = Log(path)
        # All that is done to the twin has the time at which it was done to the child's mill.
        self._twin_clock = VirtualClock()
        self.twin = Workbench(wiring, limits=TIRELESS, outputs=True, clock=self._twin_clock)
        self.wiring = wiring
        self._seen = 0

    def look(self) -> Workbench:
        """The twin, up to date."""
        twin = self.twin
        access = {DATA: twin.port.write_data, CONTROL: twin.port.write_control}
        for at_ns, register, value in self._log.entries(self._seen):
            self._seen += 1
            self._twin_clock.wait_until(at_ns)
            if register == STATUS:
                twin.port.read_status()
            elif register in access:
                access[register](value)
            else:
                do_by_hand(twin, register, value)
        return twin

    def carriage(self, axis: str) -> float:
        return self.look().carriage(axis)

    def carriages(self) -> tuple[float, ...]:
        return self.look().carriages()

    def lost(self) -> tuple[float, ...]:
        return self.look().lost()

    def outputs_on(self) -> set[int]:
        return self.look().outputs_on()

    def mark(self) -> int:
        return self.look().mark()

    def currents(self) -> list[tuple[float, float]]:
        return self.look().currents()

    def writes(self) -> list[tuple[int, int]]:
        """Registers and values that were written, from the first on."""
        return [(e[1], e[2]) for e in self._log.entries(0) if e[1] in (DATA, CONTROL)]

    def last_write_ns(self) -> int:
        """When a register was written last."""
        return max(at_ns for at_ns, register, _ in self._log.entries(0) if register != STATUS)

    def steps_ns(self, motor: int) -> list[int]:
        """When the data byte of a phase card's motor changed."""
        times, last = [], -1
        for at_ns, register, value in self._log.entries(0):
            if register == DATA and value >> 6 == motor and value != last:
                last = value
                times.append(at_ns)
        return times


class ChildBench(Spectator):
    """The workbench around a child: the same questions, answered by the twin.

    Attributes:
        driver: has the child make the steps.
        clock: the driver's.
    """

    def __init__(
        self,
        wiring: str,
        capacity: int,
        safe_outputs: int,
        options: RealtimeOptions | None = None,
    ) -> None:
        self._folder = tempfile.TemporaryDirectory()
        path = Path(self._folder.name) / "log"
        Log.create(path)
        super().__init__(path, wiring)
        self.clock = MonotonicClock()
        self.simulated = Hands(self)
        self.driver = RealtimeDriver(
            Setup(
                partial(DistantMill, path, wiring),
                self.twin.card,
                SwitchInput(),
                capacity=capacity,
                safe_outputs=safe_outputs,
                options=options or RealtimeOptions(),
            )
        )

    def remove(self) -> None:
        """Clear the bench."""
        self.driver.close()
        self._folder.cleanup()

    # --- a person ------------------------------------------------------------------------------

    def hand(self, kind: int, value: int) -> None:
        """Do something at the mill, and wait until it is done."""
        words = self._log.words
        self.look()
        before = words[0]
        words[2], words[3] = kind, value
        words[1] += 1
        self._wait_for(lambda: any(e[1] == kind for e in self._log.entries(before)))

    @staticmethod
    def _wait_for(happened: Callable[[], bool]) -> None:
        until_s = time.monotonic() + _PATIENCE_S
        while not happened():
            assert time.monotonic() < until_s, "the child does not read its port"
            time.sleep(0.001)

    def place(self, axis: str, from_low_steps: int) -> None:
        """Put a carriage so far from its lower switch; distances count from there."""
        self.hand(_PLACE, from_low_steps * len(AXES) + AXES.index(axis))

    def wait(self, seconds: float = 0.05) -> None:
        """Let time pass."""
        self.clock.wait_until(self.clock.now_ns() + round(seconds * 1e9))


class Hands:
    """The person's hands, by the names of the simulated mill."""

    def __init__(self, bench: ChildBench) -> None:
        self._bench = bench

    def press(self, end: End) -> None:
        self._bench.hand(_PRESS, 2 * end.motor + (end.sign > 0))

    def let_go(self, end: End) -> None:
        self._bench.hand(_LET_GO, 2 * end.motor + (end.sign > 0))
