"""A job on a real port, and the same job on the simulated mill.

    python -m tests.rigs.lpt.play WIRING PORT JOB

plays it with the motor core on that port and prints what the core reports as one JSON object. It
runs under the preloaded fake port, and in the guest of the real-kernel rig.

Rule 1: the clock is virtual, so a job takes the time of its register accesses, and its bytes are
        the same everywhere. Only "endless" takes the machine's own time.
Rule 2: SIGTERM and SIGINT stop the motors, as they do in the program.
"""

import json
import signal
import sys
from collections.abc import Callable, Mapping
from functools import partial
from types import FrameType
from typing import Final

from fraese.blocks import Block, Outputs, dwell
from fraese.errors import PortError
from fraese.motor.clock import MonotonicClock, VirtualClock
from fraese.motor.core import MotorCore
from fraese.motor.ports.devport import DevPort
from fraese.motor.ports.ppdev import PpdevPort
from fraese.motor.ports.recorder import Recorder
from fraese.motor.seams import Card, Clock, IdleLevel, Port, Report, StepDriver
from fraese.motor.switches import SwitchInput
from tests.motor.workbench import MOTORS, Workbench, line, steady

WIRINGS: Final = ("smc", "x4step", "paper")

#: Opened in the process that plays, from what can be sent there.
PORTS: Final[Mapping[str, Callable[[], Port]]] = {
    "ppdev": partial(PpdevPort, "/dev/parport0"),
    "devport": partial(DevPort, 0x378),
}

#: A free output that is off whenever the motors stand.
SAFE_OUTPUTS: Final = 0b10


def _everything() -> list[Block]:
    """Ramps, minor axes, corners, both directions, a dwell, outputs."""
    return [
        line(180, -70, 11, outputs=Outputs(0b01, 0b01)),
        line(-60, 60, 60, outputs=Outputs(0b11, 0b10)),
        dwell(MOTORS, 0.05),
        steady(0, -25, 0, rate_hz=700),
        line(-3, 140, -9, outputs=Outputs(0b11, 0)),
    ]


JOBS: Final[Mapping[str, Callable[[], list[Block]]]] = {
    "everything": _everything,
    "straight": lambda: [steady(60_000, 60_000, 60_000)],
    "endless": lambda: [steady(100_000, 100_000, rate_hz=500)],
}


def core_on(port: Port, card: Card, clock: Clock) -> MotorCore:
    """The core as in the bench, but one reading makes a contact."""
    return MotorCore(
        port, card, clock, SwitchInput(readings=1), capacity=16, safe_outputs=SAFE_OUTPUTS
    )


def play(driver: StepDriver, job: str) -> Report:
    """Push, play to the end, rest, look once more, give back."""
    try:
        for block in JOBS[job]():
            assert driver.push(block)
        report = driver.poll(0.1)
        while report.running:
            report = driver.poll(0.1)
        driver.idle(IdleLevel.HOLD)
        return driver.poll(0)
    finally:
        driver.close()


def bench_of(wiring: str) -> Workbench:
    """A simulated mill that follows anything, with its card."""
    return Workbench(wiring, outputs=True, readings=1)


def simulated_writes(wiring: str, job: str) -> list[tuple[int, int]]:
    """What the simulated mill's registers get from the same job."""
    bench = bench_of(wiring)
    recorder = Recorder(bench.simulated, bench.clock)
    play(core_on(recorder, bench_of(wiring).card, bench.clock), job)
    return recorder.writes()


def main(wiring: str, kind: str, job: str) -> None:
    """Play on a real port and say how it went."""
    clock = MonotonicClock() if job == "endless" else VirtualClock()
    try:
        core = core_on(PORTS[kind](), bench_of(wiring).card, clock)
        _stop_on_signals(core)
        report = play(core, job)
    except PortError as error:
        print(json.dumps({"error": str(error)}))  # noqa: T201
        return
    said = {"ended": report.ended.value, "position_steps": report.position_steps}
    print(json.dumps(said))  # noqa: T201


def _stop_on_signals(core: MotorCore) -> None:
    def stop(number: int, frame: FrameType | None) -> None:
        core.stop()

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, stop)


if __name__ == "__main__":
    main(*sys.argv[1:])
