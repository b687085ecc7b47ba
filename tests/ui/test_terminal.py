"""The app in a real pseudo-terminal."""

import os
import select
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

fcntl = pytest.importorskip("fcntl")
pty = pytest.importorskip("pty")
termios = pytest.importorskip("termios")


SCRIPT = """
from fraese.assembly import assemble
from fraese.config import Config
from fraese.ui import FraeseApp
plant = assemble(Config(), clock='paced')
app = FraeseApp(plant.controller, open_program=None)
app.run()
seen = plant.port.look()
with open('end.txt', 'w') as file:
    print(app.return_code, seen.currents[0].a_percent, seen.lost_steps[0],
          plant.controller.position.position_steps[0], file=file)
"""


@contextmanager
def jogging_app(folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """The app's process, on its way of 10 mm, and the near end of its terminal.

    The terminal does not control the process: when it goes away there is no signal.
    """
    (folder / "app.py").write_text(SCRIPT)
    near, far = pty.openpty()
    fcntl.ioctl(far, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    app = subprocess.Popen(
        [sys.executable, "app.py"], stdin=far, stdout=far, stderr=far, cwd=folder,
        start_new_session=True, env={**os.environ, "TERM": "xterm-256color"},
    )  # fmt: skip
    os.close(far)
    try:
        read_until(near, b"Hold")
        os.write(near, b"5")
        os.write(near, b"\x1b[C")
        read_until(near, b"mm/min")
        yield app, near
    finally:
        app.kill()
        app.wait()
        with suppress(OSError):
            os.close(near)


def ended(folder: Path) -> None:
    """It ended as after a signal to terminate: it braked in time, lost nothing, motors off."""
    code, current, lost, position = (folder / "end.txt").read_text().split()
    assert (code, current, lost) == ("143", "0", "0.0")
    assert 0 < int(position) < 2000


def test_a_signal_brakes_switches_off_and_ends_the_app(tmp_path: Path) -> None:
    with jogging_app(tmp_path) as (app, near):
        app.send_signal(signal.SIGTERM)
        read_until(near, b"")
        app.wait(timeout=20)
    ended(tmp_path)


@pytest.mark.alone
def test_a_terminal_that_goes_away_without_a_signal_ends_the_app_too(tmp_path: Path) -> None:
    with jogging_app(tmp_path) as (app, near):
        os.close(near)
        app.wait(timeout=2)
    ended(tmp_path)


def read_until(fd: int, wanted: bytes) -> None:
    """Read a terminal until this was drawn; nothing wanted: until it is closed."""
    seen = b""
    until = time.monotonic() + 20
    while not wanted or wanted not in seen:
        ready = select.select([fd], [], [], until - time.monotonic())[0]
        assert ready, f"{wanted!r} was not drawn in time"
        try:
            seen += os.read(fd, 65536)
        except OSError:  # the other side has closed
            assert not wanted
            return
