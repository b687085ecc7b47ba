"""The child's loop: what it does when its host asks, wishes, falls silent or dies."""

from collections.abc import Callable
from itertools import pairwise
from typing import TypeVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Outputs, Watch, WatchAction, steps_done
from fraese.motor.realtime import mailbox
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.setup import ChargePump
from fraese.motor.seams import CONTROL, Ended, IdleLevel, SwitchMode
from tests.motor.workbench import TRAVEL_STEPS, end, line, steady
from tests.realtime.room import Room

SETTLED_S = 0.025


T = TypeVar("T")


def seen_at(room: Room, seconds: float, look: Callable[[], T]) -> list[T]:
    """What a look at that moment shows, afterwards in a list."""
    seen: list[T] = []
    room.at(seconds, lambda: seen.append(look()))
    return seen


class TestPlaying:
    def test_a_run_begins_with_a_question_not_with_a_push(self) -> None:
        room = Room()
        room.push(steady(50))
        assert room.until(0.1).position_steps == (0, 0, 0)
        room.ask()
        assert room.until(0.3).position_steps == (50, 0, 0)
        assert room.bench.carriages() == (50, 0, 0)

    @pytest.mark.parametrize(
        ("wiring", "sockets", "steps"),
        [
            ("x4step", (2, 0, 3, 1), (50, -30, 20, 10)),
            ("paper", (3,), (-50,)),
            ("smc", (2, 0), (20, -50)),
        ],
    )
    def test_motors_in_other_sockets(
        self, wiring: str, sockets: tuple[int, ...], steps: tuple[int, ...]
    ) -> None:
        room = Room(wiring, sockets=sockets)
        room.play(steady(50)._replace(steps=steps))
        assert room.until(0.3).position_steps == steps
        assert room.bench.carriages() == steps

    def test_blocks_that_come_while_it_runs_are_played_without_a_gap(self) -> None:
        room = Room()
        room.play(line(300, exit_hz=5000))
        room.at(SETTLED_S + 0.05, lambda: room.push(line(300, entry_hz=5000)))
        report = room.until(0.5)
        assert report.position_steps == (600, 0, 0)
        assert (report.dry_queues, report.late_ticks, report.playing) == (0, 0, 2)

    def test_blocks_that_do_not_come_end_in_a_braked_stop(self) -> None:
        room = Room()
        room.play(line(3000, exit_hz=5000))
        report = room.until(1.5)
        assert report.dry_queues == 1
        assert report.torn == frozenset()
        assert 2500 < report.position_steps[0] <= 3000

    @pytest.mark.parametrize("wiring", ["smc", "x4step"])
    def test_chores_make_no_tick_late(self, wiring: str) -> None:
        room = Room(wiring)
        for _ in range(20):
            room.push(steady(100, 100, 100, rate_hz=5000, jump_hz=5000))
        room.ask()
        for k in range(100):
            room.at(0.03 + 0.004 * k, room.ask)
        report = room.until(0.5)
        assert report.position_steps == (2000, 2000, 2000)
        assert report.late_ticks == 0

    def test_a_question_is_answered_while_it_runs(self) -> None:
        room = Room()
        room.play(line(3000))
        room.at(0.2, lambda: room.push(line(0, 100)))
        asked: list[int] = []
        room.at(0.2001, lambda: asked.append(room.ask()))
        answered = seen_at(room, 0.203, lambda: room.told().echo)
        room.until(0.25)
        assert answered == asked

    def test_motors_run_until_the_last_pulse_has_ended(self) -> None:
        """Stopped, with nothing queued any more; but a clock line is still up."""
        room = Room("x4step")
        room.play(steady(5, rate_hz=2))
        room.at(SETTLED_S + 1.1, room.stop)
        in_pulse = seen_at(room, SETTLED_S + 1.2, lambda: (room.report.running, room.report.queued))
        after = seen_at(room, SETTLED_S + 1.3, lambda: room.report.running)
        room.until(1.5)
        assert in_pulse == [(True, 0)]
        assert after == [False]

    def test_a_report_in_the_middle_is_of_that_moment(self) -> None:
        room = Room()
        room.play(steady(1000, -500, 250, rate_hz=1000, tag=5))
        seen = seen_at(room, 0.5, lambda: room.report)
        room.until(1.0)
        (report,) = seen
        assert report.running
        x, y, z = report.position_steps
        assert x == pytest.approx(480, abs=4)
        assert -y - steps_done(500, 1000, x) in (0, 1)
        assert z - steps_done(250, 1000, x) in (0, 1)
        assert report.travelled_steps == (x, -y, z)
        assert (report.tag, report.tick, report.rate_hz) == (5, x, 1000)


