"""Motors that do not get on end a job within 3 s; what a person asked for may last."""

from dataclasses import replace

import pytest

from fraese import alarms
from fraese.control.patience import Patience
from fraese.control.state import Status
from fraese.errors import PortError
from fraese.motor.clock import VirtualClock
from fraese.motor.seams import Report
from tests.helpers import plant


def a_report() -> Report:
    return plant().controller._loop._queue.report


def waited_s(slice_s: float, look: Report, excused_until_s: float = 0, moves: bool = True) -> float:
    """How long it took until patience was over; 100: it was not."""
    clock = VirtualClock()
    patience = Patience(clock, slice_s)
    patience.begin()
    for number in range(round(100 / slice_s)):
        at_s = number * slice_s
        if patience.is_over(look, excused=at_s < excused_until_s):
            return at_s
        if moves:
            clock.pass_by(0)
            clock.wait_until(clock.now_ns() + round(slice_s * 1e9))
    return 100


@pytest.mark.parametrize("moves", [True, False])
@pytest.mark.parametrize("slice_s", [0.02, 0.1])
def test_it_is_over_soon_after_three_seconds(slice_s: float, moves: bool) -> None:
    assert waited_s(slice_s, a_report(), moves=moves) == pytest.approx(3, abs=2 * slice_s)


def test_a_wait_that_was_asked_for_does_not_count() -> None:
    assert waited_s(0.1, a_report(), excused_until_s=20) == pytest.approx(23, abs=0.3)


def test_an_edge_that_is_due_later_is_waited_for() -> None:
    assert waited_s(0.1, replace(a_report(), due_ns=30_000_000_000)) == pytest.approx(33, abs=0.3)


def test_time_in_which_the_program_was_stopped_is_no_wait() -> None:
    clock, look = VirtualClock(), a_report()
    patience = Patience(clock, 0.02)
    patience.begin()
    for _ in range(10):
        assert not patience.is_over(look, excused=False)
        clock.wait_until(clock.now_ns() + 60_000_000_000)


@pytest.mark.parametrize("state", [{"running": True}, {"held": True}, {}])
def test_a_driver_that_does_not_get_on_is_an_alarm(
    monkeypatch: pytest.MonkeyPatch, state: dict[str, bool]
) -> None:
    made = plant()
    controller = made.controller
    controller.jog("x", 5)
    driver = controller._loop._driver
    stuck = replace(driver.poll(0.05), due_ns=0, queued=1, **state)  # type: ignore[arg-type]
    since_ns = made.clock.now_ns()

    def poll(budget_s: float) -> Report:
        made.clock.wait_until(made.clock.now_ns() + round(budget_s * 1e9))
        return stuck

    monkeypatch.setattr(driver, "poll", poll)
    assert controller.run() is Status.ERROR
    alarm = controller._loop.alarm
    assert isinstance(alarm, PortError)
    assert alarm.kind is alarms.NO_PROGRESS
    assert (made.clock.now_ns() - since_ns) * 1e-9 < 3.5
    assert not any(controller.state().referenced)
