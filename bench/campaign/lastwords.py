"""Hosts killed at random moments, and what their step processes leave; truth: the fake port."""

import time
from pathlib import Path
from typing import Final

from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.signals import fake_port_missing
from bench.campaign.wordhost import TOKEN
from fraese.motor.realtime.lastwords import read
from tests.rigs.lpt.fakeport import FakePort
from tests.rigs.lpt.steps import check_motors_off

_TRAVEL_STEPS: Final = 2_000_000


def killed(attempt: Attempt) -> Outcome:
    """SIGKILL to a host; the words are there when its step process is gone, and true."""
    fake, words_at = FakePort(attempt.folder), attempt.folder / "words"
    fake.mount("smc", [_TRAVEL_STEPS] * 3)
    port = attempt.random.choice(("ppdev", "devport"))
    seed = str(attempt.random.random())
    host = fake.start("bench.campaign.wordhost", port, str(words_at), seed)
    try:
        assert host.stdout is not None
        child = Path("/proc") / host.stdout.readline().strip()
        time.sleep(attempt.random.uniform(0, 1.5))
        killed_ns = time.monotonic_ns()
        host.kill()
        fake.wait_for(lambda: not child.exists())
    finally:
        host.kill()
        host.communicate()
    check_motors_off(fake.writes())
    took_ms = (fake.events()[-1].at_ns - killed_ns) * 1e-6
    words = read(words_at)
    assert words is not None, "it has left nothing"
    assert words.token == TOKEN
    true_steps = tuple(at - _TRAVEL_STEPS // 2 for at in fake.carriages_steps())
    off = sum(abs(a - b) for a, b in zip(words.position_steps, true_steps, strict=True))
    return Outcome(off, took_ms, f"{words.position_steps} left, true {true_steps}")


KINDS: Final = (
    Kind(
        "SIGKILL to a host, last words of its step process",
        "ms from the signal to motors off",
        killed,
        missing=fake_port_missing,
    ),
)
