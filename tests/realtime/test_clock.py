"""The clock of a process that does nothing but steps, in a time of our own."""

from dataclasses import dataclass, field
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fraese.motor.realtime.clock import (
    BREAK_NS,
    FORCE_NS,
    NAP_NS,
    NO_BREAK_NS,
    ROOM_NS,
    SPIN_NS,
    Interrupted,
    RealtimeClock,
)
from tests.realtime.room import Time


@dataclass
class Helper:
    """Has chores and wishes, and notes when they were asked for."""

    time: Time
    chores: int = 0
    chore_ns: int = 4_000
    wish_at_ns: int | None = None
    room_ns: int = ROOM_NS
    may_break: bool = True
    begun_ns: list[int] = field(default_factory=list)
    taken_ns: list[int] = field(default_factory=list)

    def has_wish(self) -> bool:
        return self.wish_at_ns is not None and self.time.now >= self.wish_at_ns

    def take_wishes(self) -> int:
        self.taken_ns.append(self.time.now)
        self.wish_at_ns = None
        return BREAK_NS if self.may_break else NO_BREAK_NS

    def chore(self) -> bool:
        self.begun_ns.append(self.time.now)
        if not self.chores:
            return False
        self.chores -= 1
        self.time.advance(self.chore_ns)
        return True


def put_together(
    chores: int = 0, chore_ns: int = 4_000, wish_at_ns: int | None = None
) -> tuple[Time, RealtimeClock, Helper]:
    time = Time(look_ns=100)
    clock = RealtimeClock(time.now_ns, time.sleep_s)
    clock.attendant = attendant = Helper(time, chores, chore_ns, wish_at_ns)
    return time, clock, attendant


@given(st.integers(0, 3_000_000), st.integers(0, 200), st.integers(100, 15_000))
def test_an_edge_is_never_early_and_no_chore_makes_it_late(
    ahead_ns: int, chores: int, chore_ns: int
) -> None:
    time, clock, helper = put_together(chores=chores, chore_ns=chore_ns)
    # A chore has just been done: none is forced.
    clock.wait_until(time.now + 2 * ROOM_NS)
    deadline_ns = time.now + ahead_ns
    helper.begun_ns.clear()
    now_ns = clock.wait_until(deadline_ns)
    assert deadline_ns <= now_ns <= max(deadline_ns, deadline_ns - ahead_ns) + 500
    assert all(deadline_ns - at > ROOM_NS for at in helper.begun_ns)


def test_a_chore_that_takes_long_waits_for_a_gap_but_not_for_ever() -> None:
    time, clock, helper = put_together(chores=100, chore_ns=80_000)
    helper.room_ns = 100_000
    clock.wait_until(time.now + 200_000)
    helper.begun_ns.clear()
    from_ns = time.now
    while time.now < from_ns + FORCE_NS - 500_000:
        clock.wait_until(time.now + 90_000)
    assert not helper.begun_ns
    for _ in range(10):
        clock.wait_until(time.now + 90_000)
    assert len(helper.begun_ns) == 1
    clock.wait_until(time.now + 200_000)
    assert len(helper.begun_ns) == 3


def test_a_long_wait_is_slept_in_naps_that_end_in_time() -> None:
    time, clock, _ = put_together()
    clock.wait_until(time.now + 3_000_000)
    assert max(time.naps_ns) <= NAP_NS
    assert sum(time.naps_ns) > 0.9 * (3_000_000 - SPIN_NS)
    assert time.naps_ended_ns[-1] <= 3_000_000 - SPIN_NS + 500


def test_a_wish_is_taken_up_even_when_the_tick_is_late_already() -> None:
    time, clock, helper = put_together(wish_at_ns=0)
    time.advance(1_000_000)
    clock.wait_until(500_000)
    assert len(helper.taken_ns) == 1


def test_a_long_wait_is_broken_off_for_a_wish_a_short_one_is_not() -> None:
    time, clock, helper = put_together(wish_at_ns=300_000)
    with pytest.raises(Interrupted):
        clock.wait_until(10_000_000)
    assert helper.taken_ns[0] < 300_000 + NAP_NS + 1_000
    helper.wish_at_ns = time.now + 100_000
    deadline_ns = time.now + BREAK_NS
    assert clock.wait_until(deadline_ns) >= deadline_ns
    assert len(helper.taken_ns) == 2


def test_where_the_core_must_not_be_interrupted_it_is_not() -> None:
    _, clock, helper = put_together(wish_at_ns=300_000)
    helper.may_break = False
    assert clock.wait_until(10_000_000) >= 10_000_000
    assert helper.taken_ns


def test_without_any_time_a_chore_is_still_done_now_and_then() -> None:
    time, clock, helper = put_together(chores=1_000_000, chore_ns=3_000)
    for _ in range(10_000):
        clock.wait_until(time.now + 7_500)
    gaps_ns = [b - a for a, b in pairwise(helper.begun_ns)]
    assert len(gaps_ns) >= 5
    assert all(FORCE_NS < gap <= FORCE_NS + 20_000 for gap in gaps_ns)
