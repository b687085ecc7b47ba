"""The bridge: a line that loses and doubles, a device that is believed only where it must be."""

from typing import Final

from bench.mutants.mutant import Mutant, tests_of

_B: Final = "fraese/motor/bridge/"
_T: Final = "tests/bridge/"
_LINK: Final = (_T + "test_link.py",)
_ACCOUNT: Final = (_T + "test_account.py",)
_DRIVER: Final = (_T + "test_driver.py",)

MUTANTS: Final = (
    Mutant(
        "bridge/link: every GAP is a loss of its own",
        "a line that lost one frame is flooded until the queue runs dry",
        _B + "link.py",
        "GAP_DEAF_NS: Final = 10_000_000",
        "GAP_DEAF_NS: Final = 0",
        _LINK,
    ),
    Mutant(
        "bridge/link: deaf to GAPs for a second",
        "what is lost twice is repaired only when the patience is at its end",
        _B + "link.py",
        "GAP_DEAF_NS: Final = 10_000_000",
        "GAP_DEAF_NS: Final = 1_000_000_000",
        _LINK,
    ),
    Mutant(
        "bridge/link: the window is no limit",
        "a device that is busy with steps loses what it has no room for",
        _B + "link.py",
        "if used and used + len(flying.data) > self._window:",
        "if False:",
        _LINK,
    ),
    Mutant(
        "bridge/link: the window is not narrowed after a loss",
        "a device that is busy with steps is given more to read, not less",
        _B + "link.py",
        "self._window = max(_LEAST_WINDOW, self._window // 2)",
        "self._window = self._window",
        _LINK,
    ),
    Mutant(
        "bridge/link: credit is no limit",
        "blocks are sent to a full ring, again and again",
        _B + "link.py",
        'return bytes(self._backlog[:size]) if size <= self.credit else b""',
        "return bytes(self._backlog[:size])",
        _LINK,
    ),
    Mutant(
        "bridge/link: a stranger is believed",
        "after a reset of the device its positions are taken for ours",
        _B + "link.py",
        "if ack.session != self._session:",
        "if False:",
        _LINK,
    ),
    Mutant(
        "bridge/link: a wish is said once",
        "a brake that was damaged on the line is lost",
        _B + "link.py",
        "if now_ns - wish.said_ns >= WISH_NS:",
        "if False:",
        _LINK,
    ),
    Mutant(
        "bridge/link: a wish is over when anything answers",
        "a stop that was damaged on the line is lost",
        _B + "link.py",
        "if _count(status, wish.byte) != wish.count:",
        "if True:",
        _LINK,
    ),
    Mutant(
        "bridge/session: a pause of this program counts as the device's",
        "a terminal that was stopped for a while ends as an alarm, with the axes unreferenced",
        _B + "session.py",
        "min(now_ns - since_ns, _PAUSE_NS)",
        "now_ns - since_ns",
        (_T + "test_session.py",),
    ),
    Mutant(
        "bridge/session: an answer from before the question counts",
        "a report of before the stop is taken for one of after it",
        _B + "session.py",
        "if link.heard != heard and link.answered >= ticket:",
        "if link.status is not None:",
        tests_of(
            "bridge/test_driver.py",
            "TestQueue::test_more_than_the_ring_holds_is_kept_here_and_played_in_order",
        ),
    ),
    Mutant(
        "bridge/session: a silent device is waited for",
        "a lost line is not noticed",
        _B + "session.py",
        "if self._silent_s > DEAF_S:",
        "if False:",
        (_T + "test_session.py",),
        limit_s=30,
    ),
    Mutant(
        "bridge/account: a drop is no new begin of counting",
        "after a stop the position goes on from blocks that were never played",
        _B + "account.py",
        "self._settled_counts = self._end_counts = self.counts\n        self._in_hand = None\n",
        "self._settled_counts = self.counts\n        self._in_hand = None\n",
        _ACCOUNT,
    ),
    Mutant(
        "bridge/account: dropped blocks are still known by their numbers",
        "a report after a stop is read as one of a dropped block",
        _B + "account.py",
        "            self._by_serial.pop(self._sent.pop().serial, None)\n",
        "            self._sent.pop()\n",
        tests_of("bridge/test_driver.py", "TestQueue::test_stop_drops_what_is_still_on_its_way"),
    ),
    Mutant(
        "bridge/account: motors ahead in their tick are not counted",
        "a stop in the middle of a tick leaves the position a step off",
        _B + "account.py",
        "(moved >> motor & 1)",
        "0",
        _ACCOUNT,
    ),
    Mutant(
        "bridge/account: nobody is torn",
        "after a stop without ramp the position still counts as right",
        _B + "account.py",
        "        return frozenset(motor for motor, n in enumerate(steps) if n)\n",
        "        return frozenset()\n",
        _ACCOUNT,
    ),
    Mutant(
        "bridge/account: the latched place is that of the report",
        "machine zero is off by the braking distance",
        _B + "account.py",
        "place = status.latched\n",
        "place = status.place\n",
        _ACCOUNT,
    ),
    Mutant(
        "bridge/driver: what is on its way after a stop is played",
        "motors start again after a stop",
        _B + "driver.py",
        "            if self._picture.account.queued:\n",
        "            if False:\n",
        tests_of(
            "bridge/test_driver.py",
            "TestQueue::test_stop_drops_what_is_still_on_its_way",
            "TestQueue::test_stop_at_standstill_drops_what_was_pushed",
        ),
    ),
    Mutant(
        "bridge/driver: the stream goes on after a drop",
        "rest of a dropped path is played",
        _B + "driver.py",
        "link.epoch = status.ack.epoch\n            session.link.drop_stream()\n",
        "link.epoch = status.ack.epoch\n",
        tests_of("bridge/test_driver.py", "TestQueue::test_stop_drops_what_is_still_on_its_way"),
    ),
    Mutant(
        "bridge/driver: a resume overtakes a brake",
        "the motors stay held, or go on against the operator's last word",
        _B + "driver.py",
        "            self._confirm_shouts(session)\n            session.command(c.KIND_RESUME)\n",
        "            session.command(c.KIND_RESUME)\n",
        tests_of("bridge/test_driver.py", "TestBrake"),
    ),
    Mutant(
        "bridge/outbox: limits are not said again after a drop",
        "blocks after a stop are braked with the limits of others",
        _B + "outbox.py",
        '        """The queue was dropped."""\n        self._carried = _UNKNOWN\n',
        '        """The queue was dropped."""\n',
        tests_of(
            "bridge/test_driver.py", "TestQueue::test_limits_are_known_after_a_queue_was_dropped"
        ),
    ),
    Mutant(
        "bridge/outbox: the horizon outlives standstill",
        "braking begins where blocks of an earlier run would have needed it",
        _B + "outbox.py",
        "        self._horizon.reset()\n",
        "        pass\n",
        tests_of("bridge/test_driver.py", "TestQueue"),
    ),
    Mutant(
        "bridge/records: the start/stop rate is the block's own",
        "a hold takes minutes, or leaps",
        _B + "records.py",
        "return max(1, block.jump_rate_q8, isqrt(block.accel_q * _FROM_REST) >> 2)",
        "return max(1, block.jump_rate_q8)",
        tests_of("bridge/test_codec.py", "test_limits_are_those_that_the_throttle_works_with"),
    ),
    Mutant(
        "bridge/greeting: motors left moving are not braked",
        "a program takes over a machine that runs",
        _B + "greeting.py",
        "        if reply.moving:\n            reply = yield from self._calmed(session)\n",
        "",
        tests_of(
            "bridge/test_driver.py",
            "TestLives::test_a_host_that_comes_back_to_moving_motors_brakes_them",
        ),
    ),
    Mutant(
        "bridge/greeting: any version will do",
        "a firmware that means something else by these bytes is told to move",
        _B + "greeting.py",
        "        if reply.version != PROTOCOL_VERSION:\n            raise",
        "        if False:\n            raise",
        ("tests/bridge/test_greeting.py",),
    ),
)
