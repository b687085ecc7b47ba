"""What comes in the middle of a run: core and firmware do the same at the same tick.

The event comes well inside an interval, at the same cycle for both; so both see it when they choose
the next one.
"""

from collections.abc import Callable
from dataclasses import replace

import pytest

from fraese.blocks import Block, Piece, Watch, WatchAction
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import Place
from fraese.motor.bridge.records import Dry
from fraese.motor.seams import DATA, Ended
from tests.bridge.device import Device, reason_to_skip
from tests.bridge.peers import (
    OPEN,
    PHASES,
    Core,
    Kind,
    Write,
    clock_kind,
    compare,
    device_for,
    device_writes,
)

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

INTERVAL = 12_000
#: Slow enough to stop at once.
SLOW = 40_000
#: Waited for in hops.
FAR = 60_000
PAUSE_NS = 50_000_000
CLOSED = OPEN & 0x7F


def line(ticks: int, interval: int = INTERVAL, **others: object) -> Block:
    """Three axes at a constant rate; the start/stop rate is half of it."""
    block = Block(
        steps=(ticks, -ticks * 5 // 8, ticks * 3 // 8),
        pieces=(Piece(ticks, interval * 256),),
        accel_q=240 << 4,
        jump_rate_q8=168 << 10,
        weight=3,
    )
    return block._replace(**others)  # type: ignore[arg-type]


class Duel:
    """A run on both, with something that happens on the way."""

    def __init__(self, blocks: list[Block], kind: Kind = PHASES) -> None:
        self._blocks = blocks
        self._kind = kind
        self.core = Core(kind)
        self.device: Device = device_for(kind)
        self.core.push(blocks)
        self.device.push(blocks, self.core.dry)
        self._compared = 0

    def within(self, tick: int) -> int:
        """A cycle an eighth into the interval before a tick, as long as nothing happens."""
        alone = Core(self._kind)
        alone.push(self._blocks)
        alone.play()
        leader = [w.cycle for w in alone.writes() if w.register == 0 and w.value >> 6 == 0]
        before, at = leader[tick - 1 : tick + 1]
        return before + (at - before) // 8

    def happens(self, at_cycle: int, on_core: Callable[[], None]) -> None:
        """At a cycle of the run, on the core."""
        at_ns = 1_000_000 + (at_cycle * 125 >> 1)
        self.core.clock.events.append((at_ns, on_core))

    def start_device(self) -> int:
        """Starts it; the cycle at which time began for the run."""
        before = len(device_writes(self.device))
        self.device.start()
        core = self.core.writes()
        first = next(i for i, w in enumerate(core) if w.cycle > 0)
        self.device.wait(lambda: len(device_writes(self.device)) > before + first, 400, 2000)
        return device_writes(self.device)[first].cycle - core[first].cycle

    def finish(self) -> None:
        """Compare what was written since the last time."""
        core, device = self.core.writes(), device_writes(self.device)
        compare(core[self._compared :], device[self._compared :])
        self._compared = len(core)


def test_brake_and_resume() -> None:
    duel = Duel([line(400, ends_at_rest=False), line(300)])
    at = duel.within(40)
    duel.happens(at, duel.core.driver.brake)
    held = duel.core.play()
    base = duel.start_device()
    duel.device.urgent(c.URGENT_BRAKE, base + at)
    status = duel.device.stand_still()
    assert held.held
    assert status.state & c.State.HELD
    assert (status.place.serial, status.place.done) == (held.playing, held.tick)
    assert status.late_throttle == 0
    duel.finish()

    duel.core.driver.resume()
    ended = duel.core.play()
    assert duel.device.command(c.KIND_RESUME) == 0
    status = duel.device.stand_still()
    assert (ended.ended, status.ended) == (Ended.TARGET, c.ENDED_TARGET)
    duel.finish()


def test_stop_finishes_the_tick_in_hand() -> None:
    duel = Duel([line(400)])
    at = duel.within(40)
    duel.happens(at, duel.core.driver.stop)
    report = duel.core.play()
    base = duel.start_device()
    duel.device.urgent(c.URGENT_STOP, base + at)
    status = duel.device.stand_still()
    assert (status.ended, status.ack.epoch) == (c.ENDED_STOP, 1)
    assert status.place == Place(1, report.tick or status.place.done, 0)
    assert status.state & c.State.TORN
    duel.finish()


def test_end_switch_stops_with_the_exact_count() -> None:
    duel = Duel([line(400)])
    at = duel.within(40)

    def press() -> None:
        duel.core.lines.status = CLOSED

    duel.happens(at, press)
    report = duel.core.play()
    base = duel.start_device()
    duel.device.avr.schedule([(base + at, "C0", True)])
    status = duel.device.stand_still()
    assert (report.ended, status.ended) == (Ended.SWITCH, c.ENDED_SWITCH)
    assert status.state & c.State.SWITCH
    assert status.more & c.More.CONTACT
    assert status.contact_serial == 1
    duel.finish()


#: Pin 11 and pin 10, which show contact as 0 and as 1.
TWO_INPUTS = PHASES._replace(facts=replace(PHASES.facts, switch_mask=0xC0, switch_value=0x40))
#: With both open.
BOTH_OPEN = OPEN & ~0x40


@pytest.mark.parametrize(
    ("pressed", "pin", "level"),
    [(BOTH_OPEN & ~0x80, "C0", True), (OPEN, "C1", True)],
    ids=["pin 11", "pin 10"],
)
def test_any_of_two_inputs_stops(pressed: int, pin: str, level: bool) -> None:
    """Each of them alone, with levels that differ."""
    duel = Duel([line(400)], TWO_INPUTS)
    duel.device.avr.set_pin("C1", False)
    duel.device.run(200_000)
    duel.device.mark = duel.device.avr.cycle
    duel.core.lines.status = BOTH_OPEN
    at = Duel([line(400)]).within(40)

    def press() -> None:
        duel.core.lines.status = pressed

    duel.happens(at, press)
    report = duel.core.play()
    base = duel.start_device()
    duel.device.avr.schedule([(base + at, pin, level)])
    status = duel.device.stand_still()
    assert (report.ended, status.ended) == (Ended.SWITCH, c.ENDED_SWITCH)
    assert status.state & c.State.SWITCH
    assert status.more & c.More.CONTACT
    duel.finish()


@pytest.mark.parametrize("interval", [INTERVAL, SLOW])
@pytest.mark.parametrize("action", list(WatchAction))
def test_watch(action: WatchAction, interval: int) -> None:
    """Latched at the first reading, in the middle of a tick."""
    duel = Duel([line(120, interval, watch=Watch(0x40, 0, action)), line(80, interval)])
    at = duel.within(30)

    def touch() -> None:
        duel.core.lines.status = OPEN & ~0x40

    duel.happens(at, touch)
    report = duel.core.play()
    base = duel.start_device()
    duel.device.avr.schedule([(base + at, "C1", False)])
    status = duel.device.stand_still()
    assert status.state & c.State.LATCHED
    assert latched_steps(status.latched, line(120)) == report.latched_steps
    assert c.ended_of(status.ended) == report.ended
    assert bool(status.state & c.State.HELD) == report.held
    duel.finish()


def latched_steps(place: Place, block: Block) -> tuple[int, ...]:
    """What the host makes of a place in the first block."""
    from fraese.blocks import steps_done

    ticks = block.ticks()
    return tuple(
        (1 if n > 0 else -1) * (steps_done(abs(n), ticks, place.done) + (place.moved >> motor & 1))
        for motor, n in enumerate(block.steps)
    )


def test_running_dry_brakes_on_a_ramp() -> None:
    """The last block that came does not end at rest."""
    duel = Duel([line(300, ends_at_rest=False), line(300, ends_at_rest=False)])
    report = duel.core.play()
    base = duel.start_device()
    status = duel.device.stand_still()
    assert base
    assert (report.dry_queues, status.dry_queues) == (1, 1)
    assert report.held
    assert status.state & c.State.HELD
    assert status.state & c.State.DRY
    assert (status.place.serial, status.place.done) == (report.playing, report.tick)
    duel.finish()


def test_blocks_after_running_dry_are_played_at_once() -> None:
    duel = Duel([line(300, ends_at_rest=False), line(300, ends_at_rest=False)])
    duel.core.play()
    duel.start_device()
    duel.device.stand_still()
    duel.finish()
    duel.core.push([line(100)])
    duel.core.play()
    duel.device.push([line(100)], duel.core.dry[2:])
    status = duel.device.stand_still()
    assert status.ended == c.ENDED_TARGET
    duel.finish()


def test_override_is_a_ceiling() -> None:
    """Lowered in the middle of a block, it is met on a ramp, and goes on in the next block."""
    blocks = [line(300, override_q8=256, ends_at_rest=False), line(300, override_q8=256)]
    duel = Duel(blocks)
    at = duel.within(250)
    duel.happens(at, lambda: duel.core.driver.set_override(0.6))
    duel.core.play()
    base = duel.start_device()
    duel.device.send(c.KIND_OVERRIDE, (154).to_bytes(2, "little"), before_cycle=base + at)
    status = duel.device.stand_still()
    assert (status.override_q8, status.late_throttle) == (154, 0)
    duel.finish()


@pytest.mark.parametrize("jump_hz", [65, 672], ids=["braking", "held at once"])
def test_a_brake_in_a_long_interval_makes_no_step_twice(jump_hz: int) -> None:
    """The tick was made out for the end of the wait; it is taken back, and made out anew."""
    duel = Duel([line(60, FAR, jump_rate_q8=jump_hz << 8), line(40, FAR)])
    at = duel.within(20)
    duel.core.play()
    base = duel.start_device()
    duel.device.urgent(c.URGENT_BRAKE, base + at)
    go_on_after_a_hold(duel)


@pytest.mark.parametrize("wait", [8_000, 25_000, 45_000])
@pytest.mark.parametrize("jump_hz", [65, 672], ids=["braking", "held at once"])
def test_a_brake_in_a_long_interval_of_clock_lines(jump_hz: int, wait: int) -> None:
    blocks = [line(60, FAR, jump_rate_q8=jump_hz << 8), line(40, FAR)]
    duel = Duel([block._replace(steps=(*block.steps, 9)) for block in blocks], clock_kind("paper"))
    duel.core.play()
    base = duel.start_device()
    duel.device.urgent(c.URGENT_BRAKE, base + 20 * FAR + wait)
    go_on_after_a_hold(duel)


def go_on_after_a_hold(duel: Duel) -> None:
    """The device holds, goes on, and has made every write of a core that was never held."""
    status = duel.device.stand_still()
    assert status.state & c.State.HELD
    assert status.place.serial == 1
    assert 19 <= status.place.done <= 33
    assert duel.device.command(c.KIND_RESUME) == 0
    assert duel.device.stand_still().ended == c.ENDED_TARGET
    assert data_written(device_writes(duel.device)) == data_written(duel.core.writes())


def data_written(writes: list[Write]) -> list[int]:
    """What the motors were told, in order."""
    return [write.value for write in writes if write.register == DATA]


def test_a_stop_in_a_long_interval_leaves_the_phases_that_were_latched() -> None:
    """What comes next goes on from the byte that was written last, not from the one after it."""
    duel = Duel([line(60, FAR), line(40, FAR)])
    at = duel.within(20)
    duel.core.play()
    base = duel.start_device()
    duel.device.urgent(c.URGENT_STOP, base + at)
    status = duel.device.stand_still()
    assert (status.ended, status.place.done) == (c.ENDED_STOP, 19)
    length = len(PHASES.facts.table)
    steps = latched_steps(status.place, line(60, FAR))
    assert list(status.phases[:3]) == [n % length for n in steps]


def test_a_dry_point_that_comes_when_its_block_is_in_hand_counts() -> None:
    """The point of the record that came last says where to brake, also in a block that plays."""
    device = device_for(PHASES)
    first, second = line(600, ends_at_rest=False), line(600, ends_at_rest=False)
    device.push([first], [None])
    device.start()
    device.wait(lambda: device.ask().place.done > 60, 2000)
    device.push([second], [Dry(1, 250)])
    status = device.stand_still()
    assert status.state & c.State.HELD
    assert status.state & c.State.DRY
    # From 1333 to 656 steps/s with 3662 steps/s**2.
    assert status.place.serial == 1
    assert status.place.done == pytest.approx(250 + 184, abs=30)
    assert not status.state & c.State.TORN
