"""The host's driver on the real firmware: what is its own, besides the contract of all drivers."""

from dataclasses import replace
from itertools import pairwise

import pytest

from fraese.blocks import Outputs, Piece, Watch, WatchAction
from fraese.errors import PortError
from fraese.motor.bridge import constants as c
from fraese.motor.bridge.codec import Status
from fraese.motor.bridge.driver import BridgeDriver
from fraese.motor.bridge.session import Session
from fraese.motor.seams import Ended, Report
from tests.bridge.device import reason_to_skip
from tests.bridge.firmwaremill import FirmwareBench
from tests.motor.workbench import TRAVEL_STEPS, end, ends, line, steady

pytestmark = pytest.mark.skipif(bool(reason_to_skip()), reason=reason_to_skip())


@pytest.fixture
def bench() -> FirmwareBench:
    return FirmwareBench("smc")


def run(bench: FirmwareBench, budget_s: float = 0.02) -> Report:
    report = bench.driver.poll(budget_s)
    while report.running:
        report = bench.driver.poll(budget_s)
    return report


def refused_poll(bench: FirmwareBench) -> tuple[float, str]:
    """How long a poll of a lost device takes, and what it says; nothing: it was found."""
    bench.wait(0.05)
    since_ns = bench.clock.now_ns()
    said = ""
    try:
        bench.driver.poll(0)
    except PortError as error:
        said = str(error)
    return (bench.clock.now_ns() - since_ns) / 1e9, said


def catch_between(bench: FirmwareBench, monkeypatch: pytest.MonkeyPatch) -> list[Status]:
    """The first answer that the motors stand was given a moment earlier: held, time still runs."""
    caught: list[Status] = []
    look = BridgeDriver._look

    def look_early(driver: BridgeDriver, session: Session) -> None:
        look(driver, session)
        if not caught and not driver.status.state & c.State.MOVING:
            between = driver.status.state | c.State.MOVING | c.State.HELD
            caught.append(replace(driver.status, state=between, ended=c.ENDED_NOT))
            driver._hear(session, caught[0])

    monkeypatch.setattr(BridgeDriver, "_look", look_early)
    return caught


