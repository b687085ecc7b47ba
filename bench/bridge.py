"""What the bridge's firmware keeps up with, in the simulated microcontroller: one table.

Run it as ``python -m bench.bridge``; with ``--long`` it plays ten million steps over a damaged
line, which takes some minutes. Figures are those of the real image at 16 MHz, the same in every
run; only the wall-clock time varies.
"""

import argparse
import random
from collections.abc import Callable, Iterable, Iterator
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from bench.inorder import DataBytes, InOrder
from fraese.blocks import Block, Piece
from fraese.motor.bridge import constants as c
from tests.bridge.device import MS, Device
from tests.bridge.peers import PHASES, Kind, Write, clock_kind, device_for, device_writes
from tests.bridge.streaming import Stream
from tests.bridge.test_stream import curve

_ANY_RATE: Final = 255 << 16
_HZ: Final = 16_000_000
#: Bytes free in the ring; a frame may not fit any more.
_NEARLY_FULL: Final = 100
Cycles = npt.NDArray[np.int64]


class Row(NamedTuple):
    """A line of the table."""

    what: str
    least: str
    measured: str
    holds: bool


def line(steps: tuple[int, ...], interval: int, rests: bool = True) -> Block:
    """A constant rate that the throttle leaves alone."""
    ticks = max(map(abs, steps))
    law = (Piece(ticks, interval * 256),)
    return Block(steps, law, 1000, _ANY_RATE, weight=1, ends_at_rest=rests)


def motor_times(kind: Kind, writes: Iterable[Write], motor: int) -> Cycles:
    """Cycles of a motor's steps."""
    if kind.facts.kind == c.CARD_CLOCKS:
        bit = 2 << 2 * motor
        times = [w.cycle for w in writes if w.register == 0 and w.value & bit]
        return np.array(times, np.int64)
    bits = kind.facts.motor_bits[motor]
    # The first byte of each motor switches its current on.
    times = [w.cycle for w in writes if w.register == 0 and w.value & 0xC0 == bits]
    return np.array(times[1:], np.int64)


def played(kind: Kind, steps: tuple[int, ...], interval: int) -> tuple[Device, list[Write]]:
    """One long block, from standstill to standstill."""
    device = device_for(kind)
    device.push([line(steps, interval)])
    device.start()
    device.stand_still()
    return device, device_writes(device)


def rate_row(what: str, least: str, kind: Kind, steps: tuple[int, ...], interval: int) -> Row:
    """Deviation of the leading motor's intervals, and what of the time the interrupt takes."""
    device, writes = played(kind, steps, interval)
    status = device.ask()
    times = motor_times(kind, writes, 0)
    deviation = np.abs(np.diff(times) - interval)
    use = device.avr.vectors()[11].total_cycles / (interval * len(times))
    p99, worst = np.percentile(deviation, 99), deviation.max()
    text = (
        f"{_HZ / interval / 1000:.1f} kHz: deviation p99 {p99:.0f}, max {worst} cycles, "
        f"{status.late_ticks} late, interrupt {use:.0%}"
    )
    return Row(what, least, text, bool(p99 <= 2 and worst <= 8 and not status.late_ticks))


def minors_row() -> Row:
    """How evenly minor axes step: their intervals against the mean."""
    interval = 2560
    _, writes = played(PHASES, (4000, 2472, 1528), interval)
    shares = []
    for motor in (1, 2):
        gaps = np.diff(motor_times(PHASES, writes, motor))
        shares.append(np.percentile(np.abs(gaps - gaps.mean()), 99) / interval)
    text = f"p99 {max(shares):.1%} of the leader's interval"
    return Row(
        "minor axes at 1 : 0.618 : 0.382, leader at 6.25 kHz", "15 %", text, max(shares) <= 0.15
    )


def queue_row() -> Row:
    """How much motion of 4 ms blocks the ring takes."""
    device = device_for(PHASES)
    Stream(device, curve(120, 3200, 20)).fill()
    held_ms = device.ask().last * 4
    return Row(
        "motion held in the queue, blocks of 4 ms", "250 ms", f"{held_ms} ms", held_ms >= 250
    )