class TestWishes:
    def test_a_stop_does_not_wait_for_a_slow_tick(self) -> None:
        room = Room()
        room.play(steady(10, rate_hz=1))
        room.at(2.5, room.stop)
        seen = seen_at(room, 2.502, lambda: room.report.ended)
        report = room.until(3.0)
        assert seen == [Ended.STOP]
        assert report.position_steps == (2, 0, 0)
        assert room.bench.carriages() == (2, 0, 0)

    @pytest.mark.parametrize("within_us", range(0, 1000, 90))
    def test_an_answer_after_a_stop_knows_of_it(self, within_us: int) -> None:
        """Also where the wait for the tick in hand is too short to be broken off."""
        room = Room()
        room.play(steady(400, rate_hz=1050))
        asked: list[int] = []
        told: list[tuple[bool, Ended]] = []

        def stop_and_ask() -> None:
            room.stop()
            asked.append(room.ask())

        def look() -> None:
            if room.told().echo >= asked[0]:
                told.append((room.report.running, room.report.ended))

        room.at(0.2 + within_us * 1e-6, stop_and_ask)
        for k in range(1, 150):
            room.at(0.2 + within_us * 1e-6 + k * 20e-6, look)
        report = room.until(0.25)
        assert set(told) == {(False, Ended.STOP)}
        assert room.bench.carriages() == report.position_steps

    def test_a_brake_in_a_slow_tick_loses_no_step(self) -> None:
        room = Room("x4step")
        room.play(steady(10, 5, rate_hz=2))
        for k in range(4):
            room.at(0.6 + k, room.brake)
            room.at(0.9 + k, lambda: room.post(mailbox.RESUME))
            room.at(0.91 + k, room.ask)
        # The pulse in hand, a quarter of a second long, is not cut short.
        held = seen_at(room, 0.8, lambda: room.report.held)
        report = room.until(9.0)
        assert held == [True]
        assert report.position_steps == (10, 5, 0)
        assert room.bench.carriages() == (10, 5, 0)

    @given(
        st.sampled_from(["smc", "x4step"]),
        st.lists(
            st.tuples(st.floats(0.0, 0.6), st.sampled_from(["brake", "resume", "stop"])),
            max_size=6,
        ),
    )
    def test_whatever_is_wished_for_the_report_says_what_the_carriages_did(
        self, wiring: str, wishes: list[tuple[float, str]]
    ) -> None:
        room = Room(wiring)
        room.play(line(700, -300, 20), steady(3, rate_hz=20), line(-100, 400))
        for seconds, wish in wishes:
            action = {
                "brake": room.brake,
                "resume": lambda: room.post(mailbox.RESUME),
                "stop": room.stop,
            }[wish]
            room.at(seconds, action)
            room.at(seconds + 0.001, room.ask)
        report = room.until(1.5)
        assert not report.running
        assert room.bench.carriages() == report.position_steps
        if "stop" not in {wish for _, wish in wishes}:
            room.post(mailbox.RESUME)
            room.until(1.6)
            room.ask()
            assert room.until(3.0).position_steps == (603, 100, 20)

    def test_an_override_reaches_what_is_playing(self) -> None:
        room = Room()
        block = steady(1000, rate_hz=1000)._replace(override_q8=256)
        room.play(block)

        room.at(0.3, lambda: room.override(0.5))
        rates = seen_at(room, 0.5, lambda: room.report.rate_hz)
        room.until(1.0)
        assert rates == [500.0]


