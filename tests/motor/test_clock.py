"""Clocks: the old time base, and time that keeps step with the wall."""

import time

import pytest

from fraese.blocks import CYCLES_PER_S, Piece
from fraese.motor.clock import PacedClock
from tests.motor.workbench import Workbench, steady

#: The PC's 8253 timer in mode 3 with divisor 256 (seed: FASTTIM): a tick of 0.2145524 ms.
TIMER_8253_HZ = 1_193_182
TIMER_8253_DIVISOR = 256
#: The step rate that the original called its theoretical ceiling, 4661 Hz.
TIMER_8253_RATE_HZ = TIMER_8253_HZ / TIMER_8253_DIVISOR


def test_the_8253_ticks_as_the_original_says() -> None:
    assert pytest.approx(0.2145524, abs=1e-7) == 1000 * TIMER_8253_DIVISOR / TIMER_8253_HZ
    assert round(TIMER_8253_RATE_HZ) == 4661


def test_the_original_s_rate_is_played() -> None:
    ticks = 2000
    law = (Piece(ticks, round(CYCLES_PER_S * 256 / TIMER_8253_RATE_HZ)),)
    bench = Workbench(settle_s=0)
    bench.run(steady(ticks, jump_hz=5000)._replace(pieces=law))
    assert bench.clock.now_ns() * 1e-9 == pytest.approx(ticks / TIMER_8253_RATE_HZ, rel=1e-3)


def test_a_paced_clock_is_not_ahead_of_the_wall() -> None:
    clock, start_ns = PacedClock(), time.monotonic_ns()
    for now_ns in range(0, 6_000_001, 500_000):
        assert clock.wait_until(now_ns) == now_ns
    assert time.monotonic_ns() - start_ns >= 1_500_000


def test_missed_time_is_not_made_up_for_in_a_burst(monkeypatch: pytest.MonkeyPatch) -> None:
    wall_ns = [0]
    slept_s: list[float] = []
    monkeypatch.setattr(time, "monotonic_ns", lambda: wall_ns[0])
    monkeypatch.setattr(time, "sleep", slept_s.append)
    clock = PacedClock()
    wall_ns[0] = 5_000_000_000
    clock.wait_until(1_000_000)
    assert slept_s == []
    clock.wait_until(101_000_000)
    assert slept_s == [pytest.approx(0.1)]
