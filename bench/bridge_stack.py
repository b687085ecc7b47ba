"""Figures of the whole bridge: driver, line and the real firmware, in the time of the chip.

    python -m bench.bridge_stack [--steps 10000000]

The microcontroller is simulated, its time is exact and passes only while the host waits or is made
to stand still; so the figures do not depend on this computer. Those of keys in the app do: there
the whole program runs, in real time (`bench/bridge_keys.py`).

Source of the demands: steps and queue at 250,000 baud, blocks of 4 ms; a host that stands still for
200 ms; one frame in 200 damaged; 10 ms from the key to the first longer interval.
"""

import argparse
import random
import statistics
from collections.abc import Callable, Iterator
from itertools import chain, pairwise

from bench import bridge_keys
from bench.inorder import DataBytes, InOrder
from fraese.blocks import CYCLES_PER_S, Block, Piece, accel_q_from_hz_s, rate_q8_from_hz
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.line import Line
from fraese.motor.cards.smc1500 import SmcCard
from fraese.planner.ramps import trapezoid
from rigs.avr.simavr import Avr
from tests.bridge.device import image, reason_to_skip

FULL_RATE_HZ = 25_000
SMC_RATE_HZ = 5_000
BLOCK_S = 0.004
STILL_S = 0.2
DAMAGED_ONE_IN = 200
_READ_CYCLES = 4_000
_RAMP_TICKS = 4_000


class Chip:
    """A microcontroller with nothing on its pins, and the clock that it is.

    Attributes:
        data: what it writes to the data lines.
    """

    def __init__(self) -> None:
        self.avr = Avr(image())
        self.avr.run(CYCLES_PER_S // 50)
        # No contact, or every run would end at once.
        self.avr.set_pin("C0", False)
        for pin in ("C1", "C2", "C3", "C4"):
            self.avr.set_pin(pin, True)
        self.data = DataBytes(self.avr)

    def now_ns(self) -> int:
        return self.avr.cycle * 1000 // 16

    def wait_until(self, deadline_ns: int) -> int:
        self.avr.run(max(0, deadline_ns * 16 // 1000 - self.avr.cycle))
        return self.now_ns()

    def pass_by(self, elapsed_ns: int) -> None:
        self.wait_until(self.now_ns() + elapsed_ns)


class ChipLine:
    """A line to the chip, on which one piece in so many is damaged, both ways.

    Args:
        chip: at the other end.
        one_in: 0: none is.
    """

    def __init__(self, chip: Chip, one_in: int = 0) -> None:
        self._chip = chip
        self._one_in = one_in
        self._random = random.Random(1)
        self.pieces = self.damaged = 0

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
        """A piece is a frame or two, or a part of one."""
        self.pieces += bool(data)
        if not self._one_in or not data or self._random.randrange(self._one_in):
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
        self.chip.data.take()


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
    yield _ramp(rate_hz, trapezoid(_RAMP_TICKS, 1_000, rate_hz, rate_hz, 400_000))
    yield from contour(rate_hz)


def journey(rate_hz: float, steps: int) -> Iterator[Block]:
    """The same, from standstill to standstill: so many steps, and a block or two."""
    left = steps
    for block in ramped(rate_hz):
        yield block
        left -= sum(map(abs, block.steps))
        if left <= 0:
            break
    law = trapezoid(_RAMP_TICKS, rate_hz, rate_hz, 1_000, 400_000)
    yield _ramp(rate_hz, law)._replace(ends_at_rest=True)


def _ramp(rate_hz: float, law: list[Piece]) -> Block:
    return next(contour(rate_hz))._replace(steps=(_RAMP_TICKS,) * 3, pieces=tuple(law))


def fill(driver: BridgeDriver, blocks: Iterator[Block], pending: list[Block]) -> list[Block]:
    """Push until the queue is full, or nothing is left; what was pushed."""
    pushed: list[Block] = []
    for block in chain(pending.copy(), blocks):
        if not driver.push(block):
            pending[:] = [block]
            return pushed
        pushed.append(block)
    pending.clear()
    return pushed


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
    """From ``brake()`` to the end of the first interval that is longer than planned, ms."""
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
        rig.chip.data.take()
        since = rig.chip.avr.cycle
        rig.driver.brake()
        rig.driver.poll(0.04)
        writes = rig.chip.data.take()
        cycles = [int(cycle) for cycle in writes["cycle"][writes["value"] >> 6 == 0]]
        plan_cycles = CYCLES_PER_S / rate_hz + 40
        braking = next(b for a, b in pairwise(cycles) if b - a > plan_cycles * 1.02)
        found_ms.append((braking - since) / CYCLES_PER_S * 1000)
    return found_ms


def damaged_line(steps: int, rate_hz: float) -> str:
    """Random blocks on a line that damages both ways: every step once and in order?"""
    rig = Rig(DAMAGED_ONE_IN)
    blocks, pending = journey(rate_hz, steps), list[Block]()
    order, wanted, running = InOrder(rig.chip.data, 3), 0, True
    while running:
        for block in fill(rig.driver, blocks, pending):
            order.want(block.steps)
            wanted += sum(map(abs, block.steps))
        report = rig.driver.poll(0.05)
        running = report.running
        order.look()
    agrees = order.holds and not order.left and sum(report.travelled_steps) == order.made
    return (
        f"{order.made} of {wanted} made, {rig.line.damaged} of {rig.line.pieces} pieces damaged,"
        f" {rig.driver.session.link.resent} frames again, {report.dry_queues} dry,"
        f" {report.late_ticks} late, every step once and in order: {agrees}"
    )


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
    for rate_hz in (SMC_RATE_HZ, FULL_RATE_HZ):
        for name, key in (("Ctrl+C", bridge_keys.CTRL_C), ("Escape", bridge_keys.ESCAPE)):
            tries = bridge_keys.measure(rate_hz, key, 20)
            _print(
                f"{name} in the app to braking, jog at {rate_hz} Hz (20 tries)",
                lambda tries=tries: bridge_keys.in_words(tries),  # type: ignore[misc]
            )
    _print(
        f"{steps} steps, one frame in {DAMAGED_ONE_IN} damaged",
        lambda: damaged_line(steps, FULL_RATE_HZ),
    )


if __name__ == "__main__":
    main()
