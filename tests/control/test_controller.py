"""The controller on the simulated mill: commands, limits, run loop, and what is conserved."""

import threading
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.assembly import Plant
from fraese.config.axis import LinearAxis
from fraese.control.state import Status
from fraese.errors import LimitError, PortError, SilenceAlarm, StateError, StopAlarm
from fraese.machine import Machine
from fraese.motor.seams import Ended, Report
from tests.helpers import (
    AXES,
    STEPDIR,
    ZERO_STEPS,
    after_slices,
    axes,
    carriages,
    configured,
    end,
    homed,
    look,
    merged,
    mill,
    plant,
    put,
    record,
)

CARDS = pytest.mark.parametrize("card", [{}, STEPDIR], ids=["smc1500", "stepdir"])


def position(made: Plant) -> tuple[int, ...]:
    return made.controller.state().position_steps


# --- conversions ---------------------------------------------------------------------------------


@given(
    steps_per_rev=st.integers(100, 10_000),
    pitch=st.decimals("0.1", "100", places=3),
    gear=st.tuples(st.integers(1, 99), st.integers(1, 99)),
    steps=st.integers(-(10**7), 10**7),
)
def test_any_number_of_round_trips_keeps_the_step(
    steps_per_rev: int, pitch: Any, gear: tuple[int, int], steps: int
) -> None:
    config = LinearAxis(steps_per_rev=steps_per_rev, pitch_mm=pitch, gear=f"{gear[0]}/{gear[1]}")
    assert config.steps_per_unit() == Fraction(steps_per_rev) * Fraction(*gear) / Fraction(pitch)
    machine = Machine.from_config(configured(axes={"x": config.model_dump()}))
    axis = machine.axes[0]
    at = steps
    for _ in range(20):
        at = axis.to_steps(axis.to_mm(at))
    assert at == steps


@given(st.lists(st.sampled_from([0.01, -0.01, 0.1, -0.1, 1.0, 0.005]), max_size=12))
def test_jogs_there_and_back_end_at_the_same_step(distances: list[float]) -> None:
    made = plant(axes=axes(pitch_mm="3", gear="7/5"))
    controller = made.controller
    for sign in (1, -1):
        for distance in distances:
            for _ in range(2):
                before = position(made)[0]
                steps = made.controller.machine.axes[0].to_steps(sign * distance)
                if steps:
                    controller.jog_steps("x", steps)
                    assert controller.run() is Status.OK
                    assert position(made)[0] == before + steps


# --- moves ---------------------------------------------------------------------------------------


@CARDS
def test_a_jog_moves_the_carriage_by_its_distance(card: dict[str, Any]) -> None:
    made = plant(**card)
    before = carriages(made)
    made.controller.jog("y", -1.5)
    assert made.controller.run() is Status.OK
    assert carriages(made) == (before[0], before[1] - 300, before[2])
    assert made.controller.state().position_mm == (0, -1.5, 0)
    assert look(made).lost_steps == (0, 0, 0)


@pytest.mark.parametrize("distance", [0, 50.001, -51, float("nan"), float("inf")])
def test_a_jog_is_bounded(distance: float) -> None:
    made = plant()
    before = carriages(made)
    with pytest.raises(LimitError):
        made.controller.jog("x", distance)
    assert made.controller.run() is Status.OK
    assert carriages(made) == before


@pytest.mark.parametrize("steps", [0, 10_001, -10_001])
def test_a_jog_in_steps_is_bounded_too(steps: int) -> None:
    with pytest.raises(LimitError):
        plant().controller.jog_steps("x", steps)


def test_a_jog_of_less_than_half_a_step_says_how_long_a_step_is() -> None:
    with pytest.raises(LimitError, match=r"0\.005 mm"):
        plant().controller.jog("x", 0.001)


