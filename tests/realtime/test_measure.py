"""The measurement measures: not how good this machine is, but that what it says is so."""

import sys
from pathlib import Path

import numpy as np
import pytest

from fraese.motor.ports.null import NullPort
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.bareloop import interruptions_us
from fraese.motor.realtime.clock import RealtimeClock
from fraese.motor.realtime.measure import (
    Duty,
    Lateness,
    Rung,
    highest_rate_hz,
    hogs,
    ladder,
    measure,
    smc_duty,
    stepdir_duty,
)
from fraese.motor.realtime.memory import Memory
from fraese.motor.realtime.meter import MeteredPort
from fraese.motor.realtime.setup import Meter
from fraese.motor.seams import CONTROL, DATA
from tests.motor.workbench import Workbench, steady
from tests.realtime.room import Time

if sys.platform != "linux":
    pytest.skip("the step process needs Linux", allow_module_level=True)

ROOM = 50


def metered(wiring: str, meter: Meter) -> tuple[Workbench, Memory, Time]:
    """A bench whose port is measured, in a time of which every look takes a microsecond."""
    time = Time(look_ns=1_000)
    clock = RealtimeClock(time.now_ns, time.sleep_s)
    bench = Workbench(wiring, clock=clock)
    memory = Memory(shared.create(ROOM), ROOM)
    port = MeteredPort(NullPort(), clock, memory, meter)
    wires = bench.core.run.wires
    wires.access = (port.write_data, wires.access[1], port.write_control)
    return bench, memory, time


@pytest.mark.parametrize(
    ("wiring", "meter"),
    [("smc", Meter(CONTROL, 1, ROOM)), ("x4step", Meter(DATA, 0xAA, ROOM))],
)
def test_one_edge_a_tick_is_noted_however_many_motors_move(wiring: str, meter: Meter) -> None:
    bench, memory, _ = metered(wiring, meter)
    bench.run(steady(40, 40, 40))
    late_ns = np.frombuffer(memory.measured(), dtype=np.uint32)
    # Energising strobes the phase card too, but waits for no deadline.
    assert len(late_ns) == 40
    assert np.median(late_ns) <= 4_000
    span_ns = memory.words[shared.LAST_EDGE] - memory.words[shared.FIRST_EDGE]
    assert span_ns == pytest.approx(39e6, rel=0.01)


def test_a_full_room_takes_no_more_but_counts_on() -> None:
    bench, memory, _ = metered("x4step", Meter(DATA, 0xAA, ROOM))
    bench.run(steady(70))
    assert len(memory.measured()) == 4 * ROOM
    assert memory.words[shared.SAMPLES] == 70


@pytest.mark.parametrize("duty", [smc_duty(2000.0), stepdir_duty("x4step", 2000.0)])
def test_a_real_child_is_measured(duty: Duty) -> None:
    result = measure(duty, seconds=1.0)
    assert len(result.late_us) == pytest.approx(2000, abs=1)
    assert result.played_hz == pytest.approx(2000, rel=0.2)
    median, p99, p999, longest = result.percentiles_us()
    assert 0 < median <= p99 <= p999 <= longest
    assert result.histogram(np.array([0.0, 1e9]))[0] == len(result.late_us)
    assert result.dry_queues == 0


def test_late_edges_are_those_later_than_a_quarter() -> None:
    late_us = np.array([0.0, 49.0, 51.0, 500.0])
    result = Lateness(smc_duty(5000.0), late_us, 5000.0, 0, 0, ())
    assert result.late_edges() == 2


def test_a_rate_that_nobody_can_play_ends_the_ladder() -> None:
    rungs = ladder(stepdir_duty("paper", motors=1), 0.2, (500.0, 1e6, 2e6))
    assert not rungs[-1].holds
    assert rungs[-1].rate_hz <= 1e6
    assert highest_rate_hz(rungs) < 1e6


@pytest.mark.parametrize(
    ("rung", "holds"),
    [
        (Rung(5000.0, 49.0, 4990.0), True),
        (Rung(5000.0, 51.0, 4990.0), False),
        (Rung(100_000.0, 0.5, 80_000.0), False),
    ],
)
def test_a_rate_holds_if_it_is_played_and_on_time(rung: Rung, holds: bool) -> None:
    assert rung.holds is holds
    assert highest_rate_hz([rung]) == (rung.rate_hz if holds else 0.0)


def test_no_machine_leaves_a_loop_alone_for_ever() -> None:
    taken_us = interruptions_us(0.3)
    assert taken_us
    assert all(3.0 < us < 300_000 for us in taken_us)


def test_hogs_are_gone_afterwards() -> None:
    with hogs(2) as pids:
        assert all(Path(f"/proc/{pid}").exists() for pid in pids)
    assert len(pids) == 2
    assert not any(Path(f"/proc/{pid}").exists() for pid in pids)
