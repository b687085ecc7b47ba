"""The real firmware in a simulated microcontroller, and a simulated mill on its pins.

    driver <--bytes--> ChipLine <--> Avr: firmware --pins--> register writes --> twin mill
                                      ^                                            |
                                      '---------- status pins: end switches -------'

Time is the chip's, and passes only while somebody reads the line or waits. Every write is replayed
into the mill at its cycle; what the mill's switches say is on the pins a quarter of a millisecond
later.
"""

import math

from fraese.errors import PortError
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.ledger import Ledger
from fraese.motor.bridge.line import OpenLine
from fraese.motor.clock import VirtualClock
from fraese.motor.seams import CONTROL, DATA, End
from rigs.avr.board import UNO, Decoder
from rigs.avr.simavr import Avr
from tests.bridge.device import image
from tests.motor.workbench import TIRELESS, Workbench

CYCLES_PER_S = 16_000_000
#: So often the pins are looked at.
SLICE_CYCLES = 4_000
#: A person's hand is not faster.
HAND_S = 0.005


def ns_of(cycle: int) -> int:
    return cycle * 1000 // 16


class Chip:
    """A microcontroller, the mill behind it, and time.

    Attributes:
        avr: the simulated chip.
        twin: a workbench whose mill sees every register write.
        plugged: the line's plug is in.
    """

    def __init__(self, wiring: str) -> None:
        self.avr = Avr(image())
        self._twin_clock = VirtualClock()
        self.twin = Workbench(wiring, limits=TIRELESS, outputs=True, clock=self._twin_clock)
        self._decoder = Decoder()
        self._replays = False
        self._pins: dict[str, bool] = {}
        self.plugged = True
        self.advance(CYCLES_PER_S // 50)

    # --- the clock -------------------------------------------------------------------------------

    def now_ns(self) -> int:
        return ns_of(self.avr.cycle)

    def wait_until(self, deadline_ns: int) -> int:
        while self.now_ns() < deadline_ns:
            left = (deadline_ns - self.now_ns()) * 16 // 1000 + 1
            self.advance(min(left, SLICE_CYCLES))
        return self.now_ns()

    def pass_by(self, elapsed_ns: int) -> None:
        self.wait_until(self.now_ns() + elapsed_ns)

    def advance(self, cycles: int) -> None:
        self.avr.run(cycles)
        self._replay()
        self._drive_pins()

    def begin(self) -> None:
        """From now on the mill is wired up: what the pins do at a reset is not of interest."""
        self._replays = True

    def _replay(self) -> None:
        events = self.avr.take_log()
        kept = self._decoder._kept
        if not len(events) and (kept is None or not len(kept)):
            return
        port = self.twin.port
        write = {DATA: port.write_data, CONTROL: port.write_control}
        for access in self._decoder.decode(events, self.avr.cycle):
            if self._replays:
                self._twin_clock.wait_until(ns_of(int(access["cycle"])))
                write[int(access["register"])](int(access["value"]))

    def _drive_pins(self) -> None:
        self._twin_clock.wait_until(self.now_ns())
        for pin, level in UNO.status_pins(self.twin.simulated.read_status()):
            if self._pins.get(pin) != level:
                self._pins[pin] = level
                self.avr.set_pin(pin, level)


class ChipLine:
    """A Line whose other end is the chip.

    Attributes:
        sent: bytes sent so far.
        closed: it was given back.
    """

    def __init__(self, chip: Chip) -> None:
        self._chip = chip
        self.sent = 0
        self.closed = False

    def read(self, timeout_s: float) -> bytes:
        self._require_plug()
        # Rounded up: who waits for less than a cycle must not wait for ever.
        until = self._chip.avr.cycle + math.ceil(timeout_s * CYCLES_PER_S)
        while True:
            data = self._chip.avr.take()
            left = until - self._chip.avr.cycle
            if data or left <= 0:
                return data
            self._chip.advance(min(left, SLICE_CYCLES))

    def write(self, data: bytes) -> None:
        self._require_plug()
        self.sent += len(data)
        self._chip.avr.feed(data)

    def set_baud(self, baud: int) -> None:
        self._chip.avr.set_host_baud(baud)

    def close(self) -> None:
        self.closed = True

    def _require_plug(self) -> None:
        if not self._chip.plugged:
            raise PortError("the line is gone (Input/output error): is the plug still in?")


class FirmwareBench:
    """The workbench around a bridge: the same questions, answered by the twin.

    Attributes:
        chip: the microcontroller.
        driver: the host's side.
        clock: the chip's.
        lines: every line that was opened.
    """

    def __init__(
        self, wiring: str, capacity: int = 250, safe_outputs: int = 0, silence_s: float = 1.0
    ) -> None:
        self.wiring = wiring
        self.chip = self.clock = Chip(wiring)
        self.twin = self.chip.twin
        self.lines: list[ChipLine] = []
        self.simulated = Hands(self)
        self.chip.begin()
        self._options = (capacity, safe_outputs, silence_s)
        self.driver = self.another_driver()

    def another_driver(
        self, open_line: OpenLine | None = None, ledger: Ledger | None = None
    ) -> BridgeDriver:
        """A program that finds the chip as it is."""
        capacity, safe_outputs, silence_s = self._options
        return BridgeDriver(
            open_line or self.open_line,
            self.twin.card,
            self.clock,
            capacity=capacity,
            safe_outputs=safe_outputs,
            silence_s=silence_s,
            patience_s=0.3,
            ledger=ledger or Ledger(),
        )

    def open_line(self) -> ChipLine:
        line = ChipLine(self.chip)
        line._require_plug()
        self.lines.append(line)
        return line

    def wait(self, seconds: float = 0.05) -> None:
        self.clock.wait_until(self.clock.now_ns() + round(seconds * 1e9))

    # --- a person ------------------------------------------------------------------------------

    def place(self, axis: str, from_low_steps: float) -> None:
        self.twin.place(axis, from_low_steps)
        self.wait(HAND_S)

    def unplug(self) -> None:
        self.chip.plugged = False

    def plug_in(self) -> None:
        """A board gets its current from the plug: it begins anew."""
        self.chip.avr.reset()
        self.chip.advance(CYCLES_PER_S // 50)
        self.chip.plugged = True

    # --- looking ---------------------------------------------------------------------------------

    def carriage(self, axis: str) -> float:
        return self.twin.carriage(axis)

    def carriages(self) -> tuple[float, ...]:
        return self.twin.carriages()

    def lost(self) -> tuple[float, ...]:
        return self.twin.lost()

    def outputs_on(self) -> set[int]:
        return self.twin.outputs_on()

    def currents(self) -> list[tuple[float, float]]:
        return self.twin.currents()

    def mark(self) -> int:
        return self.twin.mark()

    def steps_ns(self, motor: int, since: int = 0) -> list[int]:
        """When a phase card's motor was given another byte."""
        return [
            access.at_ns
            for access in self.twin.accesses(since)
            if access.register == DATA and access.value >> 6 == motor
        ]


class Hands:
    """The person's hands, by the names of the simulated mill."""

    def __init__(self, bench: FirmwareBench) -> None:
        self._bench = bench

    def press(self, end: End) -> None:
        self._bench.twin.simulated.press(end)
        self._bench.wait(HAND_S)

    def let_go(self, end: End) -> None:
        self._bench.twin.simulated.let_go(end)
        self._bench.wait(HAND_S)
