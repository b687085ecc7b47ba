"""Hosts killed at random moments, and what their step processes leave; truth: the fake port.

host killed --> step process brakes, leaves words --> next command: "X 12.345", to the step
                              words lost, damaged --> next command: "between X 11 and X 14"
"""

import os
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random
from typing import Final

from bench.campaign.claims import NO_WIDER_S, claim_of
from bench.campaign.frame import Attempt, Kind, Outcome
from bench.campaign.signals import fake_port_missing
from bench.campaign.warm import Warm
from bench.campaign.wordhost import TOKEN
from fraese.motor.realtime.lastwords import SIZE, read
from tests.rigs.lpt.fakeport import FakePort, writes
from tests.rigs.lpt.shop import Shop, child_of, is_alive
from tests.rigs.lpt.steps import check_motors_off, steps_made
from tests.rigs.lpt.terminal import Terminal

_TRAVEL_STEPS: Final = 2_000_000
_PORTS: Final = ("ppdev", "devport")
#: After the machine has begun to move the signal comes within this time.
_WITHIN_S: Final = 1.5
#: A jog in the app is over sooner.
_JOG_WITHIN_S: Final = 0.3
#: The rate before the signal is that of so long.
_WINDOW_NS: Final = 200_000_000
#: Two axes move together in the program.
_MOVING: Final = 2


def killed(attempt: Attempt) -> Outcome:
    """SIGKILL to a host; the words are there when its step process is gone, and true."""
    fake, words_at = FakePort(attempt.folder), attempt.folder / "words"
    fake.mount("smc", [_TRAVEL_STEPS] * 3)
    seed = str(attempt.random.random())
    port = attempt.random.choice(_PORTS)
    host = fake.start("bench.campaign.wordhost", port, str(words_at), seed, popen=Warm)
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


def command_killed(shop: Shop, chance: Random) -> int:
    """SIGKILL to a command in a program; its step process, which may still brake."""
    with shop.begun("run", "long.ngc") as command:
        child = child_of(command.pid)
        time.sleep(chance.uniform(0, _WITHIN_S))
        command.kill()
    return child


def app_killed(shop: Shop, chance: Random) -> int:
    """SIGKILL to the app in a jog; likewise."""
    terminal = Terminal([sys.executable, "-m", "fraese"], shop.folder, shop.environment, Warm)
    try:
        terminal.wait_for("Hold")
        terminal.press("5", "right")
        shop.fake.wait_for(shop.is_under_way)
        child = child_of(terminal.process.pid)
        time.sleep(chance.uniform(0, _JOG_WITHIN_S))
        terminal.process.kill()
        terminal.wait_for_end()
    finally:
        terminal.close()
    return child


def known_to_the_next(kill: Callable[[Shop, Random], int], attempt: Attempt) -> Outcome:
    """Whoever comes next says the place to the step: a command that looks, or one that drives.

    The one that drives may come while the step process still brakes, and waits for it.
    """
    shop, chance = Shop(attempt.folder, attempt.random.choice(_PORTS), popen=Warm), attempt.random
    child = kill(shop, chance)
    drives = chance.random() < 0.5
    if not drives or chance.random() < 0.5:
        shop.fake.wait_for(lambda: not is_alive(child))
    since_s = time.monotonic()
    words = ("move", "X0", "--relative") if drives else ("where",)
    claim = claim_of(shop.command(*words, "--json"))
    took_s = time.monotonic() - since_s
    at_port = [event.pid for event in shop.fake.events()]
    assert at_port == sorted(at_port, key=child.__ne__), "two processes had the port"
    check_motors_off(shop.fake.writes())
    true_steps = shop.travelled_steps()
    off = claim.beyond_steps(true_steps) + (not claim.is_to_the_step)
    return Outcome(off, took_s, f"{words[0]} claims {claim}, true {true_steps}")


def words_lost(attempt: Attempt) -> Outcome:
    """The words are lost or damaged: the bounds hold, and nothing narrower is claimed."""
    shop, chance = Shop(attempt.folder, attempt.random.choice(_PORTS), popen=Warm), attempt.random
    child = command_killed(shop, chance)
    killed_ns = time.monotonic_ns()
    shop.fake.wait_for(lambda: not is_alive(child))
    (path,) = (shop.folder / "user-state/fraese").glob("*.words")
    spoil(path, chance)
    claim, true_steps = claim_of(shop.command("where", "--json")), shop.travelled_steps()
    before = [event for event in shop.fake.events() if -_WINDOW_NS < event.at_ns - killed_ns < 0]
    rate_hz = steps_made("smc", writes(before)) / _MOVING / _WINDOW_NS * 1e9
    off = claim.beyond_steps(true_steps) + claim.is_to_the_step + (claim.low_steps is None)
    return Outcome(off, claim.width_s(rate_hz), f"claimed {claim}, true {true_steps}")


def spoil(path: Path, chance: Random) -> None:
    """One bit is another one, or a part is missing, or all of it."""
    at, bit, data = chance.randrange(SIZE), 1 << chance.randrange(8), path.read_bytes()
    spoiled = chance.choice(
        (data[:at] + bytes((data[at] ^ bit,)) + data[at + 1 :], data[:at], None)
    )
    if spoiled is None:
        os.unlink(path)
    else:
        path.write_bytes(spoiled)


_MEASURES: Final = "s until the next command has said so"
KINDS: Final = (
    Kind("SIGKILL to a host, last words of its step process",
         "ms from the signal to motors off", killed, missing=fake_port_missing),
    Kind("SIGKILL to the command, claimed by last words", _MEASURES,
         partial(known_to_the_next, command_killed), missing=fake_port_missing),
    Kind("SIGKILL to the app, claimed by last words", _MEASURES,
         partial(known_to_the_next, app_killed), missing=fake_port_missing),
    Kind("SIGKILL to the command, last words lost",
         f"s of motion between the bounds ({NO_WIDER_S:g} wanted)", words_lost,
         missing=fake_port_missing),
)  # fmt: skip
