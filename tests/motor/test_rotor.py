"""What a rotor can follow, and what it cannot."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Piece, accel_q_from_hz_s
from fraese.motor.mill import Mill, Slide
from fraese.motor.phases import MOTRUN
from fraese.motor.rotor import Hindrance, RotorLimits
from fraese.motor.seams import End, IdleLevel, Report
from fraese.planner.ramps import mirrored, trapezoid
from tests.motor.workbench import (
    ACCELERATION_HZ_S,
    TRAVEL_STEPS,
    Workbench,
    line,
    steady,
)

LIMITS = RotorLimits(max_rate_hz=6000, jump_hz=1200, acceleration_hz_s=60_000)


def fast(*steps: int, rate_hz: float) -> Workbench:
    """A bench whose X starts and stops dead at a rate, after some time has passed."""
    bench = Workbench(limits=LIMITS)
    bench.run(steady(*steps, rate_hz=rate_hz, jump_hz=rate_hz))
    return bench.wait()


def balance(bench: Workbench, report: Report) -> None:
    """Rule: where the carriage is, and what the mill says is lost, add up to what was asked."""
    found = tuple(c + n for c, n in zip(bench.carriages(), bench.lost(), strict=True))
    assert found == report.position_steps


class TestFollows:
    @given(
        ticks=st.integers(1, 3000),
        cruise_hz=st.floats(1200, 5900),
        start_hz=st.floats(100, 1190),
        acceleration_hz_s=st.floats(5000, 59_000),
        back=st.integers(0, 40),
    )
    def test_any_trapezoid_within_its_limits(
        self, ticks: int, cruise_hz: float, start_hz: float, acceleration_hz_s: float, back: int
    ) -> None:
        bench = Workbench(limits=LIMITS)
        law = tuple(trapezoid(ticks, start_hz, cruise_hz, start_hz, acceleration_hz_s))
        block = line(ticks)._replace(pieces=law, accel_q=accel_q_from_hz_s(acceleration_hz_s))
        report = bench.run(*[steady(-back, rate_hz=start_hz)] * bool(back), block)
        assert bench.wait().lost() == (0, 0, 0)
        assert bench.carriage("x") == report.position_steps[0]

    @pytest.mark.parametrize("ticks", range(20, 60))
    def test_braking_at_its_limit_is_no_dead_stop(self, ticks: int) -> None:
        bench = Workbench(limits=LIMITS)
        law = tuple(trapezoid(ticks, 1190, 5900, 1190, 59_900))
        bench.run(line(ticks)._replace(pieces=law))
        assert bench.wait().lost() == (0, 0, 0)

    @pytest.mark.parametrize("minor", [*range(1, 40), *range(40, 400, 23), 499, 500, 501, 999])
    def test_uneven_beats_of_minor_axes(self, minor: int) -> None:
        bench = Workbench(limits=LIMITS)
        report = bench.run(line(1000, minor, -(1000 - minor), rate_hz=5900))
        assert bench.wait().lost() == (0, 0, 0)
        assert bench.carriages() == report.position_steps

    def test_slow_steps_at_any_rate(self) -> None:
        for rate_hz in (0.5, 10, 299, 300, 301, 1199):
            assert fast(40, rate_hz=rate_hz).lost() == (0, 0, 0)

    def test_reversing_at_the_start_stop_rate(self) -> None:
        for ahead in range(1, 20):
            bench = Workbench(limits=LIMITS)
            bench.run(*[steady(ahead, rate_hz=1190), steady(-9, rate_hz=1190)] * 4)
            assert bench.wait().lost() == (0, 0, 0)

    @pytest.mark.parametrize("ticks", range(996, 1008))
    def test_turning_round_between_ramps_at_its_limits(self, ticks: int) -> None:
        bench = Workbench(limits=RotorLimits(2600, 330, 24_000))
        out = trapezoid(ticks, 280, 2500, 280, 20_000)
        blocks = [
            line(steps)._replace(pieces=tuple(law), accel_q=accel_q_from_hz_s(20_000))
            for steps, law in ((ticks, out), (-ticks, mirrored(out)))
        ]
        bench.run(*blocks)
        assert bench.wait().lost() == (0, 0, 0)


class TestResonates:
    LIMITS = RotorLimits(6000, 1200, 60_000, resonances_hz=((900, 1100), (2900, 3100)))

    @pytest.mark.parametrize(
        ("rate_hz", "follows"),
        [(800, True), (890, True), (950, False), (1050, False), (1150, True)],
    )
    def test_it_cannot_stay_within_a_band(self, rate_hz: float, follows: bool) -> None:
        bench = Workbench(limits=self.LIMITS)
        report = bench.run(steady(400, rate_hz=rate_hz))
        assert (bench.wait().lost()[0] == 0) == follows
        assert bench.lost()[0] % 8 == 0, "whole electrical turns"
        found = Hindrance.RESONANCE if not follows else None
        assert bench.mill.rotors[0].hindrance is found
        balance(bench, report)

    def test_it_may_be_there_for_a_moment(self) -> None:
        bench = Workbench(limits=self.LIMITS)
        for _ in range(3):
            bench.run(steady(40, rate_hz=1000), steady(40, rate_hz=800))
        assert bench.wait().lost() == (0, 0, 0)

    def test_a_ramp_passes_through(self) -> None:
        bench = Workbench(limits=self.LIMITS)
        law = tuple(trapezoid(3000, 800, 4000, 800, 20_000))
        bench.run(line(3000)._replace(pieces=law, accel_q=accel_q_from_hz_s(20_000)))
        assert bench.wait().lost() == (0, 0, 0)


class TestLoses:
    def test_above_its_highest_rate_it_hums(self) -> None:
        bench = Workbench(limits=LIMITS)
        report = bench.run(line(3000, rate_hz=7500))
        assert bench.wait().carriage("x") < 1000
        balance(bench, report)

    @pytest.mark.parametrize("rate_hz", [1700, 2500, 5000])
    def test_started_above_the_start_stop_rate(self, rate_hz: float) -> None:
        bench = Workbench(limits=LIMITS)
        report = bench.run(steady(400, rate_hz=rate_hz, jump_hz=rate_hz))
        assert bench.wait().carriage("x") < 200
        balance(bench, report)

    @pytest.mark.parametrize("rate_hz", [2000, 3500, 5000])
    @pytest.mark.parametrize("steps", range(600, 608))
    @pytest.mark.parametrize("released", [False, True])
    def test_stopped_dead_it_runs_on(self, rate_hz: float, steps: int, released: bool) -> None:
        bench = Workbench(limits=LIMITS)
        law = trapezoid(steps, 1000, rate_hz, rate_hz, ACCELERATION_HZ_S)
        report = bench.run(line(steps)._replace(pieces=tuple(law), ends_at_rest=True))
        if released:
            bench.core.idle(IdleLevel.OFF)
        assert bench.wait().carriage("x") == steps + 8
        assert bench.lost() == (-8, 0, 0)
        assert report.torn == {0}
        balance(bench, report)

    def test_too_steep(self) -> None:
        bench = Workbench(limits=LIMITS)
        law = (*trapezoid(500, 1000, 1000, 1000, 1), Piece(500, 16_000_000 * 256 // 4000))
        report = bench.run(line(1000)._replace(pieces=law))
        assert bench.wait().carriage("x") < 700
        balance(bench, report)

    def test_slow_enough_it_catches_the_field_again(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.run(steady(200, rate_hz=3000, jump_hz=3000), steady(200, rate_hz=600))
        lost = bench.wait().lost()[0]
        assert lost > 0
        assert lost % 8 == 0
        before = bench.carriage("x")
        report = bench.run(line(500))
        assert bench.carriage("x") == before + 500
        balance(bench, report)

    def test_a_blocked_carriage(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.mill.block(0)
        report = bench.run(line(1000))
        assert bench.wait().carriage("x") == 0
        balance(bench, report)
        bench.mill.block(0, False)
        report = bench.run(line(-100))
        assert bench.lost()[0] % 8 == 0
        balance(bench, report)

    def test_let_go_at_speed_it_stays_behind_until_the_end(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.mill.block(0)
        bench.run_until_tick(900, line(3000))
        bench.mill.block(0, False)
        bench.run_until_tick(2500)
        assert abs(bench.carriage("x")) < 8
        balance(bench, bench.run())

    def test_a_touch_of_a_few_steps_loses_nothing(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.mill.block(0)
        bench.run(steady(3))
        bench.mill.block(0, False)
        report = bench.run(steady(-3), steady(10))
        assert bench.wait().lost() == (0, 0, 0)
        balance(bench, report)

    def test_at_the_mechanical_end(self) -> None:
        bench = Workbench(limits=LIMITS).ignore_switches().place("x", TRAVEL_STEPS - 100)
        report = bench.run(line(1000))
        assert bench.wait().carriage("x") <= 100 + 400
        balance(bench, report)

    @pytest.mark.parametrize("wiring", ["smc", "x4step"])
    @pytest.mark.parametrize("steps", [1, 3, 4, 16, 301])
    def test_without_power_all_is_lost(self, wiring: str, steps: int) -> None:
        bench = Workbench(wiring)
        bench.run(steady(5))
        bench.electronics.cut_power()
        report = bench.run(steady(steps))
        assert bench.carriage("x") == 5
        assert bench.lost() == (steps, 0, 0)
        assert bench.simulated.look().currents[0] == (0, 0)
        bench.electronics.restore_power()
        balance(bench, bench.run(steady(2)))
        assert abs(bench.carriage("x") - 7) <= 4
        balance(bench, bench.report())
        assert report.position_steps[0] == 5 + steps


class TestSaysWhy:
    """What first kept a rotor from following, and when that is forgotten."""

    @pytest.mark.parametrize(
        ("rate_hz", "why"),
        [(1700, Hindrance.TOO_STEEP), (5000, Hindrance.TOO_STEEP), (9000, Hindrance.TOO_FAST)],
    )
    def test_started_dead(self, rate_hz: float, why: Hindrance) -> None:
        assert fast(400, rate_hz=rate_hz).mill.rotors[0].hindrance is why

    def test_too_fast_in_the_end(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.run(line(3000, rate_hz=7500))
        assert bench.mill.rotors[0].hindrance is Hindrance.TOO_FAST

    def test_stopped_dead(self) -> None:
        bench = Workbench(limits=LIMITS)
        law = trapezoid(600, 1000, 4000, 4000, ACCELERATION_HZ_S)
        bench.run(line(600)._replace(pieces=tuple(law), ends_at_rest=True))
        assert bench.mill.rotors[0].hindrance is None
        bench.mill.rotors[0].rest()
        assert bench.mill.rotors[0].hindrance is Hindrance.STOPPED_DEAD

    def test_blocked_is_what_it_was_although_it_is_too_fast_to_catch(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.mill.block(0)
        bench.run_until_tick(900, line(3000))
        bench.mill.block(0, False)
        bench.run()
        assert bench.mill.rotors[0].hindrance is Hindrance.BLOCKED

    def test_at_the_end_and_without_current(self) -> None:
        bench = Workbench(limits=LIMITS).ignore_switches().place("x", TRAVEL_STEPS - 100)
        bench.electronics.cut_power()
        bench.run(line(1000, 30))
        assert bench.mill.rotors[0].hindrance is Hindrance.NO_CURRENT
        bench = Workbench(limits=LIMITS).ignore_switches().place("x", TRAVEL_STEPS - 100)
        bench.run(line(1000, 30))
        assert [rotor.hindrance for rotor in bench.mill.rotors] == [Hindrance.AT_END, None, None]

    def test_a_touch_that_lost_nothing_is_forgotten(self) -> None:
        bench = Workbench(limits=LIMITS)
        bench.mill.block(0)
        bench.run(steady(3))
        assert bench.mill.rotors[0].hindrance is Hindrance.BLOCKED
        bench.mill.block(0, False)
        bench.run(steady(-3), steady(10))
        assert bench.mill.rotors[0].hindrance is None

    def test_what_was_told_is_not_told_again(self) -> None:
        rotor = fast(400, rate_hz=5000).mill.rotors[0]
        lost_steps = rotor.lost_steps
        assert rotor.missed_steps == lost_steps > 0
        rotor.forget()
        assert rotor.missed_steps == 0
        assert rotor.hindrance is None
        # What is lost stays lost: the field's phase needs it.
        assert rotor.lost_steps == lost_steps


class TestRegisterJumps:
    """The phase index jumps: straight on the wire, no core in between."""

    def strobe(self, bench: Workbench, byte: int) -> None:
        bench.wait(0.01)
        bench.simulated.write_data(byte)
        bench.simulated.write_control(1)
        bench.simulated.write_control(0)

    @pytest.mark.parametrize(
        ("jump", "moves"), [(1, 1), (2, 2), (3, 3), (4, 0), (5, -3), (6, -2), (7, -1)]
    )
    def test_the_rotor_goes_the_short_way_or_not_at_all(self, jump: int, moves: int) -> None:
        bench = Workbench()
        self.strobe(bench, MOTRUN[0])
        self.strobe(bench, MOTRUN[jump])
        assert bench.carriage("x") == moves
        if jump == 4:
            assert abs(bench.lost()[0]) == 4

    def test_data_without_a_strobe_moves_nothing(self) -> None:
        bench = Workbench()
        self.strobe(bench, MOTRUN[0])
        for byte in MOTRUN:
            bench.simulated.write_data(byte)
        assert bench.carriage("x") == 0

    def test_holding_the_strobe_latches_once(self) -> None:
        bench = Workbench()
        self.strobe(bench, MOTRUN[0])
        bench.simulated.write_control(1)
        bench.simulated.write_data(MOTRUN[1])
        bench.simulated.write_control(1)
        assert bench.carriage("x") == 0

    def test_a_fourth_motor_is_not_there(self) -> None:
        bench = Workbench()
        self.strobe(bench, 0xC0 | MOTRUN[1])
        assert bench.carriages() == (0, 0, 0)

    def test_currents_as_a_clamp_meter_shows_them(self) -> None:
        bench = Workbench()
        self.strobe(bench, MOTRUN[2])
        self.strobe(bench, 0x40 | MOTRUN[7])
        assert bench.simulated.look().currents == ((100, 0), (-60, 60), (0, 0))


class TestUnpowered:
    @pytest.mark.parametrize("steps", range(1, 9))
    def test_friction_holds_it(self, steps: int) -> None:
        bench = Workbench()
        bench.run(steady(steps))
        bench.core.idle(IdleLevel.OFF)
        assert bench.wait().carriage("x") == steps

    @pytest.mark.parametrize("steps", range(1, 9))
    def test_or_it_snaps_to_a_pole_and_comes_back(self, steps: int) -> None:
        bench = Workbench(limits=RotorLimits(snaps_to_pole=True))
        report = bench.run(steady(steps))
        bench.core.idle(IdleLevel.OFF)
        assert bench.wait().carriage("x") in (steps, steps - 1)
        assert bench.carriage("x") % 2 == 0
        balance(bench, report)
        report = bench.run(steady(1))
        assert bench.wait().carriage("x") == steps + 1
        assert bench.lost() == (0, 0, 0)


class TestSwitchesOfTheMill:
    def test_pressed_at_its_end_and_free_again(self) -> None:
        bench = Workbench().ignore_switches().place("x", 50)
        bench.run(line(-60))
        assert bench.simulated.look().pressed == (End(0, -1),)
        bench.run(line(20))
        assert bench.simulated.look().pressed == ()

    def test_two_in_a_corner(self) -> None:
        bench = Workbench().ignore_switches().place("x", 5).place("z", TRAVEL_STEPS - 5)
        bench.run(steady(-10, 0, 10))
        assert bench.simulated.look().pressed == (End(0, -1), End(2, 1))
        bench.run(steady(10))
        assert bench.simulated.look().pressed == (End(2, 1),)
        assert bench.report().switch_closed

    def test_by_hand(self) -> None:
        bench = Workbench()
        bench.simulated.press(End(1, 1))
        assert bench.simulated.look().pressed == (End(1, 1),)
        assert not bench.simulated.read_status() & 0x80
        bench.simulated.let_go(End(1, 1))
        assert bench.simulated.read_status() & 0x80

    @pytest.mark.parametrize("bounce", range(6))
    def test_bounce_ends_on_the_old_value(self, bounce: int) -> None:
        bench = Workbench(bounce_readings=bounce)
        bench.simulated.press(End(0, 1))
        closed = [not bench.simulated.read_status() & 0x80 for _ in range(bounce + 3)]
        assert closed[bounce:] == [True] * 3
        if bounce:
            assert not closed[bounce - 1]
        assert all(a != b for a, b in itertools.pairwise(closed[:bounce]))

    def test_lag(self) -> None:
        bench = Workbench(lag_s=0.005)
        bench.simulated.press(End(0, 1))
        assert bench.simulated.read_status() & 0x80
        bench.wait(0.005)
        assert not bench.simulated.read_status() & 0x80
        bench.simulated.let_go(End(0, 1))
        assert not bench.simulated.read_status() & 0x80
        bench.wait(0.005)
        assert bench.simulated.read_status() & 0x80


@pytest.mark.parametrize("wiring", ["smc", "x4step"])
def test_a_machine_is_found_as_it_was_left(wiring: str) -> None:
    left = Workbench(wiring, limits=LIMITS)
    left.run(line(333, -77), steady(30, rate_hz=5000, jump_hz=5000))
    left.core.close()
    left.wait()
    states, phases = left.simulated.states(), left.report().phases

    found = Workbench(wiring, limits=LIMITS)
    found.simulated.set_states(states)
    found.card.set_phases(phases)
    assert found.simulated.states() == states
    assert found.lost() == left.lost()
    report = found.run(line(100, 50, -25))
    moved = [a - b.position_steps for a, b in zip(
        found.simulated.look().carriages_steps, states, strict=True)]  # fmt: skip
    lost = [a - b for a, b in zip(found.lost(), left.lost(), strict=True)]
    assert tuple(m + n for m, n in zip(moved, lost, strict=True)) == report.position_steps
    assert all(math.fmod(n, 8) == 0 for n in found.lost())


def test_switches_close_not_always_at_the_same_place() -> None:
    mill = Mill([Slide(4000, scatter_steps=4), Slide(4000)])
    found = []
    for _ in range(400):
        found.append(mill.switches_steps[0][0])
        mill.place(0, -100)
        mill.place(0, 100)
    spread = np.std(found)
    assert 3.5 < spread < 4.5
    assert abs(np.mean(found)) < 0.7
    assert mill.switches_steps[1] == (0, 4000), "those of the other axis do"
