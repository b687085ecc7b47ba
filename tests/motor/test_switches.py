"""End switches: one input, names by inference, contacts by counting readings."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Watch, WatchAction, dwell
from fraese.motor.seams import DATA, End, Ended, SwitchMode
from fraese.motor.switches import Debounced
from tests.motor.workbench import (
    AXES,
    EVERY_END,
    MAX_HZ,
    TRAVEL_STEPS,
    Workbench,
    ends,
    line,
    steady,
)

CLOSED = Watch(0x80, 0x00, WatchAction.STOP)
OPEN = Watch(0x80, 0x80, WatchAction.IGNORE)


def near(axis: str, sign: int, steps: int = 20, **settings: object) -> Workbench:
    """A bench with one carriage so many steps before its switch."""
    bench = Workbench(**settings)  # type: ignore[arg-type]
    return bench.place(axis, TRAVEL_STEPS - steps if sign > 0 else steps)


def alone(axis: str, steps: int) -> tuple[int, ...]:
    return tuple(steps if a == axis else 0 for a in AXES)


class TestOneMotor:
    @pytest.mark.parametrize("readings", [1, 3])
    @pytest.mark.parametrize("axis", AXES)
    @pytest.mark.parametrize("sign", [-1, 1])
    def test_named_from_motor_and_direction(self, axis: str, sign: int, readings: int) -> None:
        bench = near(axis, sign, readings=readings)
        report = bench.run(steady(*alone(axis, sign * 100)))
        assert report.ended is Ended.SWITCH
        assert report.candidates == {End(AXES.index(axis), sign)}
        assert report.switch_closed
        assert abs(bench.carriage(axis)) == 20 + readings - 1
        assert report.position_steps == bench.carriages()

    def test_the_name_stays_until_the_input_opens(self) -> None:
        bench = near("x", 1)
        bench.run(steady(100))
        bench.wait()
        assert bench.report().candidates == ends("x+")
        report = bench.run(steady(-1, watch=OPEN))
        assert report.candidates == ends("x+")
        report = bench.run(steady(-10, watch=OPEN))
        assert not report.switch_closed
        assert report.candidates == frozenset()

    def test_the_tick_in_hand_is_finished_and_nothing_after_it(self) -> None:
        bench = near("x", 1, readings=1)
        bench.run(steady(-1), steady(1))
        bench.wait()
        mark = bench.mark()
        report = bench.run(steady(100, 100, 100))
        motors = [byte >> 6 for byte in bench.data_writes(mark)]
        assert motors == [0, 1, 2] * 20
        assert report.position_steps == (20, 20, 20)
        assert len(bench.port.accesses) > mark
        assert [a for a in bench.accesses(mark) if a.register == DATA][-1].value >> 6 == 2

    def test_the_rest_of_the_queue_is_dropped(self) -> None:
        bench = near("x", 1)
        report = bench.run(steady(100), steady(0, 50), dwell(3, 1))
        assert (report.queued, report.playing) == (0, 3)
        assert report.position_steps[1] == 0

    def test_above_the_start_stop_rate_the_axis_is_torn(self) -> None:
        bench = near("x", 1, steps=1000)
        report = bench.run(line(3000))
        assert report.torn == {0}
        assert near("x", 1, steps=1000).run(steady(3000)).torn == frozenset()


class TestSeveralMotors:
    def test_all_that_move_are_candidates(self) -> None:
        bench = near("y", -1)
        report = bench.run(steady(100, -100))
        assert report.candidates == ends("x+", "y-")

    def test_a_block_that_ended_just_before_counts(self) -> None:
        bench = near("x", 1, steps=10, lag_s=0.004)
        report = bench.run(steady(10), steady(0, -100))
        assert report.candidates == ends("x+", "y-")
        assert report.ended is Ended.SWITCH

    def test_after_20_ms_it_counts_no_more(self) -> None:
        bench = near("y", -1, steps=30)
        report = bench.run(steady(10), steady(0, -100))
        assert report.candidates == ends("y-")

    def test_a_reversal_keeps_both_ends_for_that_long(self) -> None:
        bench = near("x", 1, steps=10, lag_s=0.004)
        report = bench.run(steady(10), steady(-100))
        assert report.candidates == ends("x+", "x-")


class TestStandstill:
    def test_closed_at_start_may_be_any(self) -> None:
        bench = Workbench()
        bench.simulated.press(End(1, 1))
        report = bench.run(steady(10))
        assert report.candidates == EVERY_END
        assert report.ended is Ended.SWITCH
        assert report.position_steps == (0, 0, 0)

    def test_read_at_every_poll(self) -> None:
        bench = Workbench()
        bench.simulated.press(End(2, -1))
        states = [bench.report().switch_closed for _ in range(4)]
        assert states == [False, False, True, True]
        assert bench.report().candidates == EVERY_END
        bench.simulated.let_go(End(2, -1))
        states = [bench.report().switch_closed for _ in range(4)]
        assert states == [True, True, False, False]

    def test_polarity_and_other_inputs_do_not_matter_to_it(self) -> None:
        bench = Workbench()
        bench.simulated.inputs = 0x80
        report = bench.run(steady(10))
        assert (report.switch_closed, report.inputs) == (False, 0x80)


class TestModes:
    def test_ignored_it_is_still_shown(self) -> None:
        bench = near("x", 1).ignore_switches()
        report = bench.run(steady(100))
        assert report.ended is Ended.TARGET
        assert report.candidates == ends("x+")
        assert bench.carriage("x") == 100

    def test_switched_back_it_stops_the_next_block(self) -> None:
        bench = near("x", 1).ignore_switches()
        bench.run(steady(100))
        bench.core.set_switch_mode(SwitchMode.STOP)
        assert bench.run(steady(-10)).ended is Ended.SWITCH
        assert bench.carriage("x") == 100


class TestBounce:
    @pytest.mark.parametrize("bounce", range(4))
    @pytest.mark.parametrize("lag_s", [0.0, 0.003])
    def test_neither_missed_nor_doubled(self, bounce: int, lag_s: float) -> None:
        bench = near("x", 1, bounce_readings=bounce, lag_s=lag_s).ignore_switches()
        changes, before = 0, False
        bench.push(steady(60), steady(-120), steady(60))
        report = bench.core.poll(0.001)
        while report.running:
            changes += report.switch_closed is not before
            before = report.switch_closed
            report = bench.core.poll(0.001)
        assert changes == 2

    @given(st.lists(st.booleans(), max_size=60), st.integers(1, 5))
    def test_k_equal_readings_and_the_count_of_the_first(
        self, closed: list[bool], readings: int
    ) -> None:
        debounced = Debounced(0x80, 0, readings)
        state, run, first = False, 0, 0
        for index, reading in enumerate(closed):
            if reading == state:
                run = 0
            else:
                first = first if run else index
                run += 1
            changed = run == readings
            if changed:
                state, run = not state, 0
            took = debounced.take(0 if reading else 0x80, lambda at=index: (at,))  # type: ignore[misc]
            assert (took, debounced.is_true) == (changed, state)
            if changed:
                assert debounced.latched_steps == ((first,) if state else None)


class TestWatch:
    def test_stop_latches_the_first_reading(self) -> None:
        bench = near("x", 1)
        report = bench.run(steady(100, watch=CLOSED), steady(0, 10))
        assert report.ended is Ended.WATCH
        assert report.latched_steps == (20, 0, 0)
        assert report.position_steps == (22, 0, 0)
        assert report.candidates == ends("x+")
        assert report.queued == 0

    def test_above_the_start_stop_rate_it_brakes_and_tears_nothing(self) -> None:
        bench = near("x", 1, steps=1000)
        report = bench.run(line(3000, watch=CLOSED))
        assert report.ended is Ended.WATCH
        assert report.torn == frozenset()
        assert report.latched_steps == (1000, 0, 0)
        assert 1250 < report.position_steps[0] < 1350
        assert bench.wait().lost() == (0, 0, 0)
        assert not report.held

    def test_braking_may_go_on_into_the_next_block(self) -> None:
        bench = near("x", 1, steps=1000)
        report = bench.run(
            line(1100, exit_hz=MAX_HZ, watch=CLOSED), line(1000, entry_hz=MAX_HZ), line(100)
        )
        assert report.ended is Ended.WATCH
        assert report.torn == frozenset()
        assert report.latched_steps == (1000, 0, 0)
        assert 1250 < report.position_steps[0] < 1350
        assert report.queued == 0

    def test_resume_does_not_undo_a_watch(self) -> None:
        bench = near("x", 1, steps=1000)
        bench.run_until_tick(1010, line(3000, watch=CLOSED))
        bench.core.resume()
        report = bench.run()
        assert report.ended is Ended.WATCH
        assert report.position_steps[0] < 1350

    def test_brake_holds_and_keeps_the_queue(self) -> None:
        bench = near("x", 1, steps=1000)
        report = bench.run(line(1500, watch=CLOSED._replace(action=WatchAction.BRAKE)))
        assert report.held
        assert report.queued == 1
        assert report.latched_steps == (1000, 0, 0)
        bench.core.resume()
        report = bench.run()
        assert report.ended is Ended.TARGET
        assert report.position_steps[0] == 1500

    def test_backing_off_ignores_the_switch_until_it_opens(self) -> None:
        bench = near("x", 1)
        bench.run(steady(100))
        report = bench.run(steady(-200, watch=OPEN))
        assert report.ended is Ended.TARGET
        assert report.latched_steps == (19, 0, 0)
        assert not report.switch_closed

    def test_and_stops_for_another_one_after_that(self) -> None:
        bench = Workbench(travel_steps=100)
        bench.run(steady(100))
        report = bench.run(steady(-200, watch=OPEN))
        assert report.ended is Ended.SWITCH
        assert report.candidates == ends("x-")

    def test_another_input(self) -> None:
        bench = Workbench()
        probe = Watch(0x20, 0x00, WatchAction.STOP)
        bench.run_until_tick(50, steady(100, watch=probe))
        bench.simulated.inputs &= ~0x20
        report = bench.run()
        assert report.ended is Ended.WATCH
        assert report.latched_steps == (report.position_steps[0] - 2, 0, 0)
        assert not report.switch_closed

    def test_the_end_switch_still_counts_while_another_input_is_watched(self) -> None:
        bench = near("x", 1)
        report = bench.run(steady(100, watch=Watch(0x20, 0x00, WatchAction.STOP)))
        assert report.ended is Ended.SWITCH
        assert report.latched_steps is None

    def test_fulfilled_from_the_start(self) -> None:
        bench = Workbench()
        bench.simulated.press(End(0, 1))
        report = bench.run(steady(100, watch=CLOSED))
        assert report.ended is Ended.WATCH
        assert report.position_steps == (3, 0, 0)
        assert report.latched_steps == (1, 0, 0)

    def test_over_with_its_block(self) -> None:
        bench = near("x", 1, steps=100)
        bench.run(steady(50, watch=CLOSED))
        bench.simulated.press(End(0, 1))
        for _ in range(5):
            report = bench.report()
        assert report.ended is Ended.TARGET
        assert report.latched_steps is None

    def test_in_the_middle_of_a_tick_only_motors_before_the_reading_count(self) -> None:
        bench = near("z", 1, readings=1)
        report = bench.run(steady(30, 30, 30, watch=CLOSED))
        assert report.latched_steps == (20, 20, 20)
        bench = near("x", 1, readings=1)
        report = bench.run(steady(30, 30, 30, watch=CLOSED))
        assert report.latched_steps == (20, 19, 19)
        assert report.position_steps == (20, 20, 20)
