"""What is on the wire, byte for byte."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import dwell
from fraese.motor.clock import VirtualClock
from fraese.motor.phases import MOTZERO
from fraese.motor.seams import CONTROL, DATA, STATUS, IdleLevel
from tests.motor.workbench import TIRELESS, BusyClock, Workbench, line, steady

#: The drive table of the original, written here once more.
SEED_TABLE = (0x03, 0x09, 0x38, 0x29, 0x27, 0x2D, 0x1C, 0x0D)
MOTOR_BITS = (0x00, 0x40, 0x80)
HALF_CLOCK_NS = 25_000


def latch(byte: int) -> list[tuple[int, int]]:
    return [(DATA, byte), (CONTROL, 1), (CONTROL, 0)]


def alone(motor: int, steps: int) -> tuple[int, ...]:
    return tuple(steps if m == motor else 0 for m in range(3))


class TestSeedTable:
    @pytest.mark.parametrize("motor", range(3))
    def test_two_cycles_and_a_bit_each_way(self, motor: int) -> None:
        bench = Workbench()
        mark = bench.mark()
        bench.run(steady(*alone(motor, 19)), steady(*alone(motor, -21)))
        bench.core.idle(IdleLevel.OFF)

        bits = MOTOR_BITS[motor]
        expected = [w for m in MOTOR_BITS for w in latch(m | SEED_TABLE[0])]
        index = 0
        for direction in [1] * 19 + [-1] * 21:
            index = (index + direction) % 8
            expected += latch(bits | SEED_TABLE[index])
        expected += [w for m in MOTOR_BITS for w in latch(m | MOTZERO)]
        assert bench.writes(mark) == expected

    def test_motors_are_switched_off_first_and_last(self) -> None:
        bench = Workbench()
        off = [w for m in MOTOR_BITS for w in latch(m | MOTZERO)]
        assert bench.writes() == off
        bench.run(steady(3))
        bench.core.close()
        assert bench.writes()[-len(off) :] == off

    def test_every_movement_is_followed_by_a_reading(self) -> None:
        bench = Workbench()
        bench.run(steady(1))
        mark = bench.mark()
        bench.run(steady(5, 5, 5))
        registers = [a.register for a in bench.accesses(mark)]
        one = [DATA, CONTROL, CONTROL, STATUS]
        assert registers == [STATUS] * 3 + one * 15

    def test_the_leader_comes_first_then_motor_order(self) -> None:
        bench = Workbench()
        bench.run(steady(1))
        mark = bench.mark()
        bench.run(steady(3, 3, 4))
        motors = [byte >> 6 for byte in bench.data_writes(mark)]
        assert motors[:3] == [2, 0, 1]
        assert motors.count(2) == 4
        assert motors.count(0) == motors.count(1) == 3

    def test_control_register_is_never_all_ones(self) -> None:
        for wiring in ("smc", "x4step", "paper"):
            bench = Workbench(wiring, outputs=True)
            bench.core.set_outputs(0xFF, 0xFF)
            bench.run(line(300, -200, 100), dwell(3, 0.02), steady(-3, 4, 5))
            bench.core.idle(IdleLevel.HOLD)
            bench.core.close()
            written = {value for register, value in bench.writes() if register == CONTROL}
            assert all(0 <= value <= 0x0F for value in written)


class TestX4Step:
    def test_bytes_of_a_step_forwards_and_one_back(self) -> None:
        bench = Workbench("x4step")
        mark = bench.mark()
        bench.run(steady(2), steady(-1))
        assert bench.data_writes(mark) == [0x01, 0x03, 0x01, 0x03, 0x01, 0x00, 0x02, 0x00]

    def test_motors_share_a_byte(self) -> None:
        bench = Workbench("x4step")
        mark = bench.mark()
        bench.run(steady(1, -1, 1))
        assert bench.data_writes(mark) == [0x11, 0x3B, 0x11]

    def test_direction_comes_at_least_100_us_before_the_edge(self) -> None:
        bench = Workbench("x4step", limits=TIRELESS)
        mark = bench.mark()
        bench.run(
            steady(3, rate_hz=20_000, jump_hz=20_000),
            steady(-3, rate_hz=20_000, jump_hz=20_000),
            steady(3, rate_hz=9_000, jump_hz=20_000),
        )
        data = [a for a in bench.accesses(mark) if a.register == DATA]
        gaps_ns = [
            later.at_ns - earlier.at_ns
            for earlier, later in itertools.pairwise(data)
            if later.value & 2 and not earlier.value & 2
        ]
        turned = [gaps_ns[0], gaps_ns[3], gaps_ns[6]]
        assert turned == [100_000, 100_000, 100_000]

    def test_at_20_khz_the_clock_is_high_and_low_for_25_us(self) -> None:
        bench = Workbench("x4step", limits=TIRELESS)
        bench.run(steady(50, 20, rate_hz=20_000, jump_hz=20_000))
        for motor, pulses in ((0, 50), (1, 20)):
            rising, falling = bench.edges_ns(motor)
            assert len(rising) == len(falling) == pulses
            assert {f - r for r, f in zip(rising, falling, strict=True)} == {HALF_CLOCK_NS}
        rising, falling = bench.edges_ns(0)
        assert {r - f for f, r in zip(falling, rising[1:], strict=False)} == {HALF_CLOCK_NS}

    def test_a_plan_above_20_khz_is_slowed_to_it(self) -> None:
        bench = Workbench("x4step", limits=TIRELESS)
        bench.run(steady(50, rate_hz=40_000, jump_hz=40_000))
        rising, _ = bench.edges_ns(0)
        assert {b - a for a, b in itertools.pairwise(rising)} == {2 * HALF_CLOCK_NS}

    def test_below_that_high_and_low_are_equally_long(self) -> None:
        bench = Workbench("x4step")
        bench.run(steady(10, rate_hz=1000))
        rising, falling = bench.edges_ns(0)
        assert {f - r for r, f in zip(rising, falling, strict=True)} == {500_000}

    def test_paper_pulses_at_133_khz(self) -> None:
        bench = Workbench("paper", limits=TIRELESS)
        bench.run(steady(50, rate_hz=133_333, jump_hz=200_000))
        rising, falling = bench.edges_ns(0)
        assert min(f - r for r, f in zip(rising, falling, strict=True)) >= 500
        assert min(r - f for f, r in zip(falling, rising[1:], strict=False)) >= 500


class TestActiveAndBoost:
    """Pin 17 is the inverse of bit 3; pin 16 is bit 2 itself. Pins 1 and 14 stay low: bits 1."""

    OFF, ON, BOOST = 0b1011, 0b0011, 0b0111

    def control(self, bench: Workbench, mark: int) -> list[int]:
        return [value for register, value in bench.writes(mark) if register == CONTROL]

    def test_boost_in_both_ramps(self) -> None:
        bench = Workbench("x4step")
        mark = bench.mark()
        bench.run(line(2000))
        assert self.control(bench, mark) == [self.BOOST, self.ON, self.BOOST, self.OFF]

    def test_boost_while_braking_and_while_taking_up_speed_again(self) -> None:
        bench = Workbench("x4step")
        bench.run_until_tick(1000, line(4000))
        mark = bench.mark()
        bench.core.brake()
        assert bench.run().held
        assert self.control(bench, mark) == [self.BOOST, self.OFF]
        mark = bench.mark()
        bench.core.resume()
        bench.run()
        assert self.control(bench, mark) == [self.BOOST, self.ON, self.BOOST, self.OFF]

    def test_all_low_after_close(self) -> None:
        bench = Workbench("x4step", outputs=True)
        bench.core.set_outputs(0b11, 0b11)
        bench.run_until_tick(100, line(2000))
        bench.core.close()
        assert [v for r, v in bench.writes() if r == CONTROL][-1] == self.OFF


@pytest.mark.parametrize("wiring", ["x4step", "paper"])
@pytest.mark.parametrize("tick", [1, 2, 7])
def test_the_falling_edge_is_written_also_after_a_stop(wiring: str, tick: int) -> None:
    bench = Workbench(wiring)
    bench.run_until_tick(tick, steady(100))
    bench.core.stop()
    bench.run()
    rising, falling = bench.edges_ns(0)
    assert len(rising) == len(falling) == tick
    assert falling[-1] - rising[-1] == 500_000


class TestLateEdges:
    """The owner of the clock is away for a while now and then: nothing is made up for."""

    def test_a_late_tick_moves_everything_after_it(self) -> None:
        clock = BusyClock(lambda wait: 3_000_000 if wait == 20 else 0)
        bench = Workbench("x4step", clock=clock, settle_s=0)
        report = bench.run(steady(40, rate_hz=1000))
        assert report.late_ticks == 1
        rising, falling = bench.edges_ns(0)
        gaps_ns = [b - a for a, b in itertools.pairwise(rising)]
        assert min(gaps_ns) == 1_000_000
        assert min(f - r for r, f in zip(rising, falling, strict=True)) == 500_000

    @pytest.mark.parametrize("late_wait", range(20, 24))
    def test_pulses_and_pauses_are_never_cut_short(self, late_wait: int) -> None:
        clock = BusyClock(lambda wait: 1_000_000 if wait == late_wait else 0)
        bench = Workbench("x4step", clock=clock, limits=TIRELESS)
        bench.run(steady(50, rate_hz=20_000, jump_hz=20_000))
        rising, falling = bench.edges_ns(0)
        assert min(f - r for r, f in zip(rising, falling, strict=True)) >= HALF_CLOCK_NS
        assert min(r - f for f, r in zip(falling, rising[1:], strict=False)) >= HALF_CLOCK_NS

    def test_a_little_late_is_not_late(self) -> None:
        bench = Workbench(clock=BusyClock(lambda wait: 200_000 * (wait == 50)), settle_s=0)
        report = bench.run(steady(100, rate_hz=1000))
        assert report.late_ticks == 0
        assert bench.clock.now_ns() == 100_000_000 + 200_000 - 62_500

    def test_an_interruption_between_clock_and_write_is_a_late_tick_too(self) -> None:
        """The last moment at which one can come: the byte is on the pins, its strobe is not."""
        clock = BusyClock(lambda wait: 1)
        bench = Workbench(clock=clock, settle_s=0, limits=TIRELESS)
        write_data, count = bench.simulated.write_data, itertools.count()

        def interrupted(value: int) -> None:
            write_data(value)
            if next(count) == 30:
                VirtualClock.wait_until(clock, clock.now_ns() + 700_000)

        bench.simulated.write_data = interrupted
        report = bench.run(steady(60, rate_hz=1000))
        edges_ns = [a.at_ns for a in bench.accesses() if a.register == CONTROL and a.value & 1]
        gaps_ns = [b - a for a, b in itertools.pairwise(edges_ns[-60:])]
        assert report.late_ticks == 1
        assert max(gaps_ns) > 1_699_000
        assert min(gaps_ns) > 937_000

    @given(st.lists(st.floats(0, 3), min_size=1, max_size=30))
    def test_no_interval_is_shortened_by_more_than_a_sixteenth(self, late: list[float]) -> None:
        """However late the ticks before it came; and what was very late is counted."""
        interval_ns = 1_000_000

        def late_ns(wait: int) -> int:
            return round(late[wait % len(late)] * interval_ns) if wait > 1 else 0

        bench = Workbench(clock=BusyClock(late_ns), settle_s=0, limits=TIRELESS)
        report = bench.run(steady(60, rate_hz=1000))
        edges_ns = [a.at_ns for a in bench.accesses() if a.register == CONTROL and a.value & 1]
        gaps_ns = [b - a for a, b in itertools.pairwise(edges_ns[-60:])]
        assert min(gaps_ns) >= interval_ns * 15 // 16
        assert report.position_steps == (60, 0, 0)
        assert report.late_ticks == sum(late_ns(wait) > 250_000 for wait in range(1, 61))
