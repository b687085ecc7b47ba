"""The lines of step/direction drives from the firmware: the rules of the X4Step manual."""

from itertools import pairwise

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from fraese.blocks import Block
from fraese.motor.bridge import constants as c
from fraese.motor.ports.recorder import Access
from fraese.motor.seams import DATA
from tests.bridge.device import Device, reason_to_skip
from tests.bridge.peers import clock_kind, device_for, device_writes
from tests.motor.test_waveforms import path, paths
from tests.motor.waves import Wave, Waves

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())

_SLOW = settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow],
    phases=[Phase.explicit, Phase.generate],
)  # fmt: skip

SHORTEST_CYCLES = 400
LEAD_CYCLES = 1600
#: From the directions to the first edge, with what is worked out meanwhile: 140 us.
LONGEST_LEAD_CYCLES = 2240
#: Up to that rate the ticks of a brake are worked out in time.
IN_TIME_HZ = (300, 2000)
RATES_HZ = (300, 20_000)
#: While a report is asked for, an edge may be 1 us off.
REPORTED_CYCLES = 16


def rises(device: Device) -> int:
    """Steps that the leader, motor 1, has made."""
    wave = Wave()
    for write in device_writes(device):
        if write.register == DATA:
            wave.take(write.cycle, bool(write.value & 2))
    return sum(edge.high for edge in wave.edges)


def waves_of(device: Device) -> Waves:
    """All lines since the card was loaded; times in cycles."""
    return Waves([Access(w.cycle, w.register, w.value) for w in device_writes(device)])


def assert_pulses(waves: Waves, most_cycles: int = 2) -> None:
    """Pause and pulse of a tick differ by no more than that."""
    assert waves.shortest_ns() >= SHORTEST_CYCLES
    assert waves.lead_ns() >= LEAD_CYCLES
    assert len(waves.boost.stretches()) <= 2
    pulses = [fall - rise for rise, fall in waves.pulses()]
    for pause, pulse in zip(waves.pauses_ns(), pulses[1:], strict=True):
        assert abs(pause - pulse) <= most_cycles
    together = sorted({stretch for clock in waves.clocks for stretch in clock.stretches()})
    assert together == sorted(waves.pulses())


@_SLOW
@given(paths(RATES_HZ))
def test_a_path(block: Block) -> None:
    device = device_for(clock_kind("x4step"))
    device.push([block])
    device.start()
    status = device.stand_still()
    waves = waves_of(device)
    assert (status.ended, status.late_ticks) == (c.ENDED_TARGET, 0)
    assert waves.steps() == block.steps
    assert_pulses(waves)
    [(active, _)] = waves.active.stretches()
    assert waves.pulses()[0][0] - active <= LONGEST_LEAD_CYCLES


@pytest.mark.parametrize("urgent", [c.URGENT_BRAKE, c.URGENT_STOP])
@_SLOW
@given(block=paths(IN_TIME_HZ), part=st.floats(0, 1))
def test_a_brake_or_a_stop_at_any_time(urgent: int, block: Block, part: float) -> None:
    """Pauses and pulses are equal, in the brake too; what is told of them is what was made."""
    assert_cut_short(urgent, block, part)


@pytest.mark.parametrize("urgent", [c.URGENT_BRAKE, c.URGENT_STOP])
@_SLOW
@given(block=paths(RATES_HZ), part=st.floats(0, 1))
def test_a_brake_or_a_stop_at_any_rate(urgent: int, block: Block, part: float) -> None:
    """Also where ticks are worked out too late: then the pulse is as long as the pause became."""
    assert_cut_short(urgent, block, part)


#: A tick of a brake before which the throttle moves, chosen with its interval just begun.
LONGEST_CYCLES = 3300
#: The same where the move was not worked out ahead, since a report was made meanwhile.
LONGEST_REPORTED_CYCLES = 6400


@pytest.mark.parametrize("reported", [False, True])
@pytest.mark.parametrize("rate_hz", [3000, 6000, 10_000, 20_000])
def test_a_brake_from_a_high_rate(rate_hz: int, reported: bool) -> None:
    """Symmetric, within its distance, and most ticks at the rate that the throttle allows."""
    ramp_ms = 100
    block = path(rate_hz // 3, -rate_hz // 4, 7, 1, rate_hz=rate_hz, ramp_ms=ramp_ms)
    device = device_for(clock_kind("x4step"))
    device.push([block])
    device.start()
    device.run(round(block.duration_cycles() * 0.4))
    before = rises(device)
    device.urgent(c.URGENT_BRAKE)
    for _ in range(20 if reported else 0):
        device.urgent(c.URGENT_STATUS)
        device.run(16_000)
    status = device.stand_still()
    waves = waves_of(device)
    assert_pulses(waves, REPORTED_CYCLES if reported else 2)
    assert waves.steps()[0] == status.place.done
    ramp_ticks = rate_hz * ramp_ms / 2000
    assert status.place.done - before <= ramp_ticks + rate_hz * 0.002 + 8
    rise_at = [rise for rise, _ in waves.pulses()][before:]
    ticks = [after - rise for rise, after in pairwise(rise_at)]
    jumps = [after for tick, after in pairwise(ticks) if after > 1.3 * tick and after < 8000]
    assert len(jumps) <= max(4, len(ticks) / 14)
    longest = LONGEST_REPORTED_CYCLES if reported else LONGEST_CYCLES
    assert all(tick <= longest for tick in jumps)


def assert_cut_short(urgent: int, block: Block, part: float) -> None:
    device = device_for(clock_kind("x4step"))
    device.push([block])
    device.start()
    device.run(round(block.duration_cycles() * part) + 1)
    device.urgent(urgent)
    status = device.stand_still()
    waves = waves_of(device)
    assert_pulses(waves)
    leader = max(range(4), key=lambda motor: abs(block.steps[motor]))
    assert abs(waves.steps()[leader]) == status.place.done


@pytest.mark.parametrize("at_cycle", range(0, 6000, 1500))
def test_pulses_of_steps_that_come_late_are_whole(at_cycle: int) -> None:
    """A brake before the first step of a fast path: every edge of it is late."""
    device = device_for(clock_kind("x4step"))
    device.push(
        [path(7, rate_hz=19_900, ramp_ms=0)._replace(accel_q=1 << 20, jump_rate_q8=5_079_040)]
    )
    device.start()
    device.urgent(c.URGENT_BRAKE, at_cycle=device.avr.cycle + at_cycle)
    device.stand_still()
    assert waves_of(device).shortest_ns() >= SHORTEST_CYCLES


def test_a_brake_in_the_paths_own_braking_holds_only_until_the_queue_is_dropped() -> None:
    device = device_for(clock_kind("x4step"))
    block = path(200, rate_hz=2000, ramp_ms=100)
    device.push([block])
    device.start()
    device.run(round(block.duration_cycles() * 0.8))
    device.urgent(c.URGENT_BRAKE)
    status = device.stand_still()
    assert (status.ended, status.place.done) == (c.ENDED_TARGET, 200)
    assert status.state & c.State.HELD
    assert device.command(c.KIND_FLUSH) == 0
    device.push([block], epoch=device.ask().ack.epoch)
    device.start(device.ask().ack.epoch)
    assert device.stand_still().ended == c.ENDED_TARGET
    assert waves_of(device).steps() == (400, 0, 0, 0)
