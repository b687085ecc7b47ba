"""Inputs are read in long waits too, and what they ask for acts there and then."""

import pytest

from fraese.blocks import Watch, WatchAction, dwell
from fraese.motor.seams import Ended
from tests.motor.workbench import TIRELESS, Workbench, end, line, steady

FRESH_S = 0.03


@pytest.mark.parametrize("wiring", ["smc", "x4step", "paper"])
class TestLongWaits:
    """Ten steps a second: a tick every tenth of a second."""

    def bench(self, wiring: str) -> Workbench:
        bench = Workbench(wiring, limits=TIRELESS, settle_s=0)
        bench.push(steady(20, 3, rate_hz=10))
        bench.core.poll(0.25)
        return bench

    @pytest.mark.parametrize("moment_s", [0.0, 0.013, 0.04, 0.06, 0.085])
    def test_inputs_are_fresh(self, wiring: str, moment_s: float) -> None:
        bench = self.bench(wiring).ignore_switches()
        bench.core.poll(moment_s)
        before = bench.report().inputs
        bench.simulated.press(end("z-"))
        report = bench.core.poll(FRESH_S)
        assert (before ^ report.inputs) & 0x80
        assert report.running

    def test_reading_changes_no_write(self, wiring: str) -> None:
        """However the time is cut into polls."""
        whole, pieces = (
            Workbench(wiring, limits=TIRELESS, settle_s=0).push(steady(7, -3, 2, rate_hz=10))
            for _ in range(2)
        )
        whole.run(budget_s=100)
        pieces.run(budget_s=0.003)
        assert [tuple(a) for a in whole.accesses()] == [tuple(a) for a in pieces.accesses()]

    def test_a_contact_ends_the_wait(self, wiring: str) -> None:
        """Three readings, then no further step; a pulse that has begun is finished."""
        bench = self.bench(wiring)
        made = bench.report().position_steps
        bench.simulated.press(end("z-"))
        pressed_ns = bench.clock.now_ns()
        report = bench.run()
        assert report.ended is Ended.SWITCH
        assert report.position_steps[0] - made[0] <= 1
        assert bench.clock.now_ns() - pressed_ns < 100_000_000


@pytest.mark.parametrize("wiring", ["smc", "x4step", "paper"])
@pytest.mark.parametrize("readings", [1, 2, 3])
def test_a_watch_fulfilled_in_the_first_ticks_sees_their_rate(wiring: str, readings: int) -> None:
    """Above the start/stop rate it brakes: a reading belongs to the tick that is just made."""
    bench = Workbench(wiring, readings=readings)
    watch = Watch(0x80, 0x80, WatchAction.STOP)
    for steps in (8, 40, 300):
        report = bench.run(dwell(3, 0), line(0, 0, steps, watch=watch))
        assert not report.torn
        assert report.ended in (Ended.WATCH, Ended.TARGET)
    assert bench.lost() == (0, 0, 0)
