"""Signals while nobody reads the terminal: stopped with Ctrl+S, stalled, or its window closed.

On the fake port, where each write has its time: braking begins within ``BRAKES_MS``, the process is
gone within ``GONE_S`` with the exit code that it owes, the motors are off, and where the next
program claims to stand is where the carriages are. On the paced simulated mill: gone, with that
code, and a place that is known.
"""

import os
import signal
import statistics
import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final

from bench.campaign.claims import claimed
from bench.campaign.frame import Attempt, Kind, Late, Outcome
from bench.campaign.warm import Warm
from tests.rigs.lpt.fakeport import Event, library, missing
from tests.rigs.lpt.shop import Shop, child_of, is_alive
from tests.rigs.lpt.steps import check_motors_off
from tests.terminals import Pty

BRAKES_MS: Final = 100.0
GONE_S: Final = 3.0
_MANY: Final = 200
_WITHIN_S: Final = 1.0
_JOG: Final = "[jog]\nfeed_mm_min = 300\n"
_FRAESE: Final = (sys.executable, "-m", "fraese")
_WINDOW_NS: Final = 10_000_000
#: Of the rate before it; a braking motor is soon below, a late tick is not for long.
_SLOWER: Final = 0.85
_SIGNALS: Final = (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
_CANCELLED: Final = 130
_QUIT: Final = b"\x11"
#: Rows and columns.
_SIZES: Final = ((0, 0), (0, 0), (1, 1), (0, 80), (24, 0), (300, 1), (1, 300))


def _environment(also: Mapping[str, str]) -> dict[str, str]:
    return {**also, "TERM": "xterm-256color"}


def stall(app: Pty) -> None:
    """Pictures until there is no room for another: two fill a terminal."""
    for _ in range(6):
        app.type(b"v")
        time.sleep(0.1)


def braking_begun_ms(events: Sequence[Event], at_ns: int) -> float:
    """From the signal to the last moment at which the motors were as fast as before it, ms."""
    steps_ns = [event.at_ns for event in events if event.what == "W"]
    before = [_in_window(steps_ns, at_ns - back * _WINDOW_NS) for back in range(1, 6)]
    usual = statistics.median(before)
    last_ns = at_ns
    at = at_ns + _WINDOW_NS
    while at <= steps_ns[-1]:
        if _in_window(steps_ns, at - _WINDOW_NS) >= _SLOWER * usual:
            last_ns = at
        at += _WINDOW_NS // 2
    return (last_ns - at_ns) * 1e-6


def _in_window(steps_ns: Sequence[int], from_ns: int) -> int:
    return sum(from_ns <= step_ns < from_ns + _WINDOW_NS for step_ns in steps_ns)


def _end(pty: Pty, number: signal.Signals | None) -> tuple[int, float, int]:
    """Signal or closed window; when, how long until it was gone in ms, and its exit code."""
    at_ns = time.monotonic_ns()
    if number is None:
        pty.hang_up()
    else:
        pty.process.send_signal(number)
    code = pty.end(reading=False, within_s=3 * GONE_S)
    gone_ms = (time.monotonic_ns() - at_ns) * 1e-6
    if gone_ms > GONE_S * 1e3:
        raise Late(f"gone only after {gone_ms:.0f} ms")
    return at_ns, gone_ms, code


def _owed(number: signal.Signals | None, *, by_app: bool) -> tuple[int, ...]:
    if not by_app:
        return (_CANCELLED,)
    if number is None:
        # Whatever is noticed first.
        return (128 + signal.SIGHUP, 128 + signal.SIGTERM)
    return (128 + number,)


def on_metal(by_app: bool, number: signal.Signals | None, attempt: Attempt) -> Outcome:
    """App in a jog, or command in a program, on the fake port."""
    shop = Shop(attempt.folder, attempt.random.choice(("ppdev", "devport")), popen=Warm)
    with (shop.folder / "fraese.toml").open("a") as file:
        file.write(_JOG)
    words = () if by_app else ("run", "long.ngc")
    pty = Pty([*_FRAESE, *words], shop.folder, _environment(shop.environment), popen=Warm)
    try:
        _set_out(pty, by_app)
        shop.fake.wait_for(shop.is_under_way)
        child = child_of(pty.process.pid)
        time.sleep(attempt.random.uniform(0.1, _WITHIN_S))
        at_ns, _, code = _end(pty, number)
        shop.fake.wait_for(lambda: not is_alive(child))
    finally:
        pty.close()
    assert code in _owed(number, by_app=by_app), f"exit code {code}"
    check_motors_off(shop.fake.writes())
    brakes_ms = braking_begun_ms(shop.fake.events(), at_ns)
    if brakes_ms > BRAKES_MS:
        raise Late(f"braked only after {brakes_ms:.0f} ms")
    claim, truth_steps = claimed(shop), shop.travelled_steps()
    beyond = claim.beyond_steps(truth_steps) + (not claim.is_to_the_step)
    return Outcome(beyond, brakes_ms, f"claimed {claim}, true {truth_steps}" if beyond else "")


def _set_out(pty: Pty, by_app: bool) -> None:
    """It moves, and nobody reads."""
    if by_app:
        pty.read_until(b"Hold")
        stall(pty)
        pty.type(b"5")
        pty.type(b"\x1b[C")
    else:
        # Ctrl+S: the terminal takes nothing more.
        pty.read_until(b"line ")
        pty.type(b"\x13")


def shrunk(attempt: Attempt) -> Outcome:
    """The app's terminal is resized to nothing in a jog, or to little; then it is told to end."""
    chance = attempt.random
    shop = Shop(attempt.folder, chance.choice(("ppdev", "devport")), popen=Warm)
    with (shop.folder / "fraese.toml").open("a") as file:
        file.write(_JOG)
    pty = Pty([*_FRAESE], shop.folder, _environment(shop.environment), popen=Warm)
    try:
        pty.read_until(b"Hold")
        pty.type(b"5" + b"\x1b[C")
        shop.fake.wait_for(shop.is_under_way)
        child = child_of(pty.process.pid)
        for _ in range(chance.randint(1, 4)):
            pty.resize(*chance.choice(_SIZES))
            pty.read(chance.uniform(0, 0.3))
        owed = 128 + signal.SIGTERM
        since_s = time.monotonic()
        if chance.random() < 0.5:
            pty.type(_QUIT)
            owed = 0
        else:
            pty.process.send_signal(signal.SIGTERM)
        code = pty.end(reading=True, within_s=3 * GONE_S)
        gone_s = time.monotonic() - since_s
        shop.fake.wait_for(lambda: not is_alive(child))
    finally:
        pty.close()
    assert code == owed, f"exit code {code}, not {owed}"
    if gone_s > GONE_S:
        raise Late(f"gone only after {gone_s:.1f} s")
    check_motors_off(shop.fake.writes())
    claim, truth_steps = claimed(shop), shop.travelled_steps()
    beyond = claim.beyond_steps(truth_steps) + (not claim.is_to_the_step)
    return Outcome(beyond, gone_s, f"claimed {claim}, true {truth_steps}")


def simulated(by_app: bool, number: signal.Signals | None, attempt: Attempt) -> Outcome:
    """The same on the paced simulated mill."""
    folder = attempt.folder
    (folder / "fraese.toml").write_text(_JOG)
    (folder / "long.ngc").write_text("G21 G91\n" + "G1 X80 Y80 F900\nG1 X-80 Y-80\n" * 20 + "M2\n")
    words = () if by_app else ("run", "long.ngc", "--real-time")
    homes = {f"XDG_{name}_HOME": str(folder / name.lower()) for name in ("CONFIG", "STATE")}
    paths = {"PYTHONPATH": str(Path(__file__).parents[2])}
    pty = Pty(
        [*_FRAESE, *words], folder, _environment({**os.environ, **homes, **paths}), popen=Warm
    )
    try:
        _set_out(pty, by_app)
        time.sleep(attempt.random.uniform(0.3, _WITHIN_S))
        _, gone_ms, code = _end(pty, number)
    finally:
        pty.close()
    assert code in _owed(number, by_app=by_app), f"exit code {code}"
    return Outcome(0, gone_ms)


def _missing() -> str:
    why = missing()
    if not why:
        library()
    return why


def _kinds() -> list[Kind]:
    kinds = []
    for by_app in (True, False):
        whom = "app" if by_app else "command"
        for number in (*_SIGNALS, None):
            what = f"{number.name} to the {whom}" if number else f"closed window of the {whom}"
            metal = partial(on_metal, by_app, number)
            mill = partial(simulated, by_app, number)
            told = "ms from the signal to braking"
            gone = "ms from the signal to gone"
            kinds += [
                Kind(f"{what}, unread", told, metal, _MANY, 1, _missing, alone=True),
                Kind(f"{what}, unread, simulated", gone, mill, _MANY, 1, alone=True),
            ]
    return kinds


KINDS: Final = (
    *_kinds(),
    Kind("terminal of the app resized to nothing", "s from the end wanted to gone", shrunk,
         missing=_missing),
)  # fmt: skip
