"""The StepDriver seam: one suite, every peer.

A rig is a driver, a clock to wait by, and a look at the carriages. For some peers time is virtual
and exact; for those that make their steps in another process it really passes, and a look comes
later than what it looks at.
"""

import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest

from fraese.blocks import Block, Outputs, Watch, WatchAction, dwell
from fraese.errors import StateError
from fraese.motor.seams import Ended, IdleLevel, Report, StepDriver, SwitchMode
from tests.bridge.device import reason_to_skip
from tests.bridge.firmwaremill import FirmwareBench
from tests.motor.distantmill import ChildBench
from tests.motor.workbench import EVERY_END, TRAVEL_STEPS, Workbench, end, line, steady

CAPACITY = 8
#: A move of nearly two seconds, and after how long it is looked at: a machine that is busy with
#: something else may take much longer for that, and must still find it under way.
LONG = 9000
UNDER_WAY_S = 0.15


@dataclass
class Rig:
    """A driver and what can be seen of it.

    Attributes:
        slack_s: how much later than it should anything may be seen.
    """

    driver: StepDriver
    bench: Workbench | ChildBench | FirmwareBench
    slack_s: float = 0.0

    def run(self, *blocks: Block) -> Report:
        for block in blocks:
            assert self.driver.push(block)
        report = self.driver.poll(0.01)
        while report.running:
            report = self.driver.poll(0.01)
        return report


def core_on(wiring: str) -> Rig:
    bench = Workbench(wiring, capacity=CAPACITY, outputs=True, safe_outputs=0b10)
    return Rig(bench.core, bench)


def child_on(wiring: str) -> Rig:
    bench = ChildBench(wiring, capacity=CAPACITY, safe_outputs=0b10)
    return Rig(bench.driver, bench, slack_s=0.05)


def bridge_on(wiring: str) -> Rig:
    if reason_to_skip():
        pytest.skip(reason_to_skip())
    bench = FirmwareBench(wiring, capacity=CAPACITY, safe_outputs=0b10)
    return Rig(bench.driver, bench, slack_s=0.01)


PEERS: dict[str, Callable[[], Rig]] = {
    "core on smc": lambda: core_on("smc"),
    "core on x4step": lambda: core_on("x4step"),
    "core on paper": lambda: core_on("paper"),
    "bridge on smc": lambda: bridge_on("smc"),
    "bridge on x4step": lambda: bridge_on("x4step"),
    "bridge on paper": lambda: bridge_on("paper"),
}
if sys.platform == "linux":
    PEERS["child on smc"] = lambda: child_on("smc")
    PEERS["child on x4step"] = lambda: child_on("x4step")


@pytest.fixture(params=PEERS)
def rig(request: pytest.FixtureRequest) -> Iterator[Rig]:
    rig = PEERS[request.param]()
    yield rig
    if isinstance(rig.bench, ChildBench):
        rig.bench.remove()


