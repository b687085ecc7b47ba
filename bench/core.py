"""Simulated half-steps per second of real time, on one core, in virtual time.

Run it before and after a change to the hot loops: ``python -m bench.core``.
"""

import time
from typing import Final

from fraese.blocks import Block, Piece, accel_q_from_hz_s, rate_q8_from_hz
from fraese.motor.cards.smc1500 import SmcCard
from fraese.motor.clock import VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.electronics import SmcElectronics
from fraese.motor.mill import Mill, Slide
from fraese.motor.phases import LEVEL_MAPS
from fraese.motor.ports.sim import SimulatedMill
from fraese.planner.ramps import trapezoid

STEPS: Final = 150_000
REPEATS: Final = 3


def _core() -> MotorCore:
    clock = VirtualClock()
    mill = Mill([Slide(2 * STEPS + 1000)] * 3)
    electronics = SmcElectronics(mill, clock, LEVEL_MAPS["field"])
    return MotorCore(SimulatedMill(mill, electronics, clock), SmcCard(), clock)


def _line(steps: tuple[int, ...], law: tuple[Piece, ...]) -> Block:
    return Block(
        steps,
        law,
        accel_q=accel_q_from_hz_s(40_000),
        jump_rate_q8=rate_q8_from_hz(1000),
        weight=1000,
    )


def half_steps_per_s(steps: tuple[int, ...]) -> float:
    """The best of some repeats: the machine may be busy with other things."""
    law = tuple(trapezoid(max(steps), 1000, 5000, 1000, 40_000))
    best = 0.0
    for _ in range(REPEATS):
        core = _core()
        core.push(_line(steps, law))
        start = time.perf_counter()
        while core.poll(0.05).running:
            pass
        best = max(best, sum(steps) / (time.perf_counter() - start))
    return best


def stream_half_steps_per_s() -> float:
    """A full queue of short blocks none of which ends at rest: the throttle watches every tick."""
    short = _line((50, 25, 0), (Piece(50, 3200 * 256),))._replace(ends_at_rest=False)
    core = _core()
    pushed, start = 0, time.perf_counter()
    while pushed < STEPS // 50:
        while core.push(short):
            pushed += 1
        core.poll(0.05)
    return sum(core.poll(0).travelled_steps) / (time.perf_counter() - start)


def main() -> None:
    """Print one line for each number of axes."""
    for name, steps in (
        ("one axis", (STEPS, 0, 0)),
        ("two equal", (STEPS, STEPS, 0)),
        ("three equal", (STEPS, STEPS, STEPS)),
        ("three, 3:2:1", (STEPS, STEPS * 2 // 3, STEPS // 3)),
    ):
        print(f"{name:14}{half_steps_per_s(steps):10,.0f} half-steps/s")
    print(f"{'stream, 2:1':14}{stream_half_steps_per_s():10,.0f} half-steps/s")


if __name__ == "__main__":
    main()
