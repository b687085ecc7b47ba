"""Long ticks are divided into beats, so that minor axes step more evenly; no step changes."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Outputs, steps_done
from fraese.motor.cursor import divisions
from fraese.motor.seams import CONTROL, DATA, Ended
from tests.motor.workbench import TIRELESS, TRAVEL_STEPS, Workbench, line, steady

GOLDEN = (1000, 618, 382)
STEPS = st.tuples(*[st.integers(-60, 60)] * 3).filter(any)


def step_times_ns(bench: Workbench, motor: int, since: int) -> list[int]:
    """When a motor of the phase card made its steps: at the strobe after its byte."""
    times, addressed = [], -1
    for access in bench.accesses(since):
        if access.register == DATA:
            addressed = access.value >> 6
        elif access.register == CONTROL and access.value & 1 and addressed == motor:
            times.append(access.at_ns)
    return times


def played(bench: Workbench, *steps: int, rate_hz: float) -> list[list[int]]:
    bench.run(steady(0, 0, 1))
    mark = bench.mark()
    bench.run(steady(*steps, rate_hz=rate_hz, jump_hz=rate_hz))
    return [step_times_ns(bench, motor, mark) for motor in range(3)]


@pytest.mark.parametrize(
    ("cycles", "exponent"),
    [(639, 0), (640, 1), (1279, 1), (1280, 2), (2559, 2), (2560, 3), (10**6, 3)],
)
def test_beats_are_never_shorter_than_the_card_takes(cycles: int, exponent: int) -> None:
    assert divisions(cycles, 320) == exponent


def test_minor_axes_step_evenly_at_a_quarter_of_the_top_rate() -> None:
    """Against the ideal times, less the constant lag: an eighth of the leader's interval."""
    rate_hz = 6250.0
    times = played(Workbench(limits=TIRELESS, settle_s=0), *GOLDEN, rate_hz=rate_hz)
    interval_ns = 1e9 / rate_hz
    assert {b - a for a, b in itertools.pairwise(times[0])} == {interval_ns}
    for motor in (1, 2):
        ideal_ns = interval_ns * GOLDEN[0] / GOLDEN[motor]
        off = [at - number * ideal_ns for number, at in enumerate(times[motor])]
        assert max(off) - min(off) <= interval_ns / 8 + 63


def test_undivided_at_the_top_rate() -> None:
    times = played(Workbench(limits=TIRELESS, settle_s=0), *GOLDEN, rate_hz=25_001)
    assert set(times[1]) | set(times[2]) <= set(times[0])


def test_an_equal_axis_moves_with_the_leader_at_any_rate() -> None:
    for rate_hz in (500, 8000, 15_000, 40_000):
        times = played(Workbench(limits=TIRELESS), 50, -50, 50, rate_hz=rate_hz)
        assert times[0] == times[1] == times[2]


@given(STEPS, st.floats(1000, 30_000), st.floats(5e-5, 5e-3))
def test_the_same_steps_at_any_rate_and_under_any_budget(
    steps: tuple[int, int, int], rate_hz: float, budget_s: float
) -> None:
    whole, parts = Workbench(limits=TIRELESS), Workbench(limits=TIRELESS)
    block = steady(*steps, rate_hz=rate_hz, jump_hz=rate_hz)
    whole.run(block)
    report = parts.run(block, budget_s=budget_s)
    assert whole.accesses() == parts.accesses()
    assert report.position_steps == steps
    assert parts.carriages() == steps


@given(st.floats(0, 0.2), st.booleans())
def test_a_tick_in_hand_is_finished(seconds: float, at_once: bool) -> None:
    """Whenever the time is up, the count is of whole ticks or names the minors that have moved."""
    bench = Workbench(limits=TIRELESS, settle_s=0)
    moving = bench.run_for(seconds, line(1000, 618, -382))
    assert bench.carriages() == moving.position_steps
    bench.core.stop()
    report = bench.run(budget_s=1e-5 if at_once else 1.0)
    done = report.position_steps[0]
    assert report.ended is Ended.STOP
    assert 0 <= done - moving.position_steps[0] <= 1
    assert report.position_steps == (
        done,
        steps_done(618, 1000, done),
        -steps_done(382, 1000, done),
    )
    assert bench.carriages() == report.position_steps


def test_a_contact_within_a_tick_is_latched_to_the_motor_that_made_it() -> None:
    bench = Workbench(readings=1, limits=TIRELESS).place("y", TRAVEL_STEPS - 100)
    report = bench.run(steady(1000, 618, rate_hz=500))
    assert report.ended is Ended.SWITCH
    assert report.position_steps[1] == 100
    assert report.position_steps[0] == next(
        n for n in range(1000) if steps_done(618, 1000, n) == 100
    )


def test_outputs_change_before_the_first_beat_that_moves_something() -> None:
    bench = Workbench(outputs=True, limits=TIRELESS)
    mark = bench.mark()
    bench.run(steady(8, 5, rate_hz=500, outputs=Outputs(0b01, 0b01)))
    moves = [n for n, a in enumerate(bench.accesses(mark)) if a.register == DATA]
    changed = [
        n
        for n, a in enumerate(bench.accesses(mark))
        if a.register == CONTROL and not a.value & 0b0010
    ]
    energising = 3
    assert moves[energising - 1] < changed[0] < moves[energising]