@CARDS
@pytest.mark.parametrize("turned", [False, True])
def test_coordinates_of_every_kind(card: dict[str, Any], turned: bool) -> None:
    made = homed(**merged(card, {"axes": axes(inverted=turned)}))
    controller = made.controller

    def go(targets: dict[str, float], **how: Any) -> tuple[float, ...]:
        controller.move_to(targets, **how)
        assert controller.run() is Status.OK
        return controller.state().position_mm

    assert go({"x": 100, "y": 50}) == (100, 50, 0)
    controller.set_zero("xy")
    assert controller.state().work_mm == (0, 0, 0)
    assert go({"x": 10}) == (110, 50, 0)
    assert go({"x": 10, "z": -3}, relative=True) == (120, 50, -3)
    assert go({"x": 10}, machine_coordinates=True) == (10, 50, -3)
    assert controller.state().work_mm == (-90, 0, -3)
    assert look(made).lost_steps == (0, 0, 0)


def test_a_curve_is_worked_through_point_by_point() -> None:
    made = homed()
    controller = made.controller
    controller.run_curve([(10, 10, 0), (20, 10, -1), (20, 10, -1), (5, 5, 0)], 900)
    assert controller.run() is Status.OK
    assert controller.state().position_mm == (5, 5, 0)
    progress = controller.state().job
    assert progress is not None
    assert (progress.lines, progress.line, progress.blocks) == (4, 4, 3)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 1e300])
def test_targets_that_are_no_place_are_refused(bad: float) -> None:
    controller = homed().controller
    with pytest.raises(LimitError):
        controller.move_to({"x": bad})
    with pytest.raises(LimitError):
        controller.run_curve([(1, 1, 0), (bad, 1, 0)])
    with pytest.raises(LimitError):
        controller.drive_points("frame", [(bad, 1, 0)])
    assert controller.status is Status.OK


@pytest.mark.parametrize("feed", [0, -1, float("nan")])
def test_a_feed_is_positive(feed: float) -> None:
    controller = homed().controller
    with pytest.raises(LimitError, match="feed"):
        controller.move_to({"x": 1}, feed_mm_min=feed)
    with pytest.raises(LimitError, match="feed"):
        controller.run_curve([(1, 1, 0)], feed)


def test_the_feed_is_kept_along_the_path() -> None:
    made = homed()
    before_ns = made.clock.now_ns()
    made.controller.move_to({"x": 30, "y": 40}, feed_mm_min=600)
    assert made.controller.run() is Status.OK
    assert (made.clock.now_ns() - before_ns) / 1e9 == pytest.approx(5, abs=0.2)


# --- soft limits ---------------------------------------------------------------------------------


def test_the_limits_can_be_reached_and_not_passed() -> None:
    made = homed()
    controller = made.controller
    controller.move_to({"x": 296, "y": 196, "z": -56})
    assert controller.run() is Status.OK
    assert carriages(made) == (59_600, 39_600, 400)
    before = carriages(made)
    for name, sign in (("x", 1), ("y", 1), ("z", -1)):
        with pytest.raises(LimitError, match="outside the travel"):
            controller.jog_steps(name, sign)
    with pytest.raises(LimitError, match=r"X 296\.005 mm is outside"):
        controller.move_to({"x": 296.003})
    assert controller.run() is Status.OK
    assert carriages(made) == before


def test_what_rounds_onto_the_limit_is_inside() -> None:
    controller = homed().controller
    controller.move_to({"x": 296.0024})
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 296


def test_the_message_says_the_limits_in_work_coordinates_too() -> None:
    controller = homed().controller
    controller.set_zero("x", 100)
    with pytest.raises(LimitError, match=r"work 100\.000 to 396\.000"):
        controller.move_to({"x": 0})


def test_one_bad_point_keeps_the_whole_curve_from_starting() -> None:
    made = homed()
    before = carriages(made)
    with pytest.raises(LimitError):
        made.controller.run_curve([(10, 10, 0), (297, 10, 0)])
    assert made.controller.run() is Status.OK
    assert carriages(made) == before


def test_a_clamped_jog_stops_at_the_limit() -> None:
    controller = homed().controller
    controller.move_to({"x": 0.5})
    controller.run()
    controller.jog("x", -50, clamp=True)
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 0
    with pytest.raises(LimitError, match="stands at its soft limit"):
        controller.jog("x", -1, clamp=True)


def test_an_axis_beyond_its_limit_may_come_back_and_only_by_what_is_asked() -> None:
    made = homed()
    controller = made.controller
    controller.position.set_reference("x", -100)
    with pytest.raises(LimitError):
        controller.jog_steps("x", -1)
    controller.jog_steps("x", 20)
    assert controller.run() is Status.OK
    controller.jog_steps("x", 20, clamp=True)
    assert controller.run() is Status.OK
    assert controller.state().position_steps[0] == -60


