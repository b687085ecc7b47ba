"""Brake, hold, resume, a dry queue: one mechanism, and the path stays what it is."""

import itertools
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import (
    RATE_Q8_CYCLES,
    Block,
    Outputs,
    Piece,
    accel_q_from_hz_s,
    dwell,
    rate_q8_from_hz,
    steps_done,
)
from fraese.errors import StateError
from fraese.motor.cursor import Cursor
from fraese.motor.seams import DATA, Ended, Report
from fraese.motor.throttle import Throttle, ThrottleState
from fraese.planner.ramps import trapezoid
from tests.motor.workbench import (
    ACCELERATION_HZ_S,
    JUMP_HZ,
    MAX_HZ,
    TIRELESS,
    Workbench,
    line,
    steady,
)

#: What a slice of one millisecond changes at most.
SLICE_HZ = ACCELERATION_HZ_S / 1000
PATH = (line(600, 250, -130), line(-300, 300), dwell(3, 0.03), steady(40), line(500, 499, 1))


def gaps_hz(bench: Workbench, since: int) -> list[float]:
    """Rate before every data write but the first: the rate of the leader, if it moves alone."""
    at_ns = [a.at_ns for a in bench.accesses(since) if a.register == DATA]
    return [1e9 / (b - a) for a, b in itertools.pairwise(at_ns)]


@cache
def braked_at(*nothing: Piece) -> tuple[int, ...]:
    """Where a brake shortly before a junction comes to rest, with these pieces behind it."""
    second = line(1000, entry_hz=MAX_HZ)
    second = second._replace(pieces=(*nothing, *second.pieces))
    bench = Workbench()
    bench.run_for(0.2575, line(1000, exit_hz=MAX_HZ), second)
    assert 900 < bench.report().tick < 1000
    bench.core.brake()
    return bench.run().position_steps