def equal_blocks(interval: int, motors: int = 3) -> list[Block]:
    """Equal motors at one rate, in blocks of 4 ms."""
    return [line((64_000 // interval,) * motors, interval, rests=False)] * 600


def ramped_blocks(interval: int) -> list[Block]:
    """A leader at about this interval, rising or falling in every block; the others at random."""
    chance = random.Random(3)
    ticks = 64_000 // interval
    return [
        Block(
            (ticks, chance.randint(-ticks, ticks), chance.randint(-ticks, ticks)),
            (Piece(ticks, interval * 256 + 5_000, chance.randint(-50, 50)),),
            1000, _ANY_RATE, weight=1, ends_at_rest=False,
        )
        for _ in range(600)
    ]  # fmt: skip


def planned(blocks: Iterable[Block]) -> Cycles:
    """The leader's intervals, cycles."""
    intervals = [
        (piece.interval_q8 + n * piece.add_q8) >> 8
        for block in blocks
        for piece in block.pieces
        for n in range(piece.ticks)
    ]
    return np.array(intervals, np.int64)


def pause_row(what: str, kind: Kind, blocks: list[Block]) -> Row:
    """A host that is stopped for 200 ms at a time."""
    device = device_for(kind)
    stream = Stream(device, [*blocks[:-1], blocks[-1]._replace(ends_at_rest=True)])
    stream.fill()
    device.start()
    refills = []
    for _ in range(3):
        stream.run(50 * MS)
        begin = device.avr.cycle
        while device.ack and device.ack.free > _NEARLY_FULL and device.avr.cycle < begin + MS * 900:
            stream.run(MS)
        refills.append((device.avr.cycle - begin) // MS + 50)
        stream.run(200 * MS, sending=False)
    stream.finish()
    status = device.ask()
    gaps = np.diff(motor_times(kind, device_writes(device), 0))
    worst = int(np.abs(gaps - planned(blocks)[1:]).max())
    text = (
        f"{status.late_ticks} late, deviation max {worst} cycles, {stream.restarts} times empty, "
        f"queue full again after {max(refills[1:])} ms"
    )
    return Row(
        f"host stopped for 200 ms, {what}", "no step late", text,
        not status.late_ticks and not stream.restarts,
    )  # fmt: skip


def damage_row(steps: int) -> Row:
    """Random blocks, one frame in 200 damaged."""
    blocks = curve(steps // 60, 2400, 30, seed=7)
    device = device_for(PHASES)
    order = InOrder(DataBytes(device.avr), PHASES.facts.motors)
    for block in blocks:
        order.want(block.steps)
    total = order.left
    stream = Stream(device, blocks, damage_every=200)
    stream.fill()
    device.start()
    stream.finish(limit_s=steps / 500, watch=order.look)
    order.look()
    every = "every one once, in order" if order.holds and not order.left else "NOT in order"
    text = (
        f"{order.made} of {total} steps made, {every}; {stream.damaged} of {stream.sent} frames "
        f"damaged, {stream.resent} sent again"
    )
    return Row(
        "random blocks, 1 frame in 200 damaged", "every step once", text,
        order.holds and not order.left,
    )  # fmt: skip


def contact_row() -> Row:
    """From the contact to the last step."""
    device = device_for(PHASES)
    device.push([line((400, 250, 150), 3200)])
    device.start()
    device.run(400_000)
    at = device.avr.cycle + 1000
    device.avr.schedule([(at, "C0", True)])
    status = device.stand_still()
    last = max(w.cycle for w in device_writes(device) if w.register == 0)
    text = f"{(last - at) / 3200:.1f} intervals, ended by {c.ENDED_NAMES[status.ended]}"
    # Three readings make a contact.
    return Row("contact to last step", "the tick in progress", text, last - at < 3 * 3200)


def stack_row() -> Row:
    """What is left of the memory after a busy run."""
    device, _ = played(PHASES, (2000, 1200, 700), 800)
    free = device.stack_free()
    return Row("memory that the stack never touched", "more than none", f"{free} bytes", free > 16)


def rows(long: bool) -> Iterator[Row]:
    """The table, line by line."""
    paper, x4step = clock_kind("paper"), clock_kind("x4step")
    rates: tuple[tuple[str, str, Kind, tuple[int, ...], int], ...] = (
        ("one axis, phase card", "40 kHz", PHASES, (4000, 0, 0), 400),
        ("one axis, phase card", "60 kHz wished", PHASES, (4000, 0, 0), 266),
        ("three equal axes, phase card", "25 kHz", PHASES, (4000,) * 3, 640),
        ("three equal axes, phase card", "33 kHz wished", PHASES, (4000,) * 3, 480),
        ("three equal axes, phase card", "", PHASES, (4000,) * 3, 400),
        ("four axes, paper profile", "30 kHz", paper, (4000, 2472, 1528, 900), 533),
        ("four equal axes, paper profile", "30 kHz", paper, (4000,) * 4, 533),
        ("four axes, paper profile", "40 kHz wished", paper, (4000, 2472, 1528, 900), 400),
        ("four equal axes, paper profile", "", paper, (4000,) * 4, 400),
        ("two axes, forward and back, paper profile", "40 kHz", paper, (4000, -4000, 0, 0), 400),
        ("two axes, forward and back, paper profile", "", paper, (4000, -4000, 0, 0), 333),
        ("four axes, x4step profile", "20 kHz", x4step, (4000,) * 4, 800),
        ("three axes, phase card", "5 kHz", PHASES, (4000, 2472, 1528), 3200),
    )
    for row in rates:
        yield rate_row(*row)
    others: tuple[Callable[[], Row], ...] = (
        minors_row, queue_row,
        lambda: pause_row("three equal axes at 5 kHz", PHASES, equal_blocks(3200)),
        lambda: pause_row("three equal axes at 20 kHz", PHASES, equal_blocks(800)),
        lambda: pause_row("three equal axes at 25 kHz", PHASES, equal_blocks(640)),
        lambda: pause_row("three equal axes at 33 kHz", PHASES, equal_blocks(480)),
        lambda: pause_row("three axes on ramps about 20 kHz", PHASES, ramped_blocks(800)),
        lambda: pause_row("three axes on ramps about 24 kHz", PHASES, ramped_blocks(640)),
        lambda: pause_row("four equal axes, paper, at 30 kHz", paper, equal_blocks(533, 4)),
        lambda: damage_row(10_000_000 if long else 100_000), contact_row, stack_row,
    )  # fmt: skip
    for make in others:
        yield make()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--long", action="store_true", help="ten million steps over a bad line")
    for row in rows(parser.parse_args().long):
        print(
            f"{'ok ' if row.holds else 'NOT'}  {row.what:58} {row.least:22} {row.measured}",
            flush=True,
        )


if __name__ == "__main__":
    main()
