"""What the device's few numbers mean, beside a core that counts for itself."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fraese.blocks import dwell
from fraese.motor.bridge.account import Account
from fraese.motor.bridge.codec import Ack, Place, Status
from fraese.motor.bridge.constants import More, State
from tests.motor.workbench import EVERY_END, Workbench, ends, steady

NOWHERE = Place(0, 0, 0)
AT_REST = Status(
    ack=Ack(0, 1, False, 0, 900, 0, 0),
    state=State(0),
    more=More(0),
    ended=0,
    place=NOWHERE,
    last=0,
    interval_cycles=0,
    inputs=0,
    latched=NOWHERE,
    contact_serial=0,
    contact_oldest=0,
    late_ticks=0,
    dry_queues=0,
    late_throttle=0,
    line_errors=0,
    brakes=0,
    stops=0,
    override_q8=256,
    phases=(0, 0, 0, 0),
    torn_serial=0,
)


def at(serial: int, done: int, moved: int = 0, *, in_hand: bool = True, last: int = 0) -> Status:
    more = More.IN_HAND if in_hand else More(0)
    return replace(AT_REST, place=Place(serial, done, moved), more=more, last=last or serial)


def see(account: Account, status: Status, *, dropped: bool = False) -> Account:
    account.see(status, dropped=dropped)
    return account


def test_at_first_nothing_was_done() -> None:
    account = see(Account(3), AT_REST)
    assert account.counts.position == (0, 0, 0)
    assert (account.playing, account.tick, account.queued, account.tag) == (0, 0, 0, 0)


@settings(max_examples=40, deadline=None)
@given(
    steps=st.tuples(st.integers(-40, 40), st.integers(-40, 40), st.integers(-40, 40)).filter(any),
    tick=st.integers(0, 40),
)
def test_counts_are_those_of_a_core_at_the_same_tick(
    steps: tuple[int, int, int], tick: int
) -> None:
    bench = Workbench()
    report = bench.run_until_tick(tick, steady(*steps), steady(1))
    account = Account(3)
    account.push(steady(*steps))
    account.push(steady(1))
    # At the end the device still tells how far it came.
    done = report.tick if report.queued else 1
    see(account, at(report.playing, done, in_hand=report.queued > 0))
    assert account.counts.position == report.position_steps
    assert account.counts.travelled == report.travelled_steps
    assert (account.playing, account.finished, account.tick, account.queued) == (
        report.playing,
        report.finished,
        report.tick,
        report.queued,
    )


def test_a_motor_may_be_ahead_within_its_tick() -> None:
    account = Account(3)
    account.push(steady(10, -7, 3))
    before = see(account, at(1, 4)).counts.position
    after = see(account, at(1, 4, moved=0b010)).counts.position
    assert after == (before[0], before[1] - 1, before[2])


def test_what_lies_after_the_place_of_a_drop_never_was() -> None:
    account = Account(3)
    for _ in range(5):
        account.push(steady(10, tag=3))
    see(account, at(2, 4, in_hand=False, last=4), dropped=True)
    assert account.counts.position == (14, 0, 0)
    assert (account.playing, account.queued, account.pushed, account.tag) == (5, 0, 5, 3)
    assert account.finished == 1
    # The device has counted four records; the next one is its fifth.
    assert account.push(steady(-4, tag=6)) == 6
    see(account, at(2, 4, in_hand=False, last=4))
    assert (account.counts.position, account.queued, account.finished) == ((14, 0, 0), 1, 1)
    see(account, at(5, 4, in_hand=False))
    assert account.counts.position == (10, 0, 0)
    assert (account.playing, account.queued, account.tag, account.finished) == (6, 0, 6, 2)


def test_serials_begin_again_after_65535() -> None:
    account = Account(3)
    for serial in range(1, 65_600):
        account.push(steady(1))
        see(account, at(serial & 0xFFFF, 1, in_hand=False))
    assert account.counts.position == (65_599, 0, 0)
    assert (account.playing, account.finished) == (65_599, 65_599)


def test_dwells_and_bare_outputs_move_nothing() -> None:
    account = Account(3)
    account.push(dwell(3, 0.5))
    account.push(dwell(3, 0))
    assert see(account, at(1, 7)).counts.position == (0, 0, 0)
    assert not account.moves or account.queued
    assert see(account, at(2, 0, in_hand=False)).counts.position == (0, 0, 0)


def contact(status: Status, serial: int, oldest: int) -> Status:
    return replace(
        status, contact_serial=serial, contact_oldest=oldest, more=status.more | More.CONTACT
    )


@pytest.fixture
def three_ways() -> Account:
    account = Account(3)
    for block in (steady(10), steady(0, -10), steady(0, 0, 10)):
        account.push(block)
    return account


@pytest.mark.parametrize(
    ("serial", "oldest", "expected"),
    [
        (2, 2, ends("y-")),
        (2, 1, ends("x+", "y-")),
        (3, 1, ends("x+", "y-", "z+")),
        # Nothing had moved for long: a hand at a switch.
        (2, 3, EVERY_END),
        (0, 0, EVERY_END),
    ],
)
def test_candidates_are_the_ends_that_were_moved_towards(
    three_ways: Account, serial: int, oldest: int, expected: frozenset[object]
) -> None:
    see(three_ways, contact(at(3, 10, in_hand=False), serial, oldest))
    assert three_ways.candidates == expected
    see(three_ways, at(3, 10, in_hand=False))
    assert three_ways.candidates == frozenset()


def test_a_contact_that_ended_the_run_is_named_by_the_old_serials(three_ways: Account) -> None:
    see(three_ways, contact(at(2, 5, in_hand=False, last=3), 2, 2), dropped=True)
    three_ways.push(steady(0, 10))
    see(three_ways, contact(at(4, 1), 2, 2))
    assert three_ways.candidates == ends("y-")


def test_the_block_in_hand_is_among_them_after_a_hold(three_ways: Account) -> None:
    see(three_ways, contact(at(2, 5), 2, 3))
    assert three_ways.candidates == ends("y-")


def test_latched_counts_are_kept_while_the_device_keeps_them(three_ways: Account) -> None:
    latched = replace(at(2, 9), state=State.LATCHED | State.MOVING, latched=Place(2, 6, 0b010))
    assert see(three_ways, latched).latched_steps == (10, -7, 0)
    see(three_ways, replace(latched, place=Place(3, 1, 0)))
    assert three_ways.latched_steps == (10, -7, 0)
    assert see(three_ways, at(3, 2)).latched_steps is None


def test_torn_are_the_motors_of_the_last_tick(three_ways: Account) -> None:
    torn = replace(at(3, 0, in_hand=False), state=State.TORN, torn_serial=2)
    assert see(three_ways, torn).torn == {1}


def test_bounds_hold_all_that_may_still_have_been_played(three_ways: Account) -> None:
    three_ways.push(steady(-30))
    see(three_ways, at(1, 4))
    assert three_ways.bounds() == ((-20, 10), (-10, 0), (0, 10))