class TestBrake:
    def test_stands_within_the_braking_distance_and_keeps_the_queue(self) -> None:
        bench = Workbench()
        before = bench.run_until_tick(1500, line(4000), line(100))
        bench.core.brake()
        report = bench.run()
        assert report.held
        assert not report.running
        assert report.queued == 2
        distance = report.position_steps[0] - before.position_steps[0]
        ideal = (MAX_HZ**2 - JUMP_HZ**2) / 2 / ACCELERATION_HZ_S
        assert ideal * 0.95 < distance < ideal * 1.05 + 10
        assert bench.carriage("x") == report.position_steps[0]

    def test_rate_falls_steadily_and_rises_again(self) -> None:
        bench = Workbench()
        bench.run_until_tick(1500, line(6000))
        mark = bench.mark()
        bench.core.brake()
        bench.run()
        falling = gaps_hz(bench, mark)
        assert max(b - a for a, b in itertools.pairwise(falling)) < 1
        assert min(b - a for a, b in itertools.pairwise(falling)) > -2 * SLICE_HZ
        mark = bench.mark()
        bench.core.resume()
        bench.run_for(0.2)
        rising = gaps_hz(bench, mark)
        assert JUMP_HZ * 0.99 < rising[0] < JUMP_HZ + 1.1 * SLICE_HZ
        assert rising[-1] == pytest.approx(MAX_HZ, rel=0.01)
        assert max(b - a for a, b in itertools.pairwise(rising)) < 2 * SLICE_HZ

    @given(tick=st.integers(0, 1500), again=st.integers(1, 400))
    def test_path_is_the_same_whenever_it_is_held(self, tick: int, again: int) -> None:
        smooth, held = Workbench(), Workbench()
        smooth.run(*PATH)
        held.push(*PATH)
        for wait in (tick, again):
            held.run_for(wait * 0.0005)
            held.core.brake()
            held.run()
            held.wait(0.1).core.resume()
        report = held.run()
        assert held.data_writes() == smooth.data_writes()
        assert held.carriages() == smooth.carriages() == report.position_steps
        assert held.lost() == (0, 0, 0)

    @given(interval_q8=st.integers(1, 1 << 40))
    def test_a_piece_without_ticks_is_nothing_at_a_junction(self, interval_q8: int) -> None:
        assert braked_at(Piece(0, interval_q8)) == braked_at()

    def test_braking_goes_on_over_junctions_without_a_leap(self) -> None:
        """Short blocks, all planned at the full rate."""
        bench = Workbench()
        blocks = [
            steady(100, rate_hz=MAX_HZ, ends_at_rest=False),
            *(steady(40, rate_hz=MAX_HZ, ends_at_rest=False) for _ in range(50)),
            line(1000, entry_hz=MAX_HZ),
        ]
        bench.run_until_tick(400, line(500, exit_hz=MAX_HZ), *blocks)
        mark = bench.mark()
        bench.core.brake()
        assert bench.run().held
        rates_hz = gaps_hz(bench, mark)
        assert max(b - a for a, b in itertools.pairwise(rates_hz)) < 1
        assert len(rates_hz) < 400

    @pytest.mark.parametrize("tick", [1500, 1620, 1690])
    def test_braking_in_a_ramp_of_the_plan_goes_on_over_a_junction(self, tick: int) -> None:
        """The first block slows down to its end, where the second one begins to speed up."""
        bench = Workbench()
        bench.run_until_tick(tick, line(1700, exit_hz=3000), line(3000, entry_hz=3000))
        mark = bench.mark()
        bench.core.brake()
        report = bench.run()
        assert report.held
        assert report.playing == 2
        rates_hz = gaps_hz(bench, mark)
        slowest_hz = itertools.accumulate(rates_hz, min)
        assert (
            max(hz - so_far_hz for hz, so_far_hz in zip(rates_hz, slowest_hz, strict=True))
            < 2 * SLICE_HZ
        )
        assert min(b - a for a, b in itertools.pairwise(rates_hz)) > -2 * SLICE_HZ

    def test_path_speed_stays_what_it_is_where_the_leader_changes(self) -> None:
        """The second line is twice as long a tick: half the rate is the same speed."""
        bench = Workbench()
        second = steady(600, rate_hz=MAX_HZ / 2, jump_hz=JUMP_HZ / 2, ends_at_rest=False)
        second = second._replace(weight=4000, accel_q=second.accel_q // 2)
        bench.run_until_tick(400, line(500, exit_hz=MAX_HZ), second, steady(1, rate_hz=500))
        mark = bench.mark()
        bench.core.brake()
        report = bench.run()
        assert report.held
        rates_hz = gaps_hz(bench, mark)
        first = 500 - 400 - 1
        speeds = rates_hz[: first - 1] + [2 * rate for rate in rates_hz[first:]]
        changes = [b - a for a, b in itertools.pairwise(speeds)]
        assert max(changes) < 3
        # A move that falls on the junction is made after it, with the time of both.
        assert min(changes) > -3 * SLICE_HZ
        assert JUMP_HZ * 0.9 < speeds[-1] < JUMP_HZ * 1.1

    def test_at_standstill_it_holds_what_comes(self) -> None:
        bench = Workbench()
        bench.core.brake()
        report = bench.run(line(100))
        assert report.held
        assert report.position_steps == (0, 0, 0)
        started_ns = bench.clock.now_ns()
        bench.core.resume()
        assert bench.run().position_steps == (100, 0, 0)
        assert bench.clock.now_ns() - started_ns < 200_000_000

    def test_before_the_first_tick(self) -> None:
        bench = Workbench()
        bench.run_for(0, line(100))
        bench.core.brake()
        assert bench.run().position_steps == (0, 0, 0)
        bench.core.resume()
        assert bench.run().position_steps == (100, 0, 0)

    def test_in_a_dwell_it_holds_at_once_and_the_dwell_keeps_its_length(self) -> None:
        bench = Workbench(settle_s=0)
        bench.run_for(0.5, dwell(3, 1.0), steady(1))
        bench.core.brake()
        now_ns = bench.clock.now_ns()
        assert bench.run().held
        assert bench.clock.now_ns() - now_ns <= 10_000_000
        bench.core.resume()
        bench.run()
        assert bench.clock.now_ns() == pytest.approx(1_001_000_000, abs=10_000_000)

    def test_dwell_after_opening_plays_in_its_own_time(self) -> None:
        """The line is too short to meet its plan again before the dwell begins."""
        bench = Workbench(settle_s=0, limits=TIRELESS)
        bench.run(steady(1))
        bench.core.brake()
        assert bench.run(steady(40, rate_hz=MAX_HZ), dwell(3, 1.0)).held
        bench.core.resume()
        before_ns = bench.clock.now_ns()
        bench.run()
        assert bench.clock.now_ns() - before_ns < 1_100_000_000

    def test_at_a_crawl_it_holds_before_the_next_tick(self) -> None:
        bench = Workbench()
        crawl = steady(10, rate_hz=0.5, ends_at_rest=False)
        bench.run_for(5.0, crawl)
        bench.core.brake()
        before_ns = bench.clock.now_ns()
        assert bench.run().held
        assert bench.clock.now_ns() == before_ns

    def test_twice_is_once(self) -> None:
        bench = Workbench()
        bench.run_until_tick(500, line(2000))
        bench.core.brake()
        bench.core.poll(0.001)
        bench.core.brake()
        assert bench.run().held
        bench.core.resume()
        assert bench.run().position_steps[0] == 2000

    def test_resumed_while_still_braking(self) -> None:
        bench = Workbench()
        bench.run_until_tick(1000, line(4000))
        bench.core.brake()
        bench.core.poll(0.01)
        bench.core.resume()
        report = bench.run()
        assert not report.held
        assert report.ended is Ended.TARGET
        assert bench.carriage("x") == 4000

    def test_braked_into_the_end_of_the_queue_stays_held(self) -> None:
        bench = Workbench()
        bench.run_until_tick(990, line(1000))
        bench.core.brake()
        report = bench.run()
        assert report.held
        bench.core.resume()
        assert bench.run(line(50)).position_steps[0] == 1050


class TestResumeFlushStop:
    def test_resume_without_brake_changes_nothing(self) -> None:
        bench = Workbench()
        bench.core.resume()
        bench.run_until_tick(50, line(300))
        bench.core.resume()
        assert bench.run().position_steps[0] == 300

    def test_flush_needs_standstill(self) -> None:
        bench = Workbench()
        bench.run_until_tick(50, line(300), line(100))
        with pytest.raises(StateError):
            bench.core.flush()
        bench.core.brake()
        held = bench.run()
        bench.core.flush()
        report = bench.report()
        assert report.ended is Ended.FLUSH
        assert report.position_steps == held.position_steps
        assert (report.queued, report.held) == (0, False)
        assert report.playing == 2
        assert bench.run(line(-10)).position_steps[0] == held.position_steps[0] - 10

    def test_stop_while_held_drops_all_and_opens(self) -> None:
        bench = Workbench()
        bench.run_until_tick(100, line(300))
        bench.core.brake()
        held = bench.run()
        bench.core.stop()
        report = bench.report()
        assert (report.ended, report.queued, report.held) == (Ended.STOP, 0, False)
        assert not report.torn
        assert bench.run(line(10)).position_steps[0] == held.position_steps[0] + 10

    def test_stop_and_brake_together_is_stop(self) -> None:
        bench = Workbench()
        bench.run_until_tick(100, line(300))
        bench.core.brake()
        bench.core.stop()
        assert bench.run().ended is Ended.STOP
        assert bench.run(line(10)).ended is Ended.TARGET

    @given(seconds=st.floats(0, 0.3))
    def test_stop_at_any_tick(self, seconds: float) -> None:
        bench = Workbench()
        moving = bench.run_for(seconds, line(1000, 333))
        bench.core.stop()
        report = bench.run()
        assert report.ended is Ended.STOP
        # The tick in hand is finished: the leader's step may still be to come, a minor's not.
        leader = report.position_steps[0]
        assert 0 <= leader - moving.position_steps[0] <= 1
        assert report.position_steps == (leader, steps_done(333, 1000, leader), 0)
        assert bool(report.torn) == (moving.rate_hz > JUMP_HZ * 1.0625)
        if report.torn:
            assert report.torn == {0, 1}

    def test_stop_during_a_dwell(self) -> None:
        bench = Workbench()
        bench.run_for(0.5, dwell(3, 1.0), line(100))
        bench.core.stop()
        report = bench.run()
        assert (report.ended, report.torn) == (Ended.STOP, frozenset())
        assert report.position_steps == (0, 0, 0)

    def test_stop_at_a_junction_tears_what_moved(self) -> None:
        bench = Workbench()
        bench.run_for(0, line(500, exit_hz=MAX_HZ), line(0, 1000, entry_hz=MAX_HZ))
        while bench.core.poll(20e-6).position_steps[0] < 500:
            pass
        assert bench.report().position_steps[1] == 0
        bench.core.stop()
        assert bench.run().torn == {0}


class TestDryQueue:
    def stream(self, blocks: int) -> list[Block]:
        return [
            line(300, exit_hz=MAX_HZ),
            *(steady(30, rate_hz=MAX_HZ, ends_at_rest=False) for _ in range(blocks)),
        ]

    @pytest.mark.parametrize("blocks", [12, 20, 40])
    def test_comes_to_a_braked_standstill_inside_its_own_path(self, blocks: int) -> None:
        bench = Workbench()
        report = bench.run(*self.stream(blocks))
        total = 300 + 30 * blocks
        assert report.held
        assert report.dry_queues == 1
        assert total - 60 < report.position_steps[0] < total
        assert not report.torn
        assert bench.lost() == (0, 0, 0)

    @pytest.mark.parametrize("rate_hz", [15_000, 20_000])
    @pytest.mark.parametrize("blocks", [1, 2, 3, 5, 8])
    def test_at_a_high_rate_the_throttle_s_slices_are_reckoned_with(
        self, rate_hz: int, blocks: int
    ) -> None:
        """Two slices of the throttle are up to forty ticks here: braking begins so much earlier."""
        acceleration_hz_s, jump_hz = 100_000, 1000
        ways = [(0, 9000), *[(rate_hz, 40)] * blocks]
        bench = Workbench("x4step", travel_steps=40_000)
        pushed = 0
        for entry_hz, ticks in ways:
            law = trapezoid(ticks, entry_hz or jump_hz, rate_hz, rate_hz, acceleration_hz_s)
            block = Block(
                steps=(ticks, 0, 0),
                pieces=tuple(law),
                accel_q=accel_q_from_hz_s(acceleration_hz_s),
                jump_rate_q8=rate_q8_from_hz(jump_hz),
                weight=1000,
                ends_at_rest=False,
            )
            bench.core.push(block)
            pushed += ticks
        report = bench.run()
        assert (report.held, report.dry_queues, report.torn) == (True, 1, frozenset())
        assert pushed - 90 < report.position_steps[0] < pushed

    def test_goes_on_when_more_comes(self) -> None:
        bench = Workbench()
        bench.run(*self.stream(20))
        report = bench.run(line(1000, entry_hz=MAX_HZ))
        assert report.ended is Ended.TARGET
        assert report.position_steps[0] == 1900
        assert report.dry_queues == 1
        assert bench.carriage("x") == 1900

    def test_a_brake_during_the_dry_hold_stays(self) -> None:
        bench = Workbench()
        dry = bench.run(*self.stream(20))
        bench.core.brake()
        bench.core.poll(0.001)
        report = bench.run(line(1000, entry_hz=MAX_HZ))
        assert report.held
        assert report.position_steps == dry.position_steps
        bench.core.resume()
        assert bench.run().position_steps[0] == 1900

    def test_fed_again_only_after_its_end_it_starts_slowly(self) -> None:
        bench = Workbench()
        bench.run(steady(1, rate_hz=MAX_HZ / 6, ends_at_rest=False))
        mark = bench.mark()
        report = bench.run(line(1000, entry_hz=MAX_HZ))
        assert gaps_hz(bench, mark)[0] < JUMP_HZ * 1.1
        assert report.position_steps[0] == bench.carriage("x") == 1001

    def test_resumed_with_nothing_new_it_creeps_to_the_end(self) -> None:
        bench = Workbench()
        bench.run(*self.stream(20))
        for _ in range(40):
            bench.core.resume()
            report = bench.run()
        assert report.ended is Ended.TARGET
        assert report.position_steps[0] == 900
        assert bench.carriage("x") == 900

    @given(
        lengths=st.lists(st.integers(1, 60), min_size=1, max_size=20),
        polls=st.lists(st.integers(0, 30), min_size=1, max_size=8),
    )
    def test_fed_late_at_any_time_nothing_is_lost(
        self, lengths: list[int], polls: list[int]
    ) -> None:
        bench = Workbench()
        bench.push(*self.stream(12))
        for ticks, count in zip(lengths, itertools.cycle(polls), strict=False):
            bench.run_for(count * 0.002)
            bench.push(steady(ticks, rate_hz=MAX_HZ, ends_at_rest=False))
        report = bench.run(line(600, entry_hz=MAX_HZ))
        assert report.ended is Ended.TARGET
        assert report.position_steps[0] == 1260 + sum(lengths)
        assert not report.torn
        assert bench.lost() == (0, 0, 0)


class TestBudgets:
    """However the time is cut into polls, the wire is the same, to the nanosecond."""

    def wire(self, budget_s: float, blocks: tuple[Block, ...], wiring: str) -> object:
        bench = Workbench(wiring, settle_s=0, outputs=True)
        report = bench.run(*blocks, budget_s=budget_s)
        if report.held:
            report = bench.run(line(400, entry_hz=MAX_HZ), budget_s=budget_s)
        return bench.writes(), [a.at_ns for a in bench.accesses() if a.register == DATA], report

    @pytest.mark.parametrize("wiring", ["smc", "x4step", "paper"])
    def test_one_microsecond(self, wiring: str) -> None:
        blocks = (
            line(60, -20, outputs=Outputs(1, 1)),
            dwell(3, 0.001),
            dwell(3, 0),
            steady(-5, 2, outputs=Outputs(3, 2)),
        )
        assert self.wire(1e-6, blocks, wiring) == self.wire(10, blocks, wiring)

    @settings(max_examples=30)
    @given(
        budget_us=st.integers(40, 3000),
        wiring=st.sampled_from(["smc", "x4step"]),
        lines=st.lists(st.tuples(*[st.integers(-90, 90)] * 3).filter(any), min_size=1, max_size=4),
        dry=st.booleans(),
    )
    def test_any_budget(
        self, budget_us: int, wiring: str, lines: list[tuple[int, int, int]], dry: bool
    ) -> None:
        blocks = [line(*steps) for steps in lines]
        if dry:
            blocks += [line(300, exit_hz=MAX_HZ), steady(200, rate_hz=MAX_HZ, ends_at_rest=False)]
        one = self.wire(budget_us * 1e-6, tuple(blocks), wiring)
        assert one == self.wire(10, tuple(blocks), wiring)

    def test_an_interval_longer_than_the_budget(self) -> None:
        bench = Workbench(settle_s=0)
        bench.push(steady(3, rate_hz=1))
        reports = [bench.core.poll(0.1) for _ in range(31)]
        assert [r.position_steps[0] for r in reports[::10]] == [0, 1, 2, 3]
        assert not reports[-1].running

    def test_the_next_due_time_is_told(self) -> None:
        bench = Workbench(settle_s=0)
        report = bench.run_for(0.0105, steady(50, rate_hz=1000))
        assert report.due_ns == 11_000_000
        assert report.rate_hz == pytest.approx(1000)
        report = bench.run(dwell(3, 0.5))
        assert (report.due_ns, report.rate_hz) == (0, 0)

    def test_no_rate_in_a_dwell(self) -> None:
        bench = Workbench(settle_s=0)
        report = bench.run_for(0.2, steady(10), dwell(3, 0.5))
        assert report.running
        assert report.rate_hz == 0


class TestThrottleAlone:
    def test_a_start_stop_rate_of_nothing_does_not_take_minutes(self) -> None:
        creeping = Cursor(steady(10, jump_hz=0)._replace(accel_q=43_000))
        throttle = Throttle()
        throttle.block(43_000, creeping.jump_rate_q8, creeping.jump_cycles)
        throttle.hold()
        throttle.open()
        assert throttle.interval(0, 0) < 16_000_000 // 10

    @given(
        accel_q=st.integers(1, 2**20),
        jump_q8=st.integers(1, 2**21),
        plans=st.lists(st.integers(100, 200_000), min_size=1, max_size=60),
        entry=st.integers(0, 200_000),
    )
    def test_never_divides_by_nothing_and_never_exceeds_the_plan(
        self, accel_q: int, jump_q8: int, plans: list[int], entry: int
    ) -> None:
        throttle = Throttle()
        throttle.block(accel_q, jump_q8, RATE_Q8_CYCLES // jump_q8)
        last = 0
        for index, plan in enumerate(plans):
            if index % 7 == 3:
                throttle.close(last)
            if index % 5 == 4:
                throttle.junction(last, entry)
            if index % 11 == 9:
                throttle.open()
            if last:
                throttle.advance(last, len(plans) - index)
            throttle.mind_ceiling(2**19 if index % 13 > 6 else 0, last)
            cycles = throttle.interval(plan, last)
            if cycles < 0:
                assert throttle.state is ThrottleState.HELD
                throttle.open()
                cycles = throttle.interval(plan, 0)
            assert cycles >= plan
            last = cycles


def test_report_is_frozen() -> None:
    report: Report = Workbench().report()
    with pytest.raises(AttributeError):
        report.tag = 3  # type: ignore[misc]