class TestQueue:
    def test_more_than_the_ring_holds_is_kept_here_and_played_in_order(
        self, bench: FirmwareBench
    ) -> None:
        # Long records: the way changes in every block.
        blocks = [steady(40 + n, -n, n // 2, rate_hz=3000 + n) for n in range(100)]
        taken = 0
        report = bench.driver.poll(0)
        while taken < len(blocks) or report.running:
            while taken < len(blocks) and bench.driver.push(blocks[taken]):
                taken += 1
            report = bench.driver.poll(0.02)
        assert report.position_steps == tuple(sum(b.steps[m] for b in blocks) for m in range(3))
        assert bench.carriages() == report.position_steps
        assert (report.playing, report.ended, report.dry_queues) == (100, Ended.TARGET, 0)
        assert report.late_ticks == 0

    def test_a_full_queue_says_so_and_free_is_an_estimate_of_it(self, bench: FirmwareBench) -> None:
        pushed = 0
        while bench.driver.push(steady(40 + pushed, -pushed, rate_hz=900 + pushed)):
            pushed += 1
        report = bench.driver.poll(0)
        assert report.running
        assert report.queued == pushed
        assert report.free < pushed // 2

    def test_a_block_that_never_fits_is_refused_here(self, bench: FirmwareBench) -> None:
        law = tuple(Piece(1, 1_000_000 + 70_000 * (n % 7), n) for n in range(240))
        with pytest.raises(ValueError, match=r"takes \d+ bytes; the bridge stores \d+"):
            bench.driver.push(steady(240)._replace(pieces=law))
        with pytest.raises(ValueError, match="300 pieces; the bridge plays"):
            bench.driver.push(steady(300)._replace(pieces=(Piece(1, 1_000_000),) * 300))
        assert bench.driver.poll(0).queued == 0

    def test_a_queue_that_runs_dry_brakes_and_goes_on_when_fed(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(2000, exit_hz=5000))
        report = run(bench)
        assert (report.dry_queues, report.held, report.torn) == (1, True, frozenset())
        assert 1000 < report.position_steps[0] < 2000
        bench.driver.push(line(1000, entry_hz=5000))
        report = run(bench)
        assert report.position_steps == (3000, 0, 0)
        assert bench.lost() == (0, 0, 0)

    def test_stop_drops_what_is_still_on_its_way(self, bench: FirmwareBench) -> None:
        pushed = 0
        while bench.driver.push(line(100, 37, -11)):
            pushed += 1
        bench.driver.poll(0.02)
        bench.driver.stop()
        report = run(bench)
        assert (report.ended, report.queued, report.playing) == (Ended.STOP, 0, pushed)
        bench.driver.push(steady(5, tag=4))
        after = run(bench)
        assert after.position_steps[0] == report.position_steps[0] + 5
        assert (after.ended, after.playing, after.tag) == (Ended.TARGET, pushed + 1, 4)

    def test_stop_at_standstill_drops_what_was_pushed(self, bench: FirmwareBench) -> None:
        bench.driver.push(steady(50))
        bench.driver.stop()
        report = bench.driver.poll(0.1)
        assert (report.ended, report.queued, report.running) == (Ended.STOP, 0, False)
        assert report.position_steps == (0, 0, 0)
        bench.driver.push(line(50))
        assert run(bench).position_steps == (50, 0, 0)

    def test_limits_are_known_after_a_queue_was_dropped(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(3000))
        bench.driver.poll(0.2)
        bench.driver.brake()
        held = run(bench)
        bench.driver.flush()
        bench.driver.push(line(3000))
        bench.driver.poll(0.2)
        bench.driver.brake()
        again = run(bench)
        # But for the settling before the first run it braked as early, and with the same
        # acceleration as before.
        way = again.position_steps[0] - held.position_steps[0]
        assert way == pytest.approx(held.position_steps[0], abs=130)
        assert not again.torn


class TestLaser:
    @pytest.mark.parametrize("way", ["stop", "flush"])
    def test_what_ended_early_does_not_switch_it_on_again(self, way: str) -> None:
        bench = FirmwareBench("smc", safe_outputs=0b10)
        bench.driver.push(line(3000)._replace(outputs=Outputs(0b11, 0b11)))
        bench.driver.poll(0.3)
        assert bench.outputs_on() == {0, 1}
        if way == "stop":
            bench.driver.stop()
            run(bench)
        else:
            bench.driver.brake()
            run(bench)
            bench.driver.flush()
        assert bench.outputs_on() == {0}
        bench.driver.push(line(400))
        assert bench.driver.poll(0.1).running
        assert bench.outputs_on() == {0}


class TestContacts:
    def test_a_watch_latches_and_ends_the_run(self, bench: FirmwareBench) -> None:
        bench.place("x", TRAVEL_STEPS - 300)
        bench.driver.push(steady(1000, watch=Watch(0x80, 0, WatchAction.STOP)))
        report = run(bench)
        assert report.ended is Ended.WATCH
        assert report.latched_steps is not None
        assert 300 <= report.latched_steps[0] <= report.position_steps[0] <= 305
        assert report.candidates == ends("x+")

    def test_a_last_word_from_between_hold_and_rest_is_asked_about(
        self, bench: FirmwareBench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The step interrupt holds; the main loop, a moment later, says that the run is over."""
        bench.place("x", TRAVEL_STEPS - 3000)
        bench.driver.push(line(6000)._replace(watch=Watch(0x80, 0, WatchAction.STOP)))
        bench.driver.poll(0.3)
        caught = catch_between(bench, monkeypatch)
        for _ in range(50):
            report = bench.driver.poll(0.02)
            if report.ended is not Ended.NOT:
                break
        assert caught
        assert (report.ended, report.running) == (Ended.WATCH, False)
        assert bench.carriage("x") == report.position_steps[0]

    def test_a_brake_whose_last_word_is_from_between_hold_and_rest_is_held(
        self, bench: FirmwareBench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        bench.driver.push(line(6000))
        bench.driver.poll(0.3)
        caught = catch_between(bench, monkeypatch)
        bench.driver.brake()
        report = run(bench)
        assert caught
        assert (report.held, report.running, report.rate_hz) == (True, False, 0)
        bench.driver.resume()
        assert run(bench).position_steps == (6000, 0, 0)

    def test_two_axes_leave_two_candidates(self, bench: FirmwareBench) -> None:
        bench.place("x", TRAVEL_STEPS - 60)
        bench.driver.push(steady(300, -200))
        report = run(bench)
        assert (report.ended, report.candidates) == (Ended.SWITCH, ends("x+", "y-"))

    def test_a_hand_soon_after_a_run_and_long_after_it(self, bench: FirmwareBench) -> None:
        bench.driver.push(steady(20))
        run(bench)
        bench.wait(0.1)
        bench.simulated.press(end("y-"))
        assert len(bench.driver.poll(0).candidates) == 6


class TestBrake:
    @pytest.mark.parametrize("hurry_s", [0.0, 0.003, 0.011, 0.0171])
    def test_the_first_longer_interval_comes_within_ten_milliseconds(
        self, bench: FirmwareBench, hurry_s: float
    ) -> None:
        bench.driver.push(line(6000, 2000, 700))
        bench.driver.poll(0.3)
        bench.wait(hurry_s)
        mark, since_ns = bench.mark(), bench.clock.now_ns()
        bench.driver.brake()
        bench.driver.poll(0.05)
        steps_ns = bench.steps_ns(0, mark)
        longer_ns = next(b for a, b in pairwise(steps_ns) if b - a > 201_000)
        assert longer_ns - since_ns < 10_000_000
        assert run(bench).held

    def test_a_resume_comes_after_a_brake_that_the_line_swallowed(
        self, bench: FirmwareBench, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        bench.driver.push(line(6000))
        bench.driver.poll(0.3)
        with monkeypatch.context() as deaf:
            deaf.setattr(bench.lines[-1], "write", lambda _data: None)
            bench.driver.brake()
        bench.driver.resume()
        assert bench.driver.status.brakes
        report = run(bench)
        assert (report.held, report.position_steps) == (False, (6000, 0, 0))

    def test_an_override_is_sent_with_the_next_poll(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(4000)._replace(override_q8=256))
        bench.driver.poll(0.3)
        bench.driver.set_override(0.5)
        bench.driver.poll(0.2)
        assert bench.driver.poll(0.01).rate_hz == pytest.approx(2500, rel=0.02)
        assert bench.driver.status.override_q8 == 128
        assert run(bench).position_steps == (4000, 0, 0)


class TestLives:
    def test_unplugged_while_moving_the_way_is_bounded(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(3000, -300))
        bench.driver.push(steady(100))
        last = bench.driver.poll(0.3)
        since_ns = bench.clock.now_ns()
        bench.unplug()
        with pytest.raises(PortError, match="the line is gone") as lost:
            bench.driver.poll(0.1)
        assert bench.clock.now_ns() - since_ns < 100_000_000
        x, y = last.position_steps[:2]
        assert f"motor 1 {x} to 3100, motor 2 -300 to {y}, motor 3 0" in str(lost.value)
        # For programs, too.
        assert lost.value.facts["low_steps"] == (x, -300, 0)
        assert lost.value.facts["high_steps"] == (3100, y, 0)
        with pytest.raises(PortError, match="is lost"):
            bench.driver.push(steady(1))
        bench.driver.brake()
        bench.driver.stop()

    def test_plugged_in_again_it_goes_on_but_nobody_trusts_it(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(3000))
        last = bench.driver.poll(0.3)
        bench.unplug()
        with pytest.raises(PortError, match=r"^the line is gone"):
            bench.driver.poll(0)
        for _ in range(2):
            with pytest.raises(PortError, match=r"is lost; it is looked for\. the line is gone"):
                bench.driver.poll(0)
        bench.plug_in()
        bench.wait(1.1)
        report = bench.driver.poll(0)
        assert report.position_steps == last.position_steps
        assert report.travelled_steps == last.travelled_steps
        assert report.torn == {0, 1, 2}
        assert report.phases == last.phases
        assert (report.playing, report.queued, report.running) == (2 - 1, 0, False)
        bench.driver.push(steady(10, tag=5))
        after = run(bench)
        assert after.position_steps[0] == last.position_steps[0] + 10
        assert (after.torn, after.playing, after.tag) == (frozenset(), 2, 5)
        assert (report.finished, after.finished) == (0, 1)

    def test_a_reset_in_between_is_an_alarm(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(3000))
        bench.driver.poll(0.3)
        bench.chip.avr.reset()
        with pytest.raises(PortError, match=r"was reset meanwhile; the bridge brakes and switches"):
            bench.driver.poll(0.5)
        assert bench.currents() == [(0, 0)] * 3
        bench.wait(1.0)
        assert bench.driver.poll(0).torn == {0, 1, 2}

    def test_a_device_that_hangs_is_noticed(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(3000))
        bench.driver.poll(0.1)
        bench.chip.avr.set_host_baud(9600)
        with pytest.raises(PortError, match="does not answer any more; the bridge brakes"):
            bench.driver.poll(5)

    def test_no_poll_waits_for_long_while_it_is_looked_for(self, bench: FirmwareBench) -> None:
        bench.driver.poll(0)
        bench.chip.avr.set_host_baud(9600)
        with pytest.raises(PortError, match="does not answer any more"):
            bench.driver.poll(0)
        refused = [refused_poll(bench) for _ in range(60)]
        assert max(took_s for took_s, _ in refused) < 0.03
        assert {"looked for." in said for _, said in refused} == {True}
        assert "Nobody answers" in refused[-1][1]
        # One attempt lasts 0.3 s here, then a second passes.
        assert 2 <= len(bench.lines) - 1 <= 3
        bench.chip.avr.set_host_baud(250_000)
        for _ in range(60):
            found = refused_poll(bench)
            if not found[1]:
                break
        assert not found[1]
        assert found[0] < 0.03
        assert [line.closed for line in bench.lines] == [True] * (len(bench.lines) - 1) + [False]

    def test_a_driver_that_is_closed_looks_for_nothing(self, bench: FirmwareBench) -> None:
        bench.chip.avr.set_host_baud(9600)
        with pytest.raises(PortError, match="does not answer any more"):
            bench.driver.poll(0)
        refused_poll(bench)
        bench.driver.close()
        assert all(line.closed for line in bench.lines)
        with pytest.raises(PortError, match="closed"):
            bench.driver.poll(0)

    def test_a_host_that_says_nothing_is_taken_for_hung(self) -> None:
        bench = FirmwareBench("smc", silence_s=0.3)
        for _ in range(10):
            bench.driver.push(line(3000))
        bench.driver.poll(0.1)
        bench.wait(1.5)
        assert bench.currents() == [(0, 0)] * 3
        report = bench.driver.poll(0)
        assert (report.ended, report.queued, report.energised) == (Ended.SILENCE, 0, False)
        assert not report.torn
        assert bench.carriage("x") == report.position_steps[0] > 0

    def test_a_host_that_is_busy_and_says_so_is_not(self) -> None:
        bench = FirmwareBench("smc", silence_s=0.3)
        bench.place("x", 500)
        for _ in range(6):
            bench.driver.push(line(3000))
        bench.driver.poll(0.1)
        for _ in range(8):
            bench.wait(0.1)
            bench.driver.sign_of_life()
        assert (bench.driver.unattended_s() or 0) > 0.7
        resent = bench.driver.session.link.resent
        report = run(bench)
        assert (report.ended, report.dry_queues) == (Ended.TARGET, 0)
        assert bench.carriages() == report.position_steps == (18_000, 0, 0)
        assert bench.driver.session.link.resent == resent
        bench.driver.close()
        assert bench.driver.unattended_s() is None

    def test_current_at_standstill_goes_with_the_host(self) -> None:
        bench = FirmwareBench("smc", silence_s=0.3)
        bench.driver.push(steady(3))
        assert run(bench).energised
        bench.wait(1.0)
        assert bench.currents() == [(0, 0)] * 3
        bench.driver.push(line(300))
        assert run(bench).position_steps == (303, 0, 0)

    def test_a_host_that_comes_back_to_moving_motors_brakes_them(
        self, bench: FirmwareBench
    ) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.3)
        report = bench.another_driver().poll(0)
        assert not report.running
        assert bench.lost() == (0, 0, 0)
        assert set(bench.currents()) == {(0, 0)}

    def test_close_always_returns(self, bench: FirmwareBench) -> None:
        bench.driver.push(line(9000))
        bench.driver.poll(0.3)
        bench.unplug()
        with pytest.raises(PortError):
            bench.driver.close()
        bench.driver.close()
        with pytest.raises(PortError, match="closed"):
            bench.driver.poll(0)

    def test_kept_phases_are_sent(self) -> None:
        bench = FirmwareBench("smc")
        bench.twin.card.set_phases((3, 5, 7))
        assert bench.another_driver().poll(0).phases == (3, 5, 7)
