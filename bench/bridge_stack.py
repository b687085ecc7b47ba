"""Figures of the whole bridge: driver, line and the real firmware, in the time of the chip.

    python -m bench.bridge_stack [--steps 10000000]

The microcontroller is simulated, its time is exact and passes only while the host waits or is made
to stand still; so the figures do not depend on this computer.

Source of the demands: steps and queue at 250,000 baud, blocks of 4 ms; a host that stands still for
200 ms; one frame in 200 damaged; 10 ms from the key to the first longer interval.
"""

import argparse
import random
import statistics
from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from fraese.blocks import CYCLES_PER_S, Block, Piece, accel_q_from_hz_s, rate_q8_from_hz
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.line import Line
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.phases import MOTRUN
from fraese.motor.seams import DATA
from rigs.avr.board import Decoder
from rigs.avr.simavr import Avr
from tests.bridge.device import image, reason_to_skip

FULL_RATE_HZ = 25_000
SMC_RATE_HZ = 5_000
BLOCK_S = 0.004
STILL_S = 0.2
DAMAGED_ONE_IN = 200
_READ_CYCLES = 4_000


class Chip:
    """A microcontroller with nothing on its pins, and the clock that it is.

    Attributes:
        writes: cycle and value of every data byte since the last ``take``.
    """

    def __init__(self) -> None:
        self.avr = Avr(image())
        self.avr.run(CYCLES_PER_S // 50)
        # No contact, or every run would end at once.
        self.avr.set_pin("C0", False)
        for pin in ("C1", "C2", "C3", "C4"):
            self.avr.set_pin(pin, True)
        self._decoder = Decoder()

    def now_ns(self) -> int:
        return self.avr.cycle * 1000 // 16

    def wait_until(self, deadline_ns: int) -> int:
        self.avr.run(max(0, deadline_ns * 16 // 1000 - self.avr.cycle))
        return self.now_ns()

    def pass_by(self, elapsed_ns: int) -> None:
        self.wait_until(self.now_ns() + elapsed_ns)

    def movements(self) -> np.ndarray:
        """Data bytes since the last call, in order, with their cycles."""
        accesses = self._decoder.decode(self.avr.take_log(), self.avr.cycle)
        chosen: np.ndarray = accesses[accesses["register"] == DATA]
        return chosen


class ChipLine:
    """A line to the chip, on which one frame in so many is damaged, both ways.

    Args:
        chip: at the other end.
        one_in: 0: none is.
    """

    def __init__(self, chip: Chip, one_in: int = 0) -> None:
        self._chip = chip
        self._one_in = one_in
        self._random = random.Random(1)
        self.damaged = 0

    def read(self, timeout_s: float) -> bytes:
        avr = self._chip.avr
        until = avr.cycle + round(timeout_s * CYCLES_PER_S)
        while not (data := avr.take()) and avr.cycle < until:
            avr.run(min(until - avr.cycle, _READ_CYCLES))
        return self._worn(data)

    def write(self, data: bytes) -> None:
        self._chip.avr.feed(self._worn(data))

    def set_baud(self, baud: int) -> None:
        self._chip.avr.set_host_baud(baud)

    def close(self) -> None:
        pass

    def _worn(self, data: bytes) -> bytes:
        """A frame is about 60 bytes."""
        if not self._one_in or not data or self._random.random() * self._one_in * 60 > len(data):
            return data
        self.damaged += 1
        at = self._random.randrange(len(data))
        return data[:at] + bytes((data[at] ^ 1 << self._random.randrange(8),)) + data[at + 1 :]


class Rig:
    """A chip, a line and a driver."""

    def __init__(self, one_in: int = 0) -> None:
        self.chip = Chip()
        self.line = ChipLine(self.chip, one_in)

        def open_line() -> Line:
            return self.line

        self.driver = BridgeDriver(open_line, SmcCard(), self.chip, patience_s=0.5)
        self.chip.movements()


def contour(rate_hz: float, seconds: float = BLOCK_S, seed: int = 1) -> Iterator[Block]:
    """Blocks of three axes, as long as given, one after the other without a stop."""
    chance = random.Random(seed)
    ticks = round(rate_hz * seconds)
    interval_q8 = round(CYCLES_PER_S / rate_hz * 256)
    while True:
        steps = [ticks, *(chance.randint(-ticks, ticks) for _ in range(2))]
        law = (Piece(ticks, interval_q8 + chance.randint(0, 40) * 256, -chance.randint(0, 20)),)
        yield Block(
            steps=tuple(steps),
            pieces=law,
            accel_q=accel_q_from_hz_s(400_000),
            jump_rate_q8=rate_q8_from_hz(1_000),
            weight=1000,
            ends_at_rest=False,
        )


def ramped(rate_hz: float) -> Iterator[Block]:
    """The same, from standstill: a ramp first."""
    from fraese.planner.ramps import trapezoid

    law = trapezoid(4_000, 1_000, rate_hz, rate_hz, 400_000)
    first = next(contour(rate_hz))
    yield first._replace(steps=(4_000, 4_000, 4_000), pieces=tuple(law))
    yield from contour(rate_hz)


def fill(driver: BridgeDriver, blocks: Iterator[Block], pending: list[Block]) -> int:
    """Push until the queue is full; how many."""
    count = 0
    while True:
        block = pending.pop() if pending else next(blocks)
        if not driver.push(block):
            pending.append(block)
            return count
        count += 1


# --- figures -------------------------------------------------------------------------------------


def queue_ms(rate_hz: float, seconds: float) -> float:
    """Motion that the device holds by itself, ms."""
    rig = Rig()
    fill(rig.driver, contour(rate_hz, seconds), [])
    session = rig.driver.session
    session.pump_until(lambda: session.link.is_quiet)
    stored = session.ask().last
    rig.driver.flush()
    rig.driver.close()
    return stored * seconds * 1000


def host_stands_still(rate_hz: float) -> tuple[int, int, int, float]:
    """A pause of the host at full rate.

    Returns:
        Late ticks of the 1.2 s before it, while bytes came; those of the pause; dry queues; the
        rate afterwards.
    """
    rig = Rig()
    blocks, pending = ramped(rate_hz), list[Block]()
    for _ in range(60):
        fill(rig.driver, blocks, pending)
        rig.driver.poll(0.02)
    before = rig.driver.poll(0)
    rig.chip.pass_by(round(STILL_S * 1e9))
    after = rig.driver.poll(0)
    return (
        before.late_ticks,
        after.late_ticks - before.late_ticks,
        after.dry_queues - before.dry_queues,
        after.rate_hz,
    )


def key_to_braking_ms(rate_hz: float, tries: int = 20) -> list[float]:
    """From ``brake()`` to the begin of the first interval that is longer than planned, ms."""
    found_ms = []
    chance = random.Random(2)
    for _ in range(tries):
        rig = Rig()
        blocks, pending = ramped(rate_hz), list[Block]()
        for _ in range(12):
            fill(rig.driver, blocks, pending)
            rig.driver.poll(0.02)
        # Somewhere between two polls, with the line full or not.
        fill(rig.driver, blocks, pending)
        rig.driver.session.pump(chance.random() * 0.005)
        rig.chip.pass_by(chance.randrange(3_000_000))
        rig.chip.movements()
        since = rig.chip.avr.cycle
        rig.driver.brake()
        rig.driver.poll(0.04)
        writes = rig.chip.movements()
        cycles = [int(cycle) for cycle in writes["cycle"][writes["value"] >> 6 == 0]]
        plan_cycles = CYCLES_PER_S / rate_hz + 40
        braking = next(a for a, b in pairwise(cycles) if b - a > plan_cycles * 1.02)
        found_ms.append((braking - since) / CYCLES_PER_S * 1000)
    return found_ms


def damaged_line(steps_wanted: int, rate_hz: float) -> tuple[int, int, int, bool]:
    """Random blocks on a bad line: steps made, damage, frames sent again, all in order."""
    rig = Rig(DAMAGED_ONE_IN)
    blocks, pending = ramped(rate_hz), list[Block]()
    wanted = [Ways() for _ in range(3)]
    made = [Made(motor) for motor in range(3)]
    in_order, total, pushed = True, 0, 0
    running = True
    while running:
        while pushed < steps_wanted:
            block = pending.pop() if pending else next(blocks)
            if not rig.driver.push(block):
                pending.append(block)
                break
            pushed += sum(map(abs, block.steps))
            for ways, n in zip(wanted, block.steps, strict=True):
                ways.add(n)
        report = rig.driver.poll(0.05)
        running = report.running
        writes = rig.chip.movements()
        for ways, motor in zip(wanted, made, strict=True):
            steps = motor.steps(writes)
            total += len(steps)
            in_order = in_order and ways.begin_with(steps)
    # What ends at speed runs dry, and waits in the middle of a block.
    counted = sum(report.travelled_steps)
    return total, rig.line.damaged, rig.driver.session.link.resent, in_order and counted == total


class Ways:
    """Steps that one motor should make, as runs of a sign."""

    def __init__(self) -> None:
        self._runs: list[tuple[int, int]] = []

    def add(self, n: int) -> None:
        if n:
            self._runs.append((1 if n > 0 else -1, abs(n)))

    def begin_with(self, steps: np.ndarray) -> bool:
        """Whether the next steps are these; they are taken off."""
        at = 0
        while at < len(steps):
            if not self._runs:
                return False
            sign, count = self._runs.pop(0)
            part = steps[at : at + count]
            if not bool(np.all(part == sign)):
                return False
            at += len(part)
            if len(part) < count:
                self._runs.insert(0, (sign, count - len(part)))
        return True


class Made:
    """Steps that one motor made, read off its data bytes."""

    def __init__(self, motor: int) -> None:
        self._motor = motor
        self._phase = 0
        self._index = np.full(64, -1)
        self._index[list(MOTRUN)] = range(len(MOTRUN))

    def steps(self, writes: np.ndarray) -> np.ndarray:
        """Signed steps since the last call; a byte that is not a neighbour counts as 9."""
        values = writes["value"][writes["value"] >> 6 == self._motor] & 0x3F
        phases = self._index[values]
        phases = phases[phases >= 0]
        before = np.concatenate([[self._phase], phases[:-1]]) if len(phases) else phases
        turned = (phases - before) % len(MOTRUN)
        if len(phases):
            self._phase = int(phases[-1])
        signs = np.select([turned == 1, turned == len(MOTRUN) - 1, turned == 0], [1, -1, 0], 9)
        chosen: np.ndarray = signs[signs != 0]
        return chosen


def _print(name: str, figure: Callable[[], str]) -> None:
    print(f"{name:62} {figure()}", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=10_000_000, help="on the damaged line")
    steps = parser.parse_args().steps
    if reason_to_skip():
        raise SystemExit(reason_to_skip())
    _print(
        "motion in the queue, three axes, 5 kHz, blocks of 4 ms",
        lambda: f"{queue_ms(SMC_RATE_HZ, BLOCK_S):.0f} ms",
    )
    _print(
        "the same, 25 kHz",
        lambda: f"{queue_ms(FULL_RATE_HZ, BLOCK_S):.0f} ms",
    )
    _print(
        "the same, 5 kHz, blocks of 100 ms",
        lambda: f"{queue_ms(SMC_RATE_HZ, 0.1):.0f} ms",
    )
    _print(
        "host stopped for 200 ms at 25 kHz, three axes",
        lambda: "{} late before, {} late, {} dry, goes on at {:.0f} Hz".format(
            *host_stands_still(FULL_RATE_HZ)
        ),
    )
    for rate_hz in (SMC_RATE_HZ, FULL_RATE_HZ):
        braking_ms = key_to_braking_ms(rate_hz)
        _print(
            f"key to braking at {rate_hz} Hz, line busy (20 tries)",
            lambda ms=braking_ms: f"median {statistics.median(ms):.1f} ms, max {max(ms):.1f} ms",  # type: ignore[misc]
        )
    _print(
        f"{steps} steps, one frame in {DAMAGED_ONE_IN} damaged",
        lambda: "{} made, {} damaged, {} frames again, in order: {}".format(
            *damaged_line(steps, FULL_RATE_HZ)
        ),
    )


if __name__ == "__main__":
    main()
