"""A job played by the real-time driver, with its step process, on the guest's own port.

The step process is forked: its code is the same, and it is there in a moment. Under emulation
another Python takes longer to start than the driver waits for it; that it does start is tried on
the fake port.
"""

import json
from typing import Final

from fraese.motor.realtime.driver import RealtimeDriver
from fraese.motor.realtime.process import ChildProcess
from fraese.motor.realtime.setup import RealtimeOptions, Setup
from fraese.motor.switches import SwitchInput
from rigs.lpt.forked import ForkedStepper
from tests.rigs.lpt.play import PORTS, SAFE_OUTPUTS, bench_of, play

#: Under emulation a host that is not heard for some seconds is slow, not hung.
_OPTIONS: Final = RealtimeOptions(silent_s=20.0)


def driver_on(wiring: str, kind: str) -> RealtimeDriver:
    """The driver as the core in ``play.py``: one reading makes a contact."""
    spawn = ChildProcess._spawn
    ChildProcess._spawn = ForkedStepper  # type: ignore[method-assign, assignment]
    try:
        return RealtimeDriver(
            Setup(
                PORTS[kind],
                bench_of(wiring).card,
                SwitchInput(readings=1),
                capacity=16,
                safe_outputs=SAFE_OUTPUTS,
                options=_OPTIONS,
            )
        )
    finally:
        ChildProcess._spawn = spawn  # type: ignore[method-assign]


def main(wiring: str, kind: str, job: str) -> None:
    """Be a program that drives a machine; says which process makes the steps."""
    driver = driver_on(wiring, kind)
    print(json.dumps(driver.pid), flush=True)
    play(driver, job)