class TestStepDriverContract:
    def test_at_first_it_stands_without_current(self, rig: Rig) -> None:
        report = rig.driver.poll(0)
        assert report.position_steps == (0, 0, 0)
        assert report.ended is Ended.NOT
        states = (report.running, report.held, report.energised, report.switch_closed)
        assert not any(states)
        assert (report.free, report.queued, report.due_ns, report.rate_hz) == (CAPACITY, 0, 0, 0)

    def test_says_what_was_done(self, rig: Rig) -> None:
        report = rig.run(line(500, -200, 3, tag=7), line(-100, 0, 0, tag=9))
        assert report.position_steps == (400, -200, 3)
        assert report.travelled_steps == (600, 200, 3)
        assert report.ended is Ended.TARGET
        assert (report.playing, report.finished, report.tag, report.queued) == (2, 2, 9, 0)
        assert report.energised
        assert rig.bench.carriages() == (400, -200, 3)

    def test_a_full_queue_takes_nothing(self, rig: Rig) -> None:
        for _ in range(CAPACITY):
            assert rig.driver.push(steady(10))
        assert not rig.driver.push(steady(10))
        assert rig.driver.poll(0).queued == CAPACITY
        assert rig.run().position_steps == (10 * CAPACITY, 0, 0)

    def test_plays_no_longer_than_the_budget(self, rig: Rig) -> None:
        rig.driver.push(steady(1000, rate_hz=1000))
        rig.driver.poll(0.03)
        before = rig.driver.poll(0.1).position_steps[0]
        before_ns = rig.bench.clock.now_ns()
        after = rig.driver.poll(0.1).position_steps[0]
        took_s = (rig.bench.clock.now_ns() - before_ns) * 1e-9
        assert took_s == pytest.approx(0.1, abs=1e-6 + rig.slack_s)
        # In real time a step may come late, and the ones behind it with it.
        fewest = 0 if rig.slack_s else 1000 * took_s - 1
        assert fewest <= after - before <= 1000 * took_s + 1 + 1000 * rig.slack_s / 2

    def test_brake_keeps_the_queue_and_resume_goes_on(self, rig: Rig) -> None:
        rig.driver.push(line(LONG))
        rig.driver.push(line(0, 50))
        rig.driver.poll(UNDER_WAY_S)
        rig.driver.brake()
        report = rig.run()
        assert report.held
        assert report.queued == 2
        assert 0 < report.position_steps[0] < LONG
        assert not report.torn
        rig.driver.resume()
        report = rig.run()
        assert report.position_steps == (LONG, 50, 0)
        assert rig.bench.lost() == (0, 0, 0)

    def test_flush_at_standstill_only(self, rig: Rig) -> None:
        rig.driver.push(line(LONG))
        rig.driver.poll(UNDER_WAY_S)
        with pytest.raises(StateError):
            rig.driver.flush()
        rig.driver.brake()
        held = rig.run()
        rig.driver.flush()
        report = rig.driver.poll(0)
        assert (report.ended, report.queued, report.held) == (Ended.FLUSH, 0, False)
        assert report.position_steps == held.position_steps

    @pytest.mark.parametrize("made", [0, 600, 1750, 1900, 1990])
    def test_after_a_brake_and_a_flush_the_next_block_moves(self, rig: Rig, made: int) -> None:
        """Also when the brake came in the block's own braking, which begins at 1700."""
        rig.driver.push(line(2000))
        report = rig.driver.poll(0.001)
        while report.running and report.position_steps[0] < made:
            report = rig.driver.poll(0.001)
        rig.driver.brake()
        rig.run()
        rig.driver.flush()
        assert rig.run(line(0, 70)).position_steps[1] == 70

    def test_after_a_stop_and_a_flush_the_next_block_moves(self, rig: Rig) -> None:
        """Whether or not the end of the run was seen before."""
        rig.driver.push(line(LONG))
        rig.driver.poll(UNDER_WAY_S)
        rig.driver.stop()
        try:
            rig.driver.flush()
        except StateError:
            rig.run()
            rig.driver.flush()
        assert rig.run(line(0, 70)).position_steps[1] == 70

    def test_stop_drops_the_rest_and_owns_up(self, rig: Rig) -> None:
        rig.driver.push(line(LONG))
        rig.driver.push(line(100))
        rig.driver.poll(UNDER_WAY_S)
        rig.driver.stop()
        report = rig.run()
        assert (report.ended, report.queued, report.torn) == (Ended.STOP, 0, frozenset({0}))
        rig.bench.wait()
        assert rig.bench.carriage("x") + rig.bench.lost()[0] == report.position_steps[0]
        assert rig.run(line(5)).torn == frozenset()

    def test_only_what_was_played_to_its_end_is_finished(self, rig: Rig) -> None:
        rig.run(line(20), dwell(3, 0))
        for block in (line(LONG), line(0, 50), line(-7)):
            rig.driver.push(block)
        report = rig.driver.poll(UNDER_WAY_S)
        assert (report.playing, report.finished) == (3, 2)
        # Braked and dropped, half-way.
        rig.driver.brake()
        report = rig.run()
        assert (report.held, report.playing, report.finished) == (True, 3, 2)
        rig.driver.flush()
        report = rig.driver.poll(0)
        assert (report.queued, report.playing, report.finished) == (0, 5, 2)
        # Stopped dead, half-way.
        rig.driver.push(line(LONG))
        rig.driver.push(line(100))
        rig.driver.poll(UNDER_WAY_S)
        rig.driver.stop()
        report = rig.run()
        assert (report.queued, report.playing, report.finished) == (0, 7, 2)
        # Dropped before it began.
        rig.driver.push(line(5))
        rig.driver.stop()
        report = rig.run()
        assert (report.queued, report.playing, report.finished) == (0, 8, 2)
        report = rig.run(line(5), line(-5))
        assert (report.queued, report.playing, report.finished) == (0, 10, 4)

    def test_what_a_contact_or_a_watch_cuts_off_is_not_finished(self, rig: Rig) -> None:
        rig.bench.place("x", TRAVEL_STEPS - 30)
        report = rig.run(steady(10), steady(100), steady(1), steady(1))
        assert (report.ended, report.playing, report.finished) == (Ended.SWITCH, 4, 1)
        opens = Watch(0x80, 0x80, WatchAction.STOP)
        report = rig.run(steady(-100, watch=opens), steady(-1))
        assert (report.ended, report.playing, report.finished) == (Ended.WATCH, 6, 1)

    def test_brake_and_stop_come_from_any_thread(self, rig: Rig) -> None:
        for command, ended in ((rig.driver.brake, Ended.NOT), (rig.driver.stop, Ended.STOP)):
            rig.driver.push(line(LONG))
            rig.driver.poll(UNDER_WAY_S)
            thread = threading.Thread(target=command)
            thread.start()
            thread.join()
            report = rig.run()
            assert not report.running
            assert report.ended is ended

    def test_current_is_switched_off_at_standstill_only(self, rig: Rig) -> None:
        rig.driver.push(line(LONG))
        rig.driver.poll(UNDER_WAY_S)
        with pytest.raises(StateError):
            rig.driver.idle(IdleLevel.OFF)
        rig.driver.brake()
        rig.run()
        for level in IdleLevel:
            rig.driver.idle(level)
            assert not rig.driver.poll(0).energised
        rig.driver.resume()
        assert rig.run().position_steps == (LONG, 0, 0)
        assert rig.bench.lost() == (0, 0, 0)

    def test_dwells_take_their_time_and_move_nothing(self, rig: Rig) -> None:
        rig.run(steady(1))
        before_ns = rig.bench.clock.now_ns()
        report = rig.run(dwell(3, 0.345), dwell(3, 0))
        assert report.position_steps == (1, 0, 0)
        assert (rig.bench.clock.now_ns() - before_ns) * 1e-9 == pytest.approx(
            0.345, abs=0.011 + rig.slack_s
        )

    def test_a_contact_stops_or_is_ignored(self, rig: Rig) -> None:
        rig.bench.place("x", TRAVEL_STEPS - 30)
        report = rig.run(steady(100))
        assert (report.ended, report.candidates) == (Ended.SWITCH, frozenset({end("x+")}))
        assert 30 <= report.position_steps[0] < 35
        rig.driver.set_switch_mode(SwitchMode.IGNORE)
        report = rig.run(steady(-100))
        assert report.ended is Ended.TARGET
        assert not report.switch_closed

    def test_a_hand_at_a_switch_is_seen_at_standstill(self, rig: Rig) -> None:
        rig.bench.simulated.press(end("z-"))
        for _ in range(3):
            report = rig.driver.poll(0)
        assert report.candidates == EVERY_END

    def test_phases_are_told(self, rig: Rig) -> None:
        phases = rig.run(steady(3, -1)).phases
        assert len(phases) == 3
        assert phases != (0, 0, 0)
        assert rig.run(steady(-3, 1)).phases == (0, 0, 0)

    def test_outputs_change_at_the_first_tick_of_their_block(self, rig: Rig) -> None:
        rig.driver.set_outputs(0b01, 0b01)
        assert rig.bench.outputs_on() == {0}
        # A report may be some milliseconds old when it arrives: less than one of these ticks.
        rig.driver.push(steady(3, rate_hz=20))
        rig.driver.push(steady(30, rate_hz=20, outputs=Outputs(0b11, 0b10)))
        steps, seen_late = 0, False
        while not seen_late:
            before, outputs = steps, rig.bench.outputs_on()
            report = rig.driver.poll(0.001)
            steps = report.position_steps[0]
            # The look was after one report, and before the other one came.
            assert outputs == {0} or steps >= 3
            if before > 3:
                assert outputs == {1}
                seen_late = True
            assert report.running or seen_late

    def test_what_cannot_be_played_is_refused(self, rig: Rig) -> None:
        good = steady(10)
        for bad in (
            good._replace(steps=(10, 0)),
            good._replace(steps=(9, 0, 0)),
            good._replace(pieces=()),
            good._replace(pieces=(good.pieces[0]._replace(interval_q8=255),)),
            good._replace(pieces=(good.pieces[0]._replace(add_q8=-1_000_000),)),
        ):
            with pytest.raises(ValueError, match="a "):
                rig.driver.push(bad)
        assert rig.driver.poll(0).queued == 0

    def test_closed_twice_the_motors_are_off(self, rig: Rig) -> None:
        rig.driver.push(line(LONG))
        rig.driver.poll(UNDER_WAY_S)
        rig.driver.close()
        mark = rig.bench.mark()
        rig.driver.close()
        assert rig.bench.mark() == mark
        if rig.bench.wiring == "smc":
            assert set(rig.bench.currents()) == {(0, 0)}
