"""Planned motion on the core and the simulated mill: nothing is lost, whatever comes between."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import Block
from fraese.machine import Machine
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.electronics import SmcElectronics
from fraese.motor.mill import Mill, Slide
from fraese.motor.ports.recorder import Recorder
from fraese.motor.ports.sim import SimulatedMill
from fraese.motor.rotor import RotorLimits
from fraese.motor.seams import CONTROL, Ended, Report
from fraese.planner.planner import Options, Planner
from tests.planner.motion import Point, machine, run, total_steps, uneven

MACHINES = {
    "built-in": machine(),
    "uneven": uneven(),
    "lash": machine(backlash_steps=7),
    "sine": replace(uneven(), ramp="sine"),
    "s-curve": replace(machine(), ramp="s-curve"),
}
LEVELS = (100, 60, 20, 0)


@dataclass
class Bench:
    """A core with a simulated mill whose motors can do hardly more than the machine says."""

    core: MotorCore
    mill: Mill
    port: Recorder

    def play(self, between: Callable[[Report], None] = lambda _: None) -> Report:
        report = self.core.poll(0.01)
        while report.running:
            between(report)
            report = self.core.poll(0.01)
        return report

    def lost(self) -> tuple[float, ...]:
        for rotor in self.mill.rotors:
            rotor.settle(10**15)
        return self.mill.lost_steps()


def bench(axes: Machine, capacity: int = 100_000) -> Bench:
    clock = VirtualClock()
    limits = [
        RotorLimits(
            max_rate_hz=axis.max_rate_hz * 1.02,
            jump_hz=axis.start_rate_hz * 1.1,
            acceleration_hz_s=axis.acceleration_hz_s * 1.2,
        )
        for axis in axes.axes
    ]
    mill = Mill([Slide(400_000, limit) for limit in limits])
    port = Recorder(SimulatedMill(mill, SmcElectronics(mill, clock, LEVELS), clock), clock)
    return Bench(MotorCore(port, SmcCard(), clock, capacity=capacity), mill, port)


def strokes(port: Recorder) -> list[tuple[int, int]]:
    """Every register write that moves a motor, without what a standstill adds."""
    return [write for write in port.writes() if write[0] != CONTROL or write[1] & 1]


POINTS = st.lists(
    st.tuples(*[st.floats(-2, 2).map(lambda mm: round(mm, 3))] * 3), min_size=1, max_size=5
)
PATHS = st.one_of(
    POINTS,
    st.tuples(POINTS, st.integers(3, 12)).map(
        lambda both: [
            tuple(a * k / both[1] for a in point)
            for point in both[0]
            for k in (*range(1, both[1] + 1), 0)
        ]
    ),
)


def planned(
    axes: Machine, points: list[Point], feed: float | None, factors: tuple[float, ...] = ()
) -> list[Block]:
    planner = Planner(axes, (0, 0, 0), Options())
    if factors:
        planner.set_override(*factors)
    return run(planner, points, feed)


@settings(max_examples=25)
@given(st.sampled_from(sorted(MACHINES)), PATHS, st.sampled_from([None, 300.0, 900.0]))
def test_motors_that_can_hardly_do_more_lose_nothing(
    name: str, points: list[Point], feed: float | None
) -> None:
    axes = MACHINES[name]
    blocks = planned(axes, points, feed)
    machine_bench = bench(axes)
    for block in blocks:
        assert machine_bench.core.push(block)
    report = machine_bench.play()
    if blocks:
        assert report.position_steps == total_steps(blocks)
        assert report.ended is Ended.TARGET
    assert not report.torn
    assert report.dry_queues == 0
    assert machine_bench.lost() == (0, 0, 0)


ROUND = [(3.0, 1.0, 0.2), (3.0, 4.0, -0.5), (3.1, 4.0, -0.5), (3.2, 4.05, -0.5), (0.0, 0.0, 0.0)]


@pytest.mark.parametrize("name", sorted(MACHINES))
@pytest.mark.parametrize("at", [3, 11, 26, 60, 90])
def test_hold_and_resume_change_no_step_and_lose_none(name: str, at: int) -> None:
    axes = MACHINES[name]
    blocks = planned(axes, ROUND, 900.0)
    plain, held = bench(axes), bench(axes)
    for block in blocks:
        plain.core.push(block)
        held.core.push(block)
    plain.play()

    polls = 0

    def hold(_: Report) -> None:
        nonlocal polls
        polls += 1
        if polls == at:
            held.core.brake()

    report = held.play(hold)
    assert report.held
    stood = report.position_steps
    held.core.poll(0.5)
    assert held.core.poll(0.5).position_steps == stood
    held.core.resume()
    report = held.play()
    assert report.position_steps == total_steps(blocks)
    assert not report.torn
    assert held.lost() == (0, 0, 0)
    assert strokes(held.port) == strokes(plain.port)


@settings(max_examples=20)
@given(st.data())
def test_any_number_of_holds_changes_no_step(data: st.DataObject) -> None:
    axes = MACHINES["uneven"]
    blocks = planned(axes, data.draw(POINTS), 900.0)
    when = data.draw(st.sets(st.integers(0, 200), max_size=6))
    plain, held = bench(axes), bench(axes)
    for block in blocks:
        plain.core.push(block)
        held.core.push(block)
    plain.play()
    for poll in range(1_000_000):
        report = held.core.poll(0.01)
        if report.held:
            held.core.resume()
        elif not report.running:
            break
        if poll in when:
            held.core.brake()
    assert held.core.poll(0.01).position_steps == total_steps(blocks)
    assert held.lost() == (0, 0, 0)
    assert strokes(held.port) == strokes(plain.port)


@pytest.mark.parametrize("name", sorted(MACHINES))
@pytest.mark.parametrize("part", [1, 3, 5, 9, 20])
def test_a_queue_that_runs_dry_ends_in_a_stop_within_its_path(name: str, part: int) -> None:
    axes = MACHINES[name]
    line = [(k * 0.4, k * 0.25, 0.0) for k in range(1, 40)]
    blocks = planned(axes, line, 1100.0)
    machine_bench = bench(axes)
    for block in blocks[:part]:
        machine_bench.core.push(block)
    report = machine_bench.play()
    inside = total_steps(blocks[:part])
    assert all(abs(n) <= abs(m) for n, m in zip(report.position_steps, inside, strict=True))
    assert not report.torn
    assert machine_bench.lost() == (0, 0, 0)
    for block in blocks[part:]:
        machine_bench.core.push(block)
    report = machine_bench.play()
    assert report.position_steps == total_steps(blocks)
    assert not report.torn
    assert machine_bench.lost() == (0, 0, 0)


@settings(max_examples=20)
@given(st.sampled_from(sorted(MACHINES)), PATHS, st.integers(1, 6))
def test_a_slow_host_costs_time_only(name: str, points: list[Point], at_once: int) -> None:
    axes = MACHINES[name]
    blocks = planned(axes, points, 900.0)
    machine_bench = bench(axes)
    waiting = list(blocks)
    report = machine_bench.core.poll(0.0)
    while waiting or report.running:
        if not report.running or report.queued < 2:
            for block in waiting[:at_once]:
                machine_bench.core.push(block)
            del waiting[:at_once]
        report = machine_bench.core.poll(0.004)
    if blocks:
        assert report.position_steps == total_steps(blocks)
    assert not report.torn
    assert machine_bench.lost() == (0, 0, 0)
