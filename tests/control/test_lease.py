"""The lease: as short as the disk allows, and what is handed over meanwhile."""

import threading
from dataclasses import replace

import pytest

from fraese.control.bounds import Span
from fraese.control.inforce import Asked
from fraese.control.lease import FOR_EVER_NS, LEAST_S, MOST_S, Lease
from fraese.control.recorder import JournalRecorder
from fraese.control.recordwriter import Done
from fraese.control.savedstate import SavedState
from fraese.machine import Steps
from fraese.planner.lines import plan_line, planned_s
from tests.helpers import plant

MACHINE = plant().controller.machine
_NS_PER_S = 1_000_000_000


def lease_after(*gaps_s: float, runs: bool = True) -> Lease:
    """Records that are asked for every 0.05 s, and become durable that much after the last one."""
    lease, asked_ns = Lease(), 0
    for gap_s in gaps_s:
        before_ns, asked_ns = asked_ns, asked_ns + _NS_PER_S // 20
        over_ns = asked_ns + 1 if runs else FOR_EVER_NS
        lease.saw(Done(Asked(None, asked_ns, over_ns, runs), before_ns + round(gap_s * _NS_PER_S)))
    return lease


def test_an_ordinary_disk_has_the_shortest_lease() -> None:
    assert lease_after(*[0.07] * 50).seconds == LEAST_S


def test_a_slow_disk_has_a_lease_of_twice_what_it_takes() -> None:
    assert lease_after(*[0.07] * 50, 0.26).seconds == pytest.approx(0.52, rel=0.01)
    assert lease_after(5.0, 5.0).seconds == MOST_S


def test_a_long_lead_has_a_long_lease() -> None:
    assert (Lease(0.3).seconds, Lease(1.0).seconds, Lease(10.0).seconds) == (LEAST_S, 0.5, MOST_S)


def test_a_record_that_comes_too_late_is_counted() -> None:
    lease = Lease()
    for asked_ms, done_ms in ((0, 10), (50, 140), (100, 160), (150, 500)):
        asked = Asked(None, asked_ms * 1_000_000, (asked_ms + 150) * 1_000_000, runs=True)
        lease.saw(Done(asked, done_ms * 1_000_000))
    assert lease.lapses == 1


def test_it_is_forgotten_by_and_by() -> None:
    minute = [0.07] * 20 * 60
    assert lease_after(0.07, 0.26, *minute).seconds == pytest.approx(0.26, rel=0.01)
    assert lease_after(0.07, 0.26, *minute, *minute).seconds == LEAST_S


def test_time_at_standstill_is_no_gap() -> None:
    lease = Lease()
    lease.saw(Done(Asked(None, 0, FOR_EVER_NS, runs=False), 10_000_000))
    later_ns = 60 * _NS_PER_S
    lease.saw(Done(Asked(None, later_ns, later_ns + 1, runs=True), later_ns + 10_000_000))
    assert lease.seconds == LEAST_S


class _Ahead:
    """A queue of one long block, and then of what is added."""

    def __init__(self) -> None:
        self.report = replace(plant().controller._queue.report)
        self.blocks: list[Span] = []

    def spans(self) -> tuple[Steps, list[Span]]:
        return (0, 0, 0), self.blocks

    def duration_s(self) -> float:
        return sum(span.duration_s for span in self.blocks)


def _span(x_steps: int) -> Span:
    block = plan_line(MACHINE, (x_steps, 0, 0), 600.0)
    assert block is not None
    return Span(block, block.ticks(), 0, planned_s(block))


def test_only_what_can_be_played_within_the_lease_waits_for_the_disk() -> None:
    now_ns = [_NS_PER_S]
    granted: list[int] = []
    written: list[SavedState] = []
    free = threading.Semaphore(1)

    def write(state: SavedState, durable: bool) -> None:
        assert free.acquire(timeout=5)
        written.append(state)

    queue = _Ahead()
    recorder = JournalRecorder(write, MACHINE, 0.03, lambda: now_ns[0], granted.append)
    recorder.attach(queue)
    where = plant().controller.position
    recorder.begin(lambda: SavedState.of(where, (0, 0, 0), ()))
    recorder.polls()
    long = _span(4000)
    recorder.before_motion([long])
    # Half an axis' travel was asked for; what is on the disk is what can be played of it by then.
    assert granted == [now_ns[0] + round(LEAST_S * 1e9)]
    (first,) = written
    assert first.motion is not None
    assert 300 < first.motion.high_steps[0] < 700
    assert first.motion.low_steps[0] == 0
    assert recorder.allows((4000, 0, 0), long)
    queue.blocks.append(long)
    # It is not begun before the lease is over: nobody waits.
    assert recorder.allows((0, 0, 0), _span(-4000))
    assert len(written) == 1
    # A short way that turns round is outside.
    queue.blocks[:] = [_span(20)]
    assert not recorder.allows((-3980, 0, 0), _span(-4000))
    assert not recorder.is_late
    queue.report = replace(queue.report, queued=1, running=True)
    now_ns[0] += round(LEAST_S * 1e9) + 1
    assert recorder.is_late
    free.release(2)
    recorder.wait(5)
    recorder._writer.close()