def test_unreferenced_no_move_is_longer_than_the_travel() -> None:
    controller = plant().controller
    with pytest.raises(LimitError, match="whole travel"):
        controller.move_to({"z": 61})
    controller.move_to({"z": 20})
    assert controller.run() is Status.OK


# --- the run loop --------------------------------------------------------------------------------


def test_the_order_of_the_run_loop_is_the_original_s() -> None:
    controller = plant().controller
    called: list[str] = []
    controller.set_display(lambda: called.append("display"))
    controller.set_show_pos(lambda: called.append("show_pos"))
    controller.set_break_key(lambda: called.append("break_key"))
    controller.jog("x", 10)
    assert controller.run() is Status.OK
    slices = called[1:-1]
    assert called[0] == called[-1] == "display"
    assert slices == ["break_key", "show_pos"] * (len(slices) // 2)
    assert len(slices) > 4


def test_without_a_command_nothing_is_displayed_and_nothing_moves() -> None:
    controller = plant().controller
    called: list[str] = []
    controller.set_display(lambda: called.append("display"))
    assert controller.run() is Status.OK
    assert called == []


def test_the_display_at_the_end_sees_the_machine_at_rest() -> None:
    made = plant()
    seen: list[tuple[Status, bool]] = []
    controller = made.controller
    controller.set_display(lambda: seen.append((controller.status, controller.state().running)))
    controller.jog("x", 3)
    controller.run()
    assert seen == [(Status.RUN, False), (Status.OK, False)]
    assert all(current.a_percent == 0 for current in look(made).currents)


def test_refused_while_something_runs() -> None:
    controller = plant().controller
    refused: list[str] = []

    def try_everything() -> None:
        commands: list[Callable[[], object]] = [
            lambda: controller.jog("x", 1),
            lambda: controller.move_to({"x": 1}),
            controller.home,
            lambda: controller.set_zero("x"),
            lambda: controller.ignore_switches(True),
        ]
        for command in commands:
            with pytest.raises(StateError, match="runs"):
                command()
            refused.append("")

    controller.jog("x", 5)
    after_slices(controller, 1, try_everything)
    assert controller.run() is Status.OK
    assert len(refused) == 5
    assert controller.state().position_mm[0] == 5


# --- cancel, stop, hold --------------------------------------------------------------------------


@CARDS
@pytest.mark.parametrize("number", [1, 2, 3, 5, 8, 12, 20])
def test_cancel_at_any_slice_brakes_and_keeps_the_position(
    card: dict[str, Any], number: int
) -> None:
    made = homed(**card)
    controller = made.controller
    controller.move_to({"x": 40, "y": 20})
    after_slices(controller, number, controller.cancel)
    assert controller.run() is Status.CANCEL
    state = controller.state()
    assert "Cancelled at" in state.message
    assert state.referenced == (True, True, True)
    assert not state.held
    assert_agreement(made, ZERO_STEPS)
    controller.acknowledge()
    assert controller.status is Status.OK
    controller.move_to({"x": 1})
    after_slices(controller, -1)
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 1


def test_cancel_before_the_first_slice() -> None:
    made = plant()
    made.controller.jog("x", 5)
    made.controller.cancel()
    assert made.controller.run() is Status.CANCEL
    assert position(made) == (0, 0, 0)


def test_cancel_without_a_job_does_nothing_and_spoils_nothing() -> None:
    made = plant()
    for what in (made.controller.cancel, made.controller.stop, made.controller.hold):
        what()
        made.controller.idle(0.05)
        assert not made.controller.state().held
    made.controller.jog("x", 5)
    assert made.controller.run() is Status.OK
    assert position(made) == (1000, 0, 0)


def test_cancel_wins_over_resume_in_whatever_order() -> None:
    for order in ("cancel resume", "resume cancel", "hold cancel resume"):
        controller = plant().controller
        controller.jog("x", 50)
        actions = [getattr(controller, name) for name in order.split()]
        slices = after_slices(controller, 3, *actions)
        assert controller.run() is Status.CANCEL, order
        assert controller.state().position_mm[0] < 10
        assert len(slices) < 10


def test_what_is_cancelled_while_it_is_held_does_not_move_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A driver in a process of its own goes on the moment it is told to."""
    made = plant()
    controller, driver = made.controller, made.controller._driver
    resume = driver.resume

    def resume_at_once() -> None:
        resume()
        driver.poll(0.05)

    monkeypatch.setattr(driver, "resume", resume_at_once)
    held: list[tuple[float, ...]] = []

    def look() -> None:
        if controller.state().held:
            held.append(carriages(made))
            controller.cancel()
            controller.resume()
        elif not held:
            controller.hold()

    controller.set_break_key(look)
    controller.jog("x", 50)
    assert controller.run() is Status.CANCEL
    assert len(held) == 1
    assert carriages(made) == held[0]


def test_hold_after_resume_holds() -> None:
    controller = plant().controller
    controller.jog("x", 50)
    after_slices(controller, 3, controller.hold, controller.resume, controller.hold)
    positions: list[int] = []

    def show() -> None:
        positions.append(controller.state().position_steps[0])
        if len(positions) == 30:
            assert controller.state().held
            assert len(set(positions[15:])) == 1
            controller.resume()

    controller.set_show_pos(show)
    assert controller.run() is Status.OK
    assert controller.state().position_mm[0] == 50


def test_a_held_run_loop_lets_time_pass() -> None:
    made = plant()
    controller = made.controller
    controller.jog("x", 5)
    times: list[int] = []

    def break_key() -> None:
        times.append(made.clock.now_ns())
        if len(times) == 2:
            controller.hold()
        if len(times) == 12:
            controller.resume()

    controller.set_break_key(break_key)
    assert controller.run() is Status.OK
    assert times[11] - times[4] >= 0.6e9


@pytest.mark.parametrize("number", [1, 2, 4, 9])
def test_stop_above_the_start_rate_takes_the_reference(number: int) -> None:
    made = homed()
    controller = made.controller
    controller.move_to({"x": 40})
    after_slices(controller, number, controller.stop)
    assert controller.run() is Status.CANCEL
    state = controller.state()
    assert state.referenced == (False, True, True)
    assert "reference" in state.message


def test_stop_below_the_start_rate_keeps_it() -> None:
    made = homed()
    controller = made.controller
    controller.move_to({"x": 40}, feed_mm_min=60)
    after_slices(controller, 4, controller.stop)
    assert controller.run() is Status.CANCEL
    assert controller.state().referenced == (True, True, True)
    assert_agreement(made, ZERO_STEPS)


def test_a_surprise_in_a_callback_ends_the_job_and_leaves_the_controller_usable() -> None:
    made = plant()
    controller = made.controller
    controller.jog("x", 40)

    def surprise() -> None:
        raise RuntimeError("paper jam")

    after_slices(controller, 3, surprise)
    with pytest.raises(RuntimeError, match="paper jam"):
        controller.run()
    assert controller.status is Status.ERROR
    controller.idle(0.1)
    at = carriages(made)
    controller.idle(1.0)
    assert carriages(made) == at
    controller.set_break_key(lambda: None)
    controller.acknowledge()
    controller.jog("x", 1)
    assert controller.run() is Status.OK


def test_a_port_that_goes_away_ends_the_job_and_the_references() -> None:
    made = homed()
    controller = made.controller
    driver: Any = controller._driver

    def gone(budget_s: float) -> Report:
        raise PortError("The port went away.")

    controller.jog("x", 5)
    driver.poll = gone
    assert controller.run() is Status.ERROR
    state = controller.state()
    assert state.message == "The port went away."
    assert state.referenced == (False,) * 3


def test_late_ticks_and_dry_queues_are_owned_up_to() -> None:
    controller = plant().controller
    driver: Any = controller._driver
    poll, polls = driver.poll, []

    def busy(budget_s: float) -> Report:
        polls.append(budget_s)
        report: Report = poll(budget_s)
        return replace(report, late_ticks=7 * (len(polls) > 9), dry_queues=2 * (len(polls) > 9))

    told: list[str] = []
    controller.set_tell(told.append)
    controller.jog("x", 50)
    driver.poll = busy
    assert controller.run() is Status.OK
    assert controller.state().message == told[-1]
    assert "7 ticks came late" in told[-1]
    assert "dry 2 times" in told[-1]
    controller.jog("x", -1)
    assert controller.run() is Status.OK
    assert controller.state().message == ""


def test_a_silent_program_is_an_alarm_of_its_own() -> None:
    made = homed()
    controller = made.controller
    driver: Any = controller._driver
    poll = driver.poll

    def too_late(budget_s: float) -> Report:
        driver.stop()
        report: Report = poll(budget_s)
        return replace(report, ended=Ended.SILENCE)

    controller.jog("x", 5)
    driver.poll = too_late
    assert controller.run() is Status.ERROR
    assert isinstance(controller.error, SilenceAlarm)
    assert "X 0." in controller.state().message
    assert all(controller.state().referenced)


def test_a_stop_that_nobody_asked_for_ends_the_job() -> None:
    made = homed()
    controller = made.controller
    driver = controller._driver
    after_slices(controller, 2, driver.stop)
    controller.jog("x", 5)
    assert controller.run() is Status.ERROR
    assert isinstance(controller.error, StopAlarm)
    assert "nobody here had asked for it" in controller.state().message
    controller.acknowledge()
    controller.jog("x", 0.5)
    assert controller.run() is Status.OK


# --- end switches --------------------------------------------------------------------------------


@CARDS
@pytest.mark.parametrize("pin", [10, 11, 12, 13, 15])
@pytest.mark.parametrize("closed_reads", [0, 1])
def test_a_contact_is_an_alarm_that_names_its_end(
    card: dict[str, Any], pin: int, closed_reads: int
) -> None:
    made = plant(**card, switches={"pin": pin, "closed_reads": closed_reads})
    controller = made.controller
    put(made, "x", 200)
    assert not controller.state().switch_closed
    controller.jog("x", -2)
    assert controller.run() is Status.ERROR
    state = controller.state()
    assert state.switch_closed
    assert state.ends == ("xmin",)
    assert "xmin" in state.message
    assert isinstance(controller.error, Exception)
    with pytest.raises(StateError, match="Acknowledge"):
        controller.jog("x", 1)
    controller.acknowledge()
    with pytest.raises(StateError, match="xmin is closed"):
        controller.jog("x", -1)
    with pytest.raises(StateError, match="xmin is closed"):
        controller.move_to({"y": 1})
    controller.jog("x", 5)
    assert controller.run() is Status.OK
    assert not controller.state().switch_closed


def test_the_first_reading_stops_where_so_configured() -> None:
    made = plant(switches={"readings": 1})
    put(made, "x", 100)
    made.controller.jog("x", -1)
    assert made.controller.run() is Status.ERROR
    assert carriages(made)[0] == pytest.approx(0, abs=8)


def test_several_axes_give_several_candidates() -> None:
    made = plant()
    put(made, "x", 200)
    made.controller.move_to({"x": -3, "y": 3})
    assert made.controller.run() is Status.ERROR
    assert made.controller.state().ends == ("xmin", "ymax")


def test_a_referenced_position_excludes_ends() -> None:
    made = homed()
    controller = made.controller
    controller.move_to({"x": 100, "z": -30})
    controller.run()
    mill(made).press(end("ymin"))
    with pytest.raises(StateError, match="End switch ymin is closed"):
        controller.move_to({"x": 50})


def test_ignored_switches_do_not_stop() -> None:
    made = plant()
    controller = made.controller
    controller.ignore_switches(True)
    put(made, "x", 100)
    controller.jog("x", -1)
    assert controller.run() is Status.OK
    state = controller.state()
    assert state.switch_closed
    assert state.switch_ignored
    controller.ignore_switches(False)
    with pytest.raises(StateError):
        controller.move_to({"y": 1})


def test_a_switch_pressed_since_the_last_look_is_seen_before_moving() -> None:
    made = plant()
    mill(made).press(end("zmax"))
    before = carriages(made)
    with pytest.raises(StateError, match="closed"):
        made.controller.move_to({"x": 5})
    assert carriages(made) == before


# --- standstill ----------------------------------------------------------------------------------


def test_current_stays_for_the_delay_and_then_goes_off() -> None:
    made = plant(standstill={"delay_s": 5})
    controller = made.controller
    controller.jog("x", 1)
    controller.run()
    assert controller.state().energised
    controller.idle(4.9)
    assert controller.state().energised
    controller.idle(0.2)
    assert not controller.state().energised
    assert all(current == (0, 0) for current in look(made).currents)


def test_holding_current() -> None:
    made = plant(standstill={"current": "hold"}, card={"holding_percent": 60})
    made.controller.jog("x", 1.015)
    made.controller.run()
    for current in look(made).currents:
        assert 0 < max(current) <= 60
    made.controller.jog("x", 1)
    assert made.controller.run() is Status.OK
    assert look(made).lost_steps == (0, 0, 0)
    made.close()
    assert all(current == (0, 0) for current in look(made).currents)


def test_a_table_of_full_steps() -> None:
    rates = {"start_rate_hz": 400, "max_rate_hz": 2000, "acceleration_hz_s": 8000}
    made = homed(card={"table": "full-step"}, axes=axes(steps_per_rev=200, **rates))
    made.controller.move_to({"x": 10})
    assert made.controller.run() is Status.OK
    # The mill counts half-steps: the same carriage, the same travel.
    assert carriages(made) == (ZERO_STEPS[0] + 2000, *ZERO_STEPS[1:])
    assert look(made).lost_steps == (0, 0, 0)


# --- backlash ------------------------------------------------------------------------------------


@CARDS
def test_backlash_is_taken_up_by_the_motor_and_not_seen_in_the_position(
    card: dict[str, Any],
) -> None:
    made = plant(**merged(card, {"axes": {"x": {"backlash_mm": "0.1"}}}))
    controller = made.controller
    start = carriages(made)[0]
    for distance, motor_mm in ((1, 1), (1, 2), (-1, 0.9), (-0.5, 0.4), (2, 2.5)):
        controller.jog("x", distance)
        assert controller.run() is Status.OK
        assert carriages(made)[0] - start == pytest.approx(motor_mm * 200)
    assert controller.state().position_mm[0] == 2.5
    assert controller.position.slack_steps == (0, 0, 0)


@pytest.mark.parametrize("number", range(1, 9))
def test_position_and_slack_survive_a_cancel_within_the_take_up(number: int) -> None:
    made = plant(axes={"x": {"backlash_mm": "2"}})
    controller = made.controller
    start = carriages(made)[0]
    controller.jog("x", -5)
    after_slices(controller, number, controller.cancel)
    controller.run()
    motor = carriages(made)[0] - start
    assert controller.position.position_steps[0] - controller.position.slack_steps[0] == motor
    controller.acknowledge()
    controller.jog("x", 1)
    assert controller.run() in (Status.OK, Status.CANCEL)


# --- what is conserved ---------------------------------------------------------------------------


def assert_agreement(made: Plant, zero: tuple[float, ...]) -> None:
    """Carriages and position agree to the step."""
    controller = made.controller
    sight = look(made)
    for index, axis in enumerate(controller.machine.axes):
        seen = sight.carriages_steps[index] - zero[index]
        motor = controller.position.position_steps[index] - controller.position.slack_steps[index]
        assert seen == motor * axis.motor_sign
        assert sight.lost_steps[index] == 0


OPERATIONS = st.one_of(
    st.tuples(st.just("jog"), st.sampled_from(AXES), st.integers(-4000, 4000)),
    st.tuples(st.just("move"), st.integers(-20, 20), st.integers(-20, 20)),
    st.tuples(st.just("curve"), st.integers(-9, 9), st.integers(-9, 9)),
)
BREAKS = st.tuples(st.sampled_from(["", "cancel", "hold", "slow stop"]), st.integers(1, 12))


@given(
    st.lists(st.tuples(OPERATIONS, BREAKS), max_size=6),
    st.sampled_from([{}, STEPDIR]),
    st.sampled_from(["0", "0.1"]),
)
def test_conservation(
    operations: list[tuple[tuple[Any, ...], tuple[str, int]]], card: dict[str, Any], backlash: str
) -> None:
    made = plant(**merged(card, {"axes": axes(backlash_mm=backlash)}))
    controller = made.controller
    start = carriages(made)
    for (kind, first, second), (disturbance, number) in operations:
        disturb(controller, disturbance, number)
        slow = 120 if disturbance == "slow stop" else 2000
        try:
            if kind == "jog":
                controller.jog_steps(first, second)
            elif kind == "move":
                controller.move_to({"x": first, "y": second}, feed_mm_min=slow)
            else:
                points = [(first, second, 1.0), (second, first, -1.0), (0.0, 0.0, 0.0)]
                controller.run_curve(points, slow)
        except LimitError:
            continue
        controller.run()
        controller.acknowledge()
        sight = look(made)
        if any(sight.lost_steps):
            # Torn away: the mill says so, and the controller knows.
            assert controller.status is Status.OK
            break
        assert tuple(
            now - then for now, then in zip(sight.carriages_steps, start, strict=True)
        ) == (
            tuple(
                at - slack
                for at, slack in zip(
                    controller.position.position_steps,
                    controller.position.slack_steps,
                    strict=True,
                )
            )
        )


CONTACTS = st.one_of(
    st.tuples(st.just("jog"), st.sampled_from(AXES), st.integers(-2000, 2000)),
    st.tuples(st.just("move"), st.integers(-12, 12), st.integers(-12, 12)),
    st.tuples(st.just("home"), st.sampled_from(["", *AXES]), st.just(0)),
)


@settings(max_examples=80)
@given(st.lists(st.tuples(CONTACTS, BREAKS), max_size=4), st.sampled_from([{}, STEPDIR]))
def test_conservation_through_contacts_and_reference_runs(
    operations: list[tuple[tuple[Any, ...], tuple[str, int]]], card: dict[str, Any]
) -> None:
    """On a short mill nearly every move meets an end; slowly, so that a contact tears nothing."""
    slow = {"jog": {"feed_mm_min": 200}, "homing": {"approach_mm_min": 200}}
    made = plant(**card, **slow, axes=axes(travel_mm="12"))
    controller = made.controller
    zero = carriages(made)
    for (kind, first, second), (disturbance, number) in operations:
        disturb(controller, disturbance, number)
        before = controller.state().referenced
        try:
            if kind == "home":
                controller.home(first)
            elif kind == "jog":
                controller.jog_steps(first, second)
            else:
                controller.move_to({"x": first, "y": second}, feed_mm_min=200)
        except (LimitError, StateError):
            continue
        controller.run()
        controller.acknowledge()
        state, now = controller.state(), carriages(made)
        assert look(made).lost_steps == (0, 0, 0)
        if kind == "home":
            # Where zero is found it is the one and only; elsewhere it was not touched.
            found = (400, 400, 2000)
            zero = tuple(
                right if here and (not was or not state.position_steps[i]) else old
                for i, (right, here, was, old) in enumerate(
                    zip(found, state.referenced, before, zero, strict=True)
                )
            )
        moved = tuple(int(a - b) for a, b in zip(now, zero, strict=True))
        assert moved == state.position_steps


def disturb(controller: Any, what: str, number: int) -> None:
    slices: list[int] = []

    def break_key() -> None:
        slices.append(1)
        if len(slices) == number:
            if what == "cancel":
                controller.cancel()
            elif what == "slow stop":
                controller.stop()
            elif what == "hold":
                controller.hold()
        if len(slices) == number + 15 and what == "hold":
            controller.resume()

    controller.set_break_key(break_key)


# --- seen from another thread --------------------------------------------------------------------


def test_the_state_may_be_read_from_another_thread_at_any_time() -> None:
    made = homed()
    controller = made.controller
    stop = threading.Event()
    failed: list[BaseException] = []

    def watch() -> None:
        try:
            while not stop.is_set():
                state = controller.state()
                assert 0 <= state.position_steps[0] <= 4000
                assert len(state.work_mm) == 3
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        for target in (20, 0, 20, 0):
            controller.move_to({"x": target})
            assert controller.run() is Status.OK
    finally:
        stop.set()
        thread.join()
    assert not failed, failed


def test_two_equal_runs_write_the_same_bytes_at_the_same_times() -> None:
    def once() -> list[Any]:
        made = plant(axes={"x": {"backlash_mm": "0.05"}})
        recorder = record(made)
        made.controller.home()
        made.controller.run()
        made.controller.move_to({"x": 12.345, "y": 3.21})
        made.controller.run()
        return list(recorder.accesses)

    assert once() == once()
