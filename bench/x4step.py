"""What the X4Step library costs in late ticks, beside the step process alone.

Run: python -m bench.x4step [rounds]

20 kHz on four axes for a second and a half, on a port that leads nowhere, in turn, each round in
another order:

alone       the step process, asked by nobody but a loop of polls
asleep      X4Step, the caller sleeps
computing   X4Step, the caller computes in Python
asking      X4Step, the caller asks in a loop whether it moves

What is said of each beside ``alone`` is the mean of the differences within a round, and its
standard error: one round differs from the next by more than any of them.
"""

import statistics
import sys
import time
from collections.abc import Callable
from typing import Final

from fraese.config import Config
from fraese.config.x4step import LptConfig
from fraese.motor.clock import MonotonicClock
from fraese.motor.ports.null import NullPort
from fraese.motor.realtime.driver import RealtimeDriver
from fraese.x4step import X4Step
from fraese.x4step.keys import HandKeys, Keyboard
from fraese.x4step.lpt import METAL_IDLE_S, Opened, Wanted, realtime_setup
from fraese.x4step.motion import Motion
from fraese.x4step.paths import path
from fraese.x4step.surroundings import Surroundings

_STEPS: Final = (30_000, 29_000, 28_000, 27_000)
_FREQ_HZ: Final = 20_000
_RAMP_MS: Final = 50
_BUSY_S: Final = 1.5
_SLICE_S: Final = 0.004
_ROUNDS: Final = 16


def _driver() -> RealtimeDriver:
    wanted = Wanted(1, Config(), LptConfig(kind="ppdev"), MonotonicClock)
    return RealtimeDriver(realtime_setup(wanted, NullPort))


def alone() -> int:
    """Late ticks without the library."""
    driver = _driver()
    try:
        motion = Motion(driver)
        motion.start(path(_STEPS, _FREQ_HZ, _RAMP_MS))
        while motion.moving:
            motion.look(_SLICE_S)
        return motion.report.late_ticks
    finally:
        driver.close()


def _with_library(occupy: Callable[[X4Step, float], None]) -> int:
    driver = _driver()

    def opened(_lpt: int) -> Opened:
        return Opened(driver, MonotonicClock(), _SLICE_S, METAL_IDLE_S)

    around = Surroundings(opened, Keyboard(HandKeys()), is_lockstep=False)
    with X4Step(1, around) as motors:
        motors.load(_STEPS, _FREQ_HZ, _RAMP_MS)
        motors.start()
        occupy(motors, time.monotonic() + _BUSY_S)
        motors.wait()
        return driver.poll(0.0).late_ticks


def _sleep(motors: X4Step, until_s: float) -> None:
    time.sleep(until_s - time.monotonic())


def _compute(motors: X4Step, until_s: float) -> None:
    number = 1
    while time.monotonic() < until_s:
        for _ in range(1000):
            number = number * 1103515245 + 12345 & 0x7FFFFFFF


def _ask(motors: X4Step, until_s: float) -> None:
    while motors.moving:
        pass


WAYS: Final[dict[str, Callable[[], int]]] = {
    "alone": alone,
    "asleep": lambda: _with_library(_sleep),
    "computing": lambda: _with_library(_compute),
    "asking": lambda: _with_library(_ask),
}


def main(rounds: int) -> None:
    """Measure, and print a line for each way."""
    late: dict[str, list[int]] = {name: [] for name in WAYS}
    names = list(WAYS)
    for number in range(rounds):
        turn = number % len(names)
        for name in names[turn:] + names[:turn]:
            late[name].append(WAYS[name]())
    print(f"late of {_STEPS[0]:,} ticks, {rounds} rounds")
    for name, counts in late.items():
        row = f"{name:10} median {statistics.median(counts):6.0f} ({min(counts)} to {max(counts)})"
        if name != "alone" and rounds > 1:
            more = [a - b for a, b in zip(counts, late["alone"], strict=True)]
            error = statistics.stdev(more) / len(more) ** 0.5
            row += f"   beside alone {statistics.mean(more):+6.0f} +- {error:.0f}"
        print(row)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else _ROUNDS)
