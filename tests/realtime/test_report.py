"""The report under its sequence lock says what the core's own report says."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.blocks import Watch, WatchAction
from fraese.motor.realtime import memory as shared
from fraese.motor.realtime.memory import Memory
from fraese.motor.realtime.report import Reporter, read
from fraese.motor.seams import SwitchMode
from tests.motor.workbench import TRAVEL_STEPS, Workbench, line, steady


@pytest.fixture(scope="module")
def memory() -> Memory:
    return Memory(shared.create())


def same(bench: Workbench, memory: Memory) -> None:
    """What the child tells, but for what only the parent knows, is the core's own report."""
    own = bench.report()
    Reporter(bench.core, memory).write(echo=7, due_ns=own.due_ns)
    told = read(memory)
    assert told is not None
    in_hand = bench.core.run.track.cursor is not None
    assert told.echo == 7
    assert told.report == replace(own, free=0, queued=int(in_hand))


class TestReport:
    def test_at_first(self, memory: Memory) -> None:
        same(Workbench(), memory)

    @given(st.floats(0.001, 0.6), st.sampled_from(["smc", "x4step", "paper"]))
    def test_at_any_moment_of_a_run(self, memory: Memory, seconds: float, wiring: str) -> None:
        bench = Workbench(wiring)
        bench.run_for(seconds, line(900, -333, 2, tag=-4), line(-1, 200, 0), steady(0, 0, 9))
        same(bench, memory)

    def test_held_in_a_block(self, memory: Memory) -> None:
        bench = Workbench()
        bench.run_for(0.2, line(3000))
        bench.core.brake()
        bench.run()
        assert bench.report().held
        same(bench, memory)

    def test_after_a_contact_and_a_dead_stop(self, memory: Memory) -> None:
        bench = Workbench()
        bench.place("x", TRAVEL_STEPS - 30)
        bench.run(line(300, 300, rate_hz=5000, entry_hz=5000))
        assert bench.report().torn
        assert len(bench.report().candidates) == 2
        same(bench, memory)

    def test_after_a_watch(self, memory: Memory) -> None:
        bench = Workbench()
        bench.core.set_switch_mode(SwitchMode.IGNORE)
        bench.place("y", TRAVEL_STEPS - 30)
        bench.run(steady(0, 100, watch=Watch(0x80, 0, WatchAction.STOP)))
        assert bench.report().latched_steps
        same(bench, memory)


class TestSequence:
    def test_a_report_that_is_being_written_is_not_read(self, memory: Memory) -> None:
        Reporter(Workbench().core, memory).write(echo=1)
        memory.words[shared.REPORT_SEQUENCE] += 1
        assert read(memory) is None
        memory.words[shared.REPORT_SEQUENCE] += 1
        assert read(memory) is not None

    def test_one_that_was_begun_is_given_up_for_a_later_one(self, memory: Memory) -> None:
        bench = Workbench()
        reporter = Reporter(bench.core, memory)
        for taken in range(3):
            bench.run_for(0.05, line(50))
            begun = reporter.steps(1, due_ns=5)
            for _ in range(taken + 1):
                next(begun, None)
            bench.run()
            reporter.write(echo=2)
            later = read(memory)
            assert list(begun) == []
            assert read(memory) == later
            assert reporter.echo == 2
            assert later is not None
            assert later.report.position_steps == bench.report().position_steps

    def test_what_is_written_in_steps_is_seen_whole_or_not_at_all(self, memory: Memory) -> None:
        bench = Workbench()
        reporter = Reporter(bench.core, memory)
        reporter.write(echo=1)
        before = read(memory)
        bench.run_for(0.1, line(900))
        for _ in reporter.steps(2, due_ns=5):
            bench.run_for(0.01)
            assert read(memory) in (before, None)
        after = read(memory)
        assert after is not None
        # Of the moment in which it was begun, though the motors ran on.
        assert 0 < after.report.position_steps[0] < bench.report().position_steps[0]
