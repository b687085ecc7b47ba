"""Power of a laser: pulses of a second timer, constant or with the speed that is really played.

What is looked at are the timer's registers: the share of full power that the pin has is that of its
compare register while the timer is connected, and none while it is not.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final, NamedTuple

import pytest

from fraese.blocks import DARK, Block, Piece, Power
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.cards import PULSE_RATES_HZ, Lamp, Line, nearest_rate
from tests.bridge.device import MS, Device, reason_to_skip
from tests.bridge.lamp import TCCR2A, TCCR2B, share_of
from tests.bridge.peers import PHASES, Kind, clock_kind, device_for, device_writes

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

STEP_CYCLES: Final = 400


def lit(kind: Kind, lamp: Lamp = Lamp(2)) -> Kind:  # noqa: B008 (immutable)
    """The same card with a laser on pin 14, the first of its outputs or the second."""
    lines = tuple(Line() if line.mask == 0b0010 else line for line in kind.facts.outputs)
    safe = sum(1 << bit for bit, line in enumerate(lines) if not line.mask)
    return kind._replace(facts=replace(kind.facts, outputs=lines, lamp=lamp, safe=safe))


CARDS: Final = {"phases": lit(PHASES), "clocks": lit(clock_kind("paper"))}


class Seen(NamedTuple):
    """At a cycle: the share of full power, 0 to 256."""

    cycle: int
    share: int


def watched(device: Device, cycles: int, step: int = STEP_CYCLES) -> list[Seen]:
    """Let it run, and look at the pin's share all the time."""
    seen = []
    end = device.avr.cycle + cycles
    while device.avr.cycle < end:
        device.run(step)
        seen.append(Seen(device.avr.cycle, share_of(device.avr)))
    return seen


