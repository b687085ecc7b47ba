"""The Clock seam: one suite, every peer."""

import time
from collections.abc import Callable

import pytest

from fraese.motor.clock import MonotonicClock, PacedClock, VirtualClock
from fraese.motor.realtime.clock import RealtimeClock
from fraese.motor.seams import Clock

#: Short, because most of the peers really wait.
WAIT_NS = 500_000

PEERS: dict[str, Callable[[], Clock]] = {
    "monotonic": MonotonicClock,
    "virtual": VirtualClock,
    "paced": PacedClock,
    "real-time": RealtimeClock,
}


@pytest.fixture(params=PEERS)
def clock(request: pytest.FixtureRequest) -> Clock:
    return PEERS[request.param]()


class TestClockContract:
    def test_never_goes_back(self, clock: Clock) -> None:
        seen = [clock.now_ns() for _ in range(50)]
        clock.wait_until(seen[-1] + WAIT_NS)
        seen.append(clock.now_ns())
        clock.wait_until(seen[0])
        seen.append(clock.now_ns())
        assert seen == sorted(seen)

    def test_returns_at_the_deadline_or_after_it_with_the_time_then(self, clock: Clock) -> None:
        deadline_ns = clock.now_ns() + WAIT_NS
        returned_ns = clock.wait_until(deadline_ns)
        assert deadline_ns <= returned_ns <= clock.now_ns()

    def test_a_deadline_that_has_passed_is_no_wait(self, clock: Clock) -> None:
        now_ns = clock.wait_until(clock.now_ns() + WAIT_NS)
        assert clock.wait_until(now_ns - WAIT_NS) >= now_ns
        assert clock.wait_until(now_ns) >= now_ns

    def test_time_is_whole_nanoseconds(self, clock: Clock) -> None:
        assert type(clock.now_ns()) is int
        assert type(clock.wait_until(clock.now_ns() + 1)) is int

    def test_time_that_others_waited_has_passed_here_too(self, clock: Clock) -> None:
        since_ns = clock.now_ns()
        time.sleep(WAIT_NS / 1e9)
        clock.pass_by(WAIT_NS)
        assert clock.now_ns() >= since_ns + WAIT_NS
