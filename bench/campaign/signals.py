"""Signals to command, app and step process, on the fake port; truth is the port's carriages.

After each: the motors are off within ``LIMIT_S``, no process is left, and where the next program
claims to stand is where the carriages are: to the step, where the step process had the last word,
within the bounds that are told where it died itself. Measured is how long after the signal the last
byte that switches the motors off was written.
"""

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import partial
from typing import Final

from bench.campaign.claims import claimed
from bench.campaign.frame import Attempt, Kind, Late, Outcome
from bench.campaign.warm import Warm
from fraese.motor.seams import DATA
from tests.rigs.lpt.fakeport import Event, library, missing
from tests.rigs.lpt.shop import Shop, child_of, is_alive
from tests.rigs.lpt.steps import MOTORS_OFF, check_motors_off
from tests.rigs.lpt.terminal import Terminal

#: From the signal to motors off; braking is part of it.
LIMIT_S: Final = 3.0
#: After the machine has begun to move the signal comes within this time.
_WITHIN_S: Final = 0.8
#: A jog in the app is over sooner.
_JOG_WITHIN_S: Final = 0.3
#: A program that is stopped goes on after at most this: below and above ``silent_s``.
_STOPPED_S: Final = 2.0
_PORTS: Final = ("ppdev", "devport")
#: They change nothing: the job goes on, and is ended in order.
_HARMLESS: Final = (signal.SIGPIPE, signal.SIGSTOP)

_ENDING: Final = (
    signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT, signal.SIGQUIT,
    signal.SIGPIPE, signal.SIGSTOP,
)  # fmt: skip
_TO_STEPS: Final = (
    signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGSTOP, signal.SIGQUIT,
    signal.SIGINT, signal.SIGPIPE,
)  # fmt: skip
#: Of these the step process takes no notice.
_UNHEARD: Final = (signal.SIGINT, signal.SIGPIPE)


def hit(pid: int, number: signal.Signals, chance: random.Random) -> int:
    """Send it; when that was, monotonic ns."""
    at_ns = time.monotonic_ns()
    os.kill(pid, number)
    if number is signal.SIGSTOP:
        time.sleep(chance.uniform(0, _STOPPED_S))
        os.kill(pid, signal.SIGCONT)
    if number in _HARMLESS:
        time.sleep(0.05)
        at_ns = time.monotonic_ns()
        os.kill(pid, signal.SIGTERM)
    return at_ns


def judged(shop: Shop, since_ns: int, *, to_the_step: bool) -> Outcome:
    """All is over: off, in time, and where it says.

    Args:
        shop: the machine.
        since_ns: when it was hit.
        to_the_step: a place is to be claimed; else bounds will do.
    """
    check_motors_off(shop.fake.writes())
    took_ms = max(0, _off_ns(shop.fake.events()) - since_ns) * 1e-6
    if took_ms > LIMIT_S * 1e3:
        raise Late(f"the motors were off only after {took_ms:.0f} ms")
    claim, truth_steps = claimed(shop), shop.travelled_steps()
    beyond = claim.beyond_steps(truth_steps) + (to_the_step and not claim.is_to_the_step)
    return Outcome(beyond, took_ms, f"claimed {claim}, true {truth_steps}" if beyond else "")


def _off_ns(events: Sequence[Event]) -> int:
    """When the last of the bytes was written that switch the motors off for good.

    The program of a step process that died writes them once more, in case it could not.
    """
    data = [event for event in events if event.what == "W" and event.register == DATA]
    current = max(n for n, event in enumerate(data) if event.value not in MOTORS_OFF)
    return data[current + len(MOTORS_OFF)].at_ns


def gone(shop: Shop, *pids: int) -> None:
    """Wait for the ends of these processes."""
    shop.fake.wait_for(lambda: not any(map(is_alive, pids)), timeout_s=2 * LIMIT_S)


def begin(attempt: Attempt) -> Shop:
    """A machine on a fake port of either kind; its commands begin at once."""
    return Shop(attempt.folder, attempt.random.choice(_PORTS), popen=Warm)


def to_command(number: signal.Signals, attempt: Attempt) -> Outcome:
    """The command gets it, in the middle of a move."""
    shop = begin(attempt)
    with shop.begun("run", "long.ngc", "--json") as command:
        child = child_of(command.pid)
        time.sleep(attempt.random.uniform(0, _WITHIN_S))
        at_ns = hit(command.pid, number, attempt.random)
        finish(command)
        gone(shop, child)
    return judged(shop, at_ns, to_the_step=True)


def to_steps(number: signal.Signals, attempt: Attempt) -> Outcome:
    """The step process gets it."""
    shop = begin(attempt)
    with shop.begun("run", "long.ngc", "--json") as command:
        child = child_of(command.pid)
        time.sleep(attempt.random.uniform(0, _WITHIN_S))
        at_ns = _hit_steps(child, number)
        finish(command)
        gone(shop, child)
    return judged(shop, at_ns, to_the_step=False)


def _hit_steps(child: int, number: signal.Signals) -> int:
    """Stopped it hangs, and is killed by its host; told to end it is after what changes nothing."""
    at_ns = time.monotonic_ns()
    os.kill(child, number)
    if number in _UNHEARD:
        time.sleep(0.05)
        at_ns = time.monotonic_ns()
        os.kill(child, signal.SIGTERM)
    return at_ns


def to_app(number: signal.Signals, attempt: Attempt) -> Outcome:
    """The app gets it, in the middle of a jog."""
    shop = begin(attempt)
    terminal = Terminal([sys.executable, "-m", "fraese"], shop.folder, shop.environment, Warm)
    try:
        terminal.wait_for("Hold")
        terminal.press("5", "right")
        shop.fake.wait_for(shop.is_under_way)
        child = child_of(terminal.process.pid)
        time.sleep(attempt.random.uniform(0, _JOG_WITHIN_S))
        at_ns = hit(terminal.process.pid, number, attempt.random)
        terminal.wait_for_end()
        gone(shop, child)
    finally:
        terminal.close()
    return judged(shop, at_ns, to_the_step=True)


def finish(command: "subprocess.Popen[str]") -> None:
    """Wait for the end of a command, which has nothing to say of the program's own faults."""
    _, noted = command.communicate(timeout=5 * LIMIT_S)
    assert "Traceback" not in noted, noted


def fake_port_missing() -> str:
    """Why there is no fake port; if there is one, it is built once, before all attempts."""
    why = missing()
    if not why:
        library()
    return why


_MEASURES: Final = "ms from the signal to motors off"


def _rows() -> list[Kind]:
    rows = [
        (f"{number.name} to the {whom}", partial(attempt, number))
        for whom, attempt, numbers in (
            ("command", to_command, _ENDING),
            ("app", to_app, _ENDING),
            ("step process", to_steps, _TO_STEPS),
        )
        for number in numbers
    ]
    return [Kind(name, _MEASURES, attempt, missing=fake_port_missing) for name, attempt in rows]


KINDS: Final = tuple(_rows())
