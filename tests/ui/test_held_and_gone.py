"""A key is held in a real terminal, and then the line goes away or the app is stopped."""

import signal
import time
from pathlib import Path

import pytest

pytest.importorskip("pty")

from tests.terminals import Pty
from tests.ui.test_bad_terminals import QUIT, RIGHT, app, carriage_steps

pytestmark = pytest.mark.alone

STEPS_PER_MM = 200
SPEED_MM_S = 10.0
#: As a terminal repeats.
INTERVAL_S = 1 / 30
#: Silence after which nobody holds it any more, the ramp, and the width of the first press.
AFTERWARDS_MM = 8.0


def hold(pty: Pty, hold_s: float) -> float:
    """Press Right, and repeat it as a terminal does; for how long it was, s."""
    begun_s = time.monotonic()
    pty.type(RIGHT)
    time.sleep(0.4)
    while time.monotonic() < begun_s + hold_s:
        pty.type(RIGHT)
        pty.read(0)
        time.sleep(INTERVAL_S)
    return time.monotonic() - begun_s


def went_mm(folder: Path) -> float:
    return carriage_steps(folder)[0] / STEPS_PER_MM


def test_a_line_that_goes_away_lets_go(tmp_path: Path) -> None:
    with app(tmp_path) as pty:
        pty.read_until(b"Hold")
        held_s = hold(pty, 2.0)
        pty.process.send_signal(signal.SIGHUP)
        assert pty.end(reading=True, within_s=3) == 128 + signal.SIGHUP
    assert 2 < went_mm(tmp_path) < held_s * SPEED_MM_S + AFTERWARDS_MM


def test_an_app_that_was_stopped_goes_on_without_the_key(tmp_path: Path) -> None:
    with app(tmp_path) as pty:
        pty.read_until(b"Hold")
        held_s = hold(pty, 2.0)
        pty.process.send_signal(signal.SIGSTOP)
        time.sleep(1)
        pty.process.send_signal(signal.SIGCONT)
        # Time to go far, if it were still held.
        until_s = time.monotonic() + 2
        while time.monotonic() < until_s:
            pty.read(0.1)
        pty.type(QUIT)
        assert pty.end(reading=True) == 0
    assert 2 < went_mm(tmp_path) < held_s * SPEED_MM_S + AFTERWARDS_MM
