"""The app in a real pseudo-terminal."""

import os
import select
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

fcntl = pytest.importorskip("fcntl")
pty = pytest.importorskip("pty")
termios = pytest.importorskip("termios")


def test_a_signal_brakes_switches_off_and_ends_the_app(tmp_path: Path) -> None:
    script = tmp_path / "app.py"
    script.write_text(
        "from fraese.assembly import assemble\n"
        "from fraese.config import Config\n"
        "from fraese.ui import FraeseApp\n"
        "plant = assemble(Config(), clock='paced')\n"
        "app = FraeseApp(plant.controller, open_program=None)\n"
        "app.run()\n"
        "seen = plant.port.look()\n"
        "with open('end.txt', 'w') as file:\n"
        "    print(app.return_code, seen.currents[0].a_percent, seen.lost_steps[0],\n"
        "          plant.controller.position.position_steps[0], file=file)\n"
    )
    near, far = pty.openpty()
    fcntl.ioctl(far, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    app = subprocess.Popen(
        [sys.executable, str(script)], stdin=far, stdout=far, stderr=far, cwd=tmp_path,
        start_new_session=True, env={**os.environ, "TERM": "xterm-256color"},
    )  # fmt: skip
    os.close(far)
    try:
        read_until(near, b"palette")
        os.write(near, b"5")
        os.write(near, b"\x1b[C")
        read_until(near, b"RUN")
        app.send_signal(signal.SIGTERM)
        read_until(near, b"")
        app.wait(timeout=20)
    finally:
        app.kill()
        os.close(near)
    code, current, lost, position = (tmp_path / "end.txt").read_text().split()
    assert (code, current, lost) == ("143", "0", "0.0")
    assert 0 < int(position) < 2000


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