class TestCommands:
    @pytest.mark.parametrize("kind", [mailbox.FLUSH, mailbox.IDLE])
    @pytest.mark.parametrize("seconds", [0.01, 0.3])
    def test_what_needs_standstill_is_refused_in_motion(self, kind: int, seconds: float) -> None:
        """Also in the first hundredth of a second, in which the coils settle."""
        room = Room()
        room.play(line(3000))
        posted: list[int] = []
        room.at(seconds, lambda: posted.append(room.post(kind)))
        answers = seen_at(room, seconds + 0.005, lambda: room.answer(posted[0]))
        room.until(1.0)
        assert "at standstill" in str(answers[0])
        assert room.report.position_steps == (3000, 0, 0)

    def test_at_standstill_it_is_done(self) -> None:
        room = Room()
        room.play(line(300))
        assert room.until(0.5).energised
        number = room.post(mailbox.IDLE, mailbox.IDLE_LEVELS.index(IdleLevel.OFF))
        assert not room.until(0.6).energised
        assert room.answer(number) == ""
        assert set(room.bench.currents()) == {(0, 0)}

    def test_what_comes_while_the_motors_come_to_rest_waits_for_that(self) -> None:
        """With clock lines the last pulse must end before the motors stand."""
        room = Room("x4step")
        room.play(steady(9, rate_hz=2))
        room.at(0.6, room.stop)
        posted: list[int] = []
        room.at(0.61, lambda: posted.append(room.post(mailbox.FLUSH)))
        answers = seen_at(room, 0.62, lambda: room.answer(posted[0]))
        room.until(1.5)
        assert answers == [None]
        assert room.answer(posted[0]) == ""
        # At once, and half a second later: the second pulse was under way.
        assert room.report.position_steps == (2, 0, 0)

    def test_told_to_close_it_leaves_at_once(self) -> None:
        room = Room()
        room.play(steady(100, rate_hz=1))
        room.at(1.5, lambda: room.post(mailbox.CLOSE))
        room.until(99)
        assert room.time.now < 1.51e9


