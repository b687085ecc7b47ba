"""The polled core where nothing else fits: other threads, broken ports, closing, queues."""

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import dwell
from fraese.errors import PortError
from fraese.motor.clock import MonotonicClock, VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.phases import MOTZERO
from fraese.motor.requests import Requests
from fraese.motor.seams import DATA, Ended, IdleLevel
from tests.motor.workbench import MAX_HZ, TIRELESS, Workbench, line, steady

PATH = (line(300, 120, -60), line(-80, 200), dwell(3, 0.02), line(200, exit_hz=MAX_HZ))
PATH_TAIL = line(400, entry_hz=MAX_HZ)


class IntrudingClock(VirtualClock):
    """Somebody does something while the core waits for the n-th time, as another thread would."""

    def __init__(self, at_wait: int) -> None:
        super().__init__()
        self.at_wait = at_wait
        self.intrude: Callable[[], object] = lambda: None

    def wait_until(self, deadline_ns: int) -> int:
        self.at_wait -= 1
        if self.at_wait == 0:
            self.intrude()
        return super().wait_until(deadline_ns)


class Unplugged(Exception):
    """Not one of the errors that the core could know."""


class TestIntruders:
    @given(at_wait=st.integers(1, 1100), wiring=st.sampled_from(["smc", "x4step"]))
    def test_a_brake_at_any_time_is_heard_and_changes_no_write(
        self, at_wait: int, wiring: str
    ) -> None:
        clock = IntrudingClock(at_wait)
        bench, smooth = Workbench(wiring, clock=clock), Workbench(wiring)
        clock.intrude = bench.core.brake
        report = bench.run(*PATH, PATH_TAIL, budget_s=100)
        assert report.held
        bench.core.resume()
        report = bench.run(budget_s=100)
        smooth.run(*PATH, PATH_TAIL)
        assert report.ended is Ended.TARGET
        assert bench.data_writes() == smooth.data_writes()
        assert bench.lost() == (0, 0, 0)

    @given(at_wait=st.integers(1, 1100), wiring=st.sampled_from(["smc", "x4step"]))
    def test_a_stop_at_any_time_ends_with_the_tick_in_hand(self, at_wait: int, wiring: str) -> None:
        clock = IntrudingClock(at_wait)
        bench = Workbench(wiring, clock=clock, limits=TIRELESS)
        places: list[int] = []

        def stop() -> None:
            places.append(bench.mark())
            bench.core.stop()

        clock.intrude = stop
        report = bench.run(*PATH, PATH_TAIL, budget_s=100)
        assert report.ended is Ended.STOP
        assert report.position_steps == bench.carriages()
        after = len([a for a in bench.accesses(places[0]) if a.register == DATA])
        assert after <= 3  # a motor each, or fall, clocks, fall

    @pytest.mark.parametrize("wish", ["brake", "stop"])
    def test_a_wish_that_comes_just_as_all_becomes_calm_is_heard(
        self, wish: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Between the look at the flags and the calm another thread may set one."""
        bench, be_calm, calms = Workbench(), Requests.be_calm, []

        def intruded(requests: Requests, calm: bool) -> None:
            calms.append(calm)
            if calms == [True]:
                getattr(bench.core, wish)()
            be_calm(requests, calm)

        bench.run_for(0.2, line(4000))
        monkeypatch.setattr(Requests, "be_calm", intruded)
        bench.core.set_override(1.0)
        report = bench.run(budget_s=100)
        assert calms[0]
        assert 600 < report.position_steps[0] < 1500
        assert report.held if wish == "brake" else report.ended is Ended.STOP
        assert bench.carriage("x") == pytest.approx(report.position_steps[0], abs=3)

    @given(at_wait=st.integers(2, 600))
    def test_what_was_played_is_not_played_again_after_an_interrupt(self, at_wait: int) -> None:
        clock = IntrudingClock(at_wait)
        bench, smooth = Workbench(clock=clock), Workbench()

        def interrupt() -> None:
            raise KeyboardInterrupt

        clock.intrude = interrupt
        try:
            bench.run(*PATH, PATH_TAIL, budget_s=100)
        except KeyboardInterrupt:
            bench.run(budget_s=100)
        smooth.run(*PATH, PATH_TAIL)
        assert bench.report().position_steps == smooth.report().position_steps
        assert bench.carriages() == smooth.carriages()


class TestClosing:
    @pytest.mark.parametrize("wiring", ["smc", "x4step"])
    def test_in_the_middle_of_everything(self, wiring: str) -> None:
        bench = Workbench(wiring)
        bench.run_until_tick(100, line(1000))
        bench.core.close()
        bench.core.close()
        if wiring == "smc":
            assert bench.data_writes()[-3:] == [0x00 | MOTZERO, 0x40 | MOTZERO, 0x80 | MOTZERO]
            assert bench.simulated.look().currents == ((0, 0),) * 3
        else:
            rising, falling = bench.edges_ns()
            assert len(rising) == len(falling)

    def test_the_port_is_given_back_even_if_it_fails(self) -> None:
        bench = Workbench()
        given_back: list[bool] = []

        class Broken:
            def write_data(self, value: int) -> None:
                if bench.clock.now_ns() > 0:
                    raise PortError("gone")

            def write_control(self, value: int) -> None: ...
            def read_status(self) -> int:
                return 0xF8

            def close(self) -> None:
                given_back.append(True)

        core = MotorCore(Broken(), bench.card, bench.clock)
        bench.wait()
        with pytest.raises(PortError):
            core.close()
        assert given_back == [True]

    def test_motors_are_switched_off_even_if_the_rest_fails(self) -> None:
        """The clock breaks while the last falling edge is waited for."""
        clock = IntrudingClock(0)
        bench = Workbench("x4step", clock=clock, outputs=True)
        bench.run_until_tick(10, steady(100))

        def unplug() -> None:
            raise Unplugged

        clock.at_wait, clock.intrude = 1, unplug
        with pytest.raises(Unplugged):
            bench.core.close()
        assert bench.data_writes()[-1] & 0b10101010 == 0


class TestStandstillCurrent:
    def test_settles_only_when_current_comes_on(self) -> None:
        bench = Workbench(settle_s=0.05)
        bench.run(steady(10))
        first_ns = bench.clock.now_ns()
        assert first_ns == 50_000_000 + 10_000_000
        bench.run(steady(10))
        assert bench.clock.now_ns() - first_ns == 10_000_000
        bench.core.idle(IdleLevel.OFF)
        bench.run(steady(10))
        assert bench.clock.now_ns() - first_ns == 10_000_000 + 60_000_000

    def test_phases_stay_where_they_are(self) -> None:
        bench = Workbench()
        bench.run(steady(3, 5, 7))
        for level in IdleLevel:
            bench.core.idle(level)
            bench.run(steady(8))
            assert bench.carriages() == bench.report().position_steps
        assert bench.lost() == (0, 0, 0)


class TestSerials:
    def test_numbers_go_on_over_what_was_dropped(self) -> None:
        bench = Workbench()
        bench.run_until_tick(5, *[steady(20, tag=t) for t in (11, 12, 13)])
        assert (bench.report().playing, bench.report().tag) == (1, 11)
        bench.core.stop()
        assert bench.run().playing == 3
        bench.push(steady(10, tag=14))
        assert bench.run_until_tick(2).playing == 4
        assert bench.report().tag == 14


def test_a_real_clock_plays_too() -> None:
    bench = Workbench(clock=MonotonicClock(), settle_s=0, limits=TIRELESS)
    start_ns = bench.clock.now_ns()
    report = bench.run(steady(6, rate_hz=1000))
    assert bench.clock.now_ns() - start_ns >= 6_000_000
    assert bench.carriage("x") == report.position_steps[0] == 6
