"""Programs that do not come to X4ReInit: whatever ends them, the lines are low afterwards."""

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from fraese.errors import PortError
from fraese.x4step import lifeline

pytestmark = pytest.mark.alone

ROOT = Path(__file__).parents[2]

#: Says what is on the lines when the port is given back; ``{}`` is how the program goes on.
_PROGRAM = """
    import os, signal, sys, time
    import fraese.motor.ports.recorder as recorder
    from fraese.x4step import *
    from fraese.x4step.testing import Lines, simulation

    real = recorder.Recorder.close

    def close(port):
        lines = Lines(port.accesses)
        low = not any(lines.level(pin) for pin in (1, 3, 14, 16, 17))
        falls = lines.falls(3)
        os.write(2, b"low after a ramp" if low and falls[-1] - falls[-2] > 3_000_000 else b"not")
        real(port)

    recorder.Recorder.close = close
    around = simulation("paced")
    around.__enter__()
    X4Init(2)
    X4SetOut(SIGNAL1ON)
    X4MovePos(1, 1000, 100)
    time.sleep(0.15)
    print("moving", flush=True)
    {}
"""


def program(rest: str) -> "subprocess.Popen[str]":
    text = textwrap.dedent(_PROGRAM).replace("{}", rest)
    return subprocess.Popen(
        [sys.executable, "-c", text],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=dict(os.environ),
    )


@pytest.mark.parametrize(
    ("rest", "code"),
    [("", 0), ("sys.exit(3)", 3), ("1 / 0", 1), ("X4Brake()", 0), ("X4Brake(); X4ReInit()", 0),
     ("os.kill(os.getpid(), signal.SIGTERM); time.sleep(9)", 128 + signal.SIGTERM)],
)  # fmt: skip
def test_however_it_ends(rest: str, code: int) -> None:
    running = program(rest)
    said = running.communicate(timeout=30)[1]
    assert running.returncode == code, said
    assert said.endswith("low after a ramp"), said


@pytest.mark.parametrize(
    ("number", "code"),
    [(signal.SIGTERM, 128 + signal.SIGTERM), (signal.SIGHUP, 128 + signal.SIGHUP),
     (signal.SIGINT, -signal.SIGINT)],
)  # fmt: skip
@pytest.mark.parametrize("rest", ["while X4GetState(): pass", "time.sleep(60)"])
def test_a_signal(number: signal.Signals, code: int, rest: str) -> None:
    running = program(rest)
    assert running.stdout is not None
    assert running.stdout.readline() == "moving\n"
    running.send_signal(number)
    said = running.communicate(timeout=30)[1]
    assert running.returncode == code, said
    assert "low after a ramp" in said, said


def test_a_signal_that_the_program_handles_stays_its_own() -> None:
    running = program(
        "signal.signal(signal.SIGTERM, lambda *_: os._exit(7)); X4Stop(); X4ReInit(); X4Init(1);"
        " os.kill(os.getpid(), signal.SIGTERM); time.sleep(9)"
    )
    running.communicate(timeout=30)
    assert running.returncode == 7


class Stuck:
    """A machine whose motors cannot be switched off."""

    def close(self) -> None:
        lifeline.let_go(self)
        raise PortError("/dev/parport0 is gone.")


def test_what_cannot_be_switched_off_at_the_end_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    machines = [Stuck(), Stuck()]
    for machine in machines:
        lifeline.hold(machine)
    lifeline.close_all()
    said = "x4step: Not everything could be switched off: /dev/parport0 is gone.\n"
    assert capsys.readouterr().err == 2 * said