class TestIgnorance:
    """The host pushes on, since it cannot know yet that the run has ended."""

    def test_what_is_pushed_after_a_contact_is_not_played(self) -> None:
        room = Room()
        room.bench.place("x", TRAVEL_STEPS - 30)
        room.play(steady(100))
        room.at(0.1, lambda: room.push(steady(-100)))
        room.until(0.15)
        room.ask()
        report = room.until(0.3)
        assert (report.ended, report.candidates) == (Ended.SWITCH, frozenset({end("x+")}))
        assert 30 <= report.position_steps[0] < 35
        assert (report.playing, report.running) == (2, False)
        room.generation = room.told().generation
        room.post(mailbox.SWITCH_MODE, mailbox.SWITCH_MODES.index(SwitchMode.IGNORE))
        room.play(steady(-20))
        assert room.until(0.5).position_steps[0] == report.position_steps[0] - 20

    def test_nor_after_a_stop_even_if_the_stop_was_not_acted_on_yet(self) -> None:
        room = Room()
        room.play(steady(100, rate_hz=1))

        def stop_and_push() -> None:
            room.stop()
            room.play(steady(50))

        room.at(1.6, stop_and_push)
        report = room.until(3.0)
        assert (report.ended, report.position_steps) == (Ended.STOP, (1, 0, 0))
        assert report.playing == 2

    def test_no_answer_before_what_was_pushed_in_ignorance_is_dropped(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        room = Room()
        told: list[tuple[int, int]] = []
        write = room.chores.reporter.write

        def write_and_read(echo: int, due_ns: int = 0) -> None:
            write(echo, due_ns)
            told.append((room.told().echo, room.report.playing))

        monkeypatch.setattr(room.chores.reporter, "write", write_and_read)
        room.play(steady(100, rate_hz=1))
        first = room.words[shared.ASKED]

        def stop_and_push() -> None:
            room.stop()
            room.play(steady(50))

        room.at(1.6, stop_and_push)
        room.until(2.0)
        assert told[-1] == (room.words[shared.ASKED], 2)
        assert all(playing == 2 for echo, playing in told if echo > first)

    def test_nor_after_a_probe_has_touched(self) -> None:
        room = Room()
        room.bench.place("x", TRAVEL_STEPS - 30)
        room.play(steady(100, watch=Watch(0x80, 0, WatchAction.STOP)))
        room.at(0.1, lambda: room.play(steady(-100)))
        report = room.until(0.3)
        assert report.ended is Ended.WATCH
        assert report.latched_steps is not None
        assert 30 <= report.position_steps[0] < 35


class TestHost:
    def test_a_silent_host_brakes_the_motors_and_switches_them_off(self) -> None:
        room = Room(silent_s=0.4)
        room.play(line(9000))
        room.at(0.5, room.fall_silent)
        moving = seen_at(room, 0.85, lambda: room.report.running)
        # Braking from 5000 Hz takes an eighth of a second.
        still = seen_at(room, 1.1, lambda: room.report.running)
        report = room.until(1.3)
        assert (moving, still) == ([True], [False])
        assert (report.ended, report.queued, report.torn) == (Ended.SILENCE, 0, frozenset())
        assert not report.energised
        assert set(room.bench.currents()) == {(0, 0)}
        assert room.bench.carriages() == report.position_steps

    def test_silence_switches_every_output_off(self) -> None:
        room = Room(silent_s=0.4)
        room.play(line(9000, outputs=Outputs(0b11, 0b11)))
        on = seen_at(room, 0.4, room.bench.outputs_on)
        room.at(0.5, room.fall_silent)
        assert room.until(1.3).ended is Ended.SILENCE
        assert on == [{0, 1}]
        assert room.bench.outputs_on() == set()

    def test_a_host_that_speaks_again_is_not_followed_blindly(self) -> None:
        room = Room(silent_s=0.4)
        room.play(line(9000))
        room.at(0.5, room.fall_silent)
        room.at(1.2, lambda: room.play(line(100)))
        where = room.until(1.3).position_steps
        assert room.report.ended is Ended.SILENCE
        room.generation = room.told().generation
        room.alive = True
        room._beat()
        room.play(line(100))
        assert room.until(1.6).position_steps[0] == where[0] + 100

    def test_silence_under_current_at_standstill_switches_off_too(self) -> None:
        room = Room(silent_s=0.4)
        room.play(line(300))
        room.at(0.3, room.fall_silent)
        seen = seen_at(room, 0.6, lambda: room.report)
        report = room.until(2.0)
        assert (seen[0].ended, seen[0].energised) == (Ended.TARGET, True)
        assert (report.ended, report.energised) == (Ended.SILENCE, False)
        assert report.position_steps == (300, 0, 0)

    def test_a_dead_host_brakes_the_motors_and_the_child_leaves(self) -> None:
        room = Room()
        room.play(line(9000))
        room.at(0.5, room.die)
        room.player.play()
        assert room.time.now < 0.7e9
        assert room.bench.core.run.track.torn == frozenset()
        room.bench.core.close()
        assert set(room.bench.currents()) == {(0, 0)}

    def test_a_dead_host_does_not_wait_for_a_slow_tick(self) -> None:
        room = Room()
        room.play(steady(10, rate_hz=0.2))
        room.at(2.0, room.die)
        room.player.play()
        assert room.time.now < 2.02e9

    def test_a_charge_pump_shows_that_the_loop_lives(self) -> None:
        room = Room(pump=ChargePump(output=1, rate_hz=50))
        room.play(line(900, 300))
        room.until(1.0)
        levels = [a.value >> 3 & 1 for a in room.bench.accesses() if a.register == CONTROL]
        edges = sum(a != b for a, b in pairwise(levels))
        assert edges == pytest.approx(100, abs=10)
        assert room.bench.carriages() == (900, 300, 0)
