"""Blocks on their way into the record stream, without a line."""

from fraese.motor.bridge.link import Link
from fraese.motor.bridge.outbox import Outbox
from tests.motor.workbench import steady


def test_what_was_before_standstill_is_no_way_to_brake_in() -> None:
    """A short block at speed: it must brake from its begin, and not in one that was played."""
    at_speed = steady(60, rate_hz=5000, ends_at_rest=False)
    used, fresh = Outbox(Link(1, 2000), 1000), Outbox(Link(1, 2000), 1000)
    used.record(at_speed, 1)
    assert used.record(at_speed, 2) != fresh.record(at_speed, 2)
    used.restart()
    fresh.restart()
    assert used.record(at_speed, 3) == fresh.record(at_speed, 3)