def line(ticks: int, cycles: int, power: Power = DARK, *, rests: bool = False) -> Block:
    """A block at a constant rate, from which the motors may stop dead if it is slow."""
    return Block(
        (ticks, ticks // 2, 0), (Piece(ticks, cycles << 8),), 240 << 4, 128 << 13,
        ends_at_rest=rests, power=power,
    )  # fmt: skip


def ramp(power: Power) -> list[Block]:
    """From 8000 cycles to 2000, on, and back."""
    up = Piece(600, 8000 << 8, -(6000 << 8) // 600)
    return [
        Block((600, 100, 0), (up,), 255 << 6, 128 << 12, ends_at_rest=False, power=power),
        Block((2000, 100, 0), (Piece(2000, 2000 << 8),), 255 << 6, 128 << 12, False, power=power),
        Block((600, 100, 0), (up.mirrored(),), 255 << 6, 128 << 12, True, power=power),
    ]


def played(device: Device, blocks: Sequence[Block]) -> list[Seen]:
    """Until they have been played, and a little longer."""
    device.push(blocks)
    device.start()
    total = sum(block.duration_cycles() for block in blocks)
    return watched(device, total + 60 * MS)


@pytest.mark.parametrize("card", CARDS)
def test_constant_power_is_that_of_the_block(card: str) -> None:
    device = device_for(CARDS[card])
    blocks = [
        line(200, 8000, Power(100)),
        line(200, 8000),
        line(200, 8000, Power(255), rests=True),
    ]
    seen = played(device, blocks)
    shares = [share for share, _ in _runs(seen)]
    assert shares == [0, 101, 0, 256, 0]
    lengths = [length for share, length in _runs(seen) if share]
    assert lengths == pytest.approx([200 * 8000, 200 * 8000], abs=12_000)


def _runs(seen: Sequence[Seen]) -> list[tuple[int, int]]:
    """Shares one after the other, and for how many cycles each."""
    out: list[tuple[int, int]] = []
    for before, now in pairwise(seen):
        length = now.cycle - before.cycle
        if out and out[-1][0] == now.share:
            out[-1] = (now.share, out[-1][1] + length)
        else:
            out.append((now.share, length))
    return out


@pytest.mark.parametrize("card", CARDS)
def test_power_follows_the_speed_that_is_played(card: str) -> None:
    """In ramps and between them: share times interval is what the block says, to a share or two."""
    device = device_for(CARDS[card])
    full_cycles = 1600
    seen = played(device, ramp(Power(200, full_cycles)))
    assert device.ask().ended == c.ENDED_TARGET
    plan = [cycles >> 8 for block in ramp(DARK) for piece in block.pieces for cycles in _q8(piece)]
    shares = [one.share for one in seen if one.share]
    assert max(shares) == pytest.approx(200 * full_cycles / 2000, abs=3)
    assert min(shares) == pytest.approx(200 * full_cycles / 8000, abs=3)
    energy = sum(one.share * STEP_CYCLES for one in seen) / 256
    assert energy == pytest.approx(len(plan) * 200 / 256 * full_cycles, rel=0.03)
    assert seen[-1].share == 0


def _q8(piece: Piece) -> list[int]:
    return [piece.interval_q8 + n * piece.add_q8 for n in range(piece.ticks)]


def edges(device: Device) -> list[tuple[int, int, int]]:
    """Everything written to the plug once the run is under way, in cycles since the first of it."""
    writes = device_writes(device)[20:]
    return [(write.cycle - writes[0].cycle, write.register, write.value) for write in writes]


@pytest.mark.parametrize("cycles", [8000, 2000, 800])
@pytest.mark.parametrize("card", CARDS)
def test_steps_come_when_they_come_without_power(card: str, cycles: int) -> None:
    """Every block of twelve ticks with another power: the same edges to the cycle."""
    powers = [Power(10 * n + 5, 1900 * (n % 2)) for n in range(20)]
    without = PHASES if card == "phases" else clock_kind("paper")
    seen = []
    for kind, own in ((without, False), (CARDS[card], True)):
        device = device_for(kind)
        blocks = [line(12, cycles, power if own else DARK) for power in powers]
        device.push([block._replace(jump_rate_q8=128 << 16) for block in blocks])
        device.start()
        assert device.stand_still().late_ticks == 0
        seen.append(edges(device))
    assert len(seen[0]) > 400
    assert seen[1] == seen[0]


@pytest.mark.parametrize("power", [Power(200), Power(200, 2000)])
@pytest.mark.parametrize("card", CARDS)
def test_a_hold_is_dark_and_what_follows_has_its_power_again(card: str, power: Power) -> None:
    device = device_for(CARDS[card])
    device.push([block._replace(accel_q=255 << 8) for block in ramp(power)])
    device.start()
    bright = watched(device, 250 * MS)[-1].share
    device.urgent(c.URGENT_BRAKE)
    device.wait(
        lambda: device.status is not None and bool(device.status.state & c.State.HELD), 2000
    )
    assert share_of(device.avr) == 0
    assert {one.share for one in watched(device, 100 * MS)} == {0}
    assert device.command(c.KIND_RESUME) == 0
    again = watched(device, 200 * MS)
    assert max(one.share for one in again) == pytest.approx(bright, abs=2)
    if power.at_cycles:
        lit_up = [one.share for one in again if one.share]
        assert lit_up[0] < bright / 2
    device.stand_still()
    assert share_of(device.avr) == 0


@pytest.mark.parametrize("card", CARDS)
def test_in_a_brake_power_goes_with_the_speed_that_is_left(card: str) -> None:
    """No block has said anything of these intervals: they are the device's own."""
    device = device_for(CARDS[card])
    # X alone: whatever is written to the plug is one of its ticks, on clock lines in two bursts.
    blocks = [block._replace(steps=(block.steps[0], 0, 0)) for block in ramp(Power(200, 2000))]
    device.push([block._replace(accel_q=255 << 8) for block in blocks])
    device.start()
    bright = watched(device, 250 * MS)[-1].share
    device.urgent(c.URGENT_BRAKE)
    seen = watched(device, 300 * MS)
    written = [write.cycle for write in device_writes(device) if write.cycle > seen[0].cycle]
    bursts = sum(b - a > STEP_CYCLES for a, b in pairwise(written))
    ticks = bursts / (2 if card == "clocks" else 1)
    assert ticks > 400
    assert bright == 200
    assert min(one.share for one in seen if one.share) < 60
    energy = sum(one.share * STEP_CYCLES for one in seen) / 256
    assert energy == pytest.approx(ticks * 200 / 256 * 2000, rel=0.02)
    assert seen[-1].share == 0


@pytest.mark.parametrize("card", CARDS)
def test_it_is_dark_within_a_tick_of_the_last_edge(card: str) -> None:
    """After a stop, a brake, a target: the interrupt that ends the run takes the timer off."""
    device = device_for(CARDS[card])
    device.push([line(4000, 4000, Power(255))])
    device.start()
    device.run(50 * MS)
    assert share_of(device.avr) == 256
    device.urgent(c.URGENT_STOP)
    while share_of(device.avr):
        device.run(50)
    dark_at = device.avr.cycle
    device.run(20 * MS)
    last = device_writes(device)[-1].cycle
    assert dark_at - last < 4000
    assert share_of(device.avr) == 0


@pytest.mark.parametrize("power", [Power(200), Power(200, 2000)])
def test_a_killed_host_leaves_it_dark(power: Power) -> None:
    kind = CARDS["phases"]
    device = device_for(kind._replace(facts=replace(kind.facts, silence_ms=50)))
    device.push([line(20_000, 4000, power)])
    device.start()
    seen = watched(device, 30 * MS)
    assert seen[-1].share > 90
    seen = watched(device, 600 * MS, 4000)
    status = device.ask()
    assert status.ended == c.ENDED_SILENCE
    assert seen[-1].share == 0
    assert share_of(device.avr) == 0


def test_a_reset_leaves_it_dark() -> None:
    device = device_for(CARDS["phases"])
    device.push([line(20_000, 4000, Power(255))])
    device.start()
    device.run(30 * MS)
    assert share_of(device.avr)
    device.avr.reset()
    device.run(30 * MS)
    assert share_of(device.avr) == 0
    assert device.avr.peek(TCCR2B)[0] == 0


def test_what_the_queue_said_is_no_longer_so_after_a_stop() -> None:
    """An epoch begins in the dark: a block that says no power has none."""
    device = device_for(CARDS["phases"])
    device.push([line(4000, 4000, Power(255))])
    device.start()
    device.run(30 * MS)
    device.urgent(c.URGENT_STOP)
    device.run(20 * MS)
    device.begin_epoch()
    device.push([line(400, 4000)], epoch=1)
    device.start(epoch=1)
    assert {one.share for one in watched(device, 100 * MS)} == {0}


def test_without_being_asked_the_timer_is_left_alone() -> None:
    """An older host knows nothing of it; a block's power changes nothing then."""
    device = device_for(PHASES)
    device.push([line(400, 4000, Power(255))])
    device.start()
    assert {one.share for one in watched(device, 50 * MS)} == {0}
    assert device.avr.peek(TCCR2A, 2) == b"\0\0"
    assert device.stand_still().ended == c.ENDED_TARGET


@pytest.mark.parametrize(
    ("lamp", "registers"),
    [(Lamp(1), (0x83, 1)), (Lamp(4, high=False), (0xC3, 4)), (Lamp(7), (0x83, 7))],
)
def test_level_and_rate_are_the_host_s(lamp: Lamp, registers: tuple[int, int]) -> None:
    device = device_for(lit(PHASES, lamp))
    device.push([line(400, 4000, Power(128))])
    device.start()
    device.run(30 * MS)
    assert tuple(device.avr.peek(TCCR2A, 2)) == registers
    assert share_of(device.avr) == 129


def test_the_nearest_rate_is_taken() -> None:
    wanted = {61: 7, 300: 6, 1000: 4, 2000: 3, 5000: 2, 62_500: 1}
    assert {hz: nearest_rate(hz) for hz in wanted} == wanted
    assert PULSE_RATES_HZ[4] == pytest.approx(976.5625)
